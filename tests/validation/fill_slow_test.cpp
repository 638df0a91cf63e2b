// SPDX-License-Identifier: MIT
// Water of fill() between walls that no lattice fits: speeds from the first second on, pressures on
// the walls, volumes.
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>
#include <silt/mps/filling/fill.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

namespace silt::test::fill_slow_test {
namespace {

constexpr double g = 9.81;  // [m/s²]

template <int Dim>
struct Rest {
  std::string name;
  std::vector<Face<Dim>> faces;
  mps::Pool<Dim> pool;
  double height;  // of the water [m]
};

struct Result {
  double speed;     // largest from 1 s on [√(g H)]
  double pressure;  // largest error on a wall, deeper than a spacing [ρ g H]
  double volume;    // its error [-]
};

template <int Dim>
Result result_of(const Rest<Dim>& rest, double until) {
  const double l0 = rest.pool.spacing, scale = std::sqrt(g * rest.height);
  mps::FlowSettings<Dim, mps::Recommended> settings{.spacing = l0, .speed_scale = scale};
  settings.walls.template faces<Dim>() = rest.faces;
  mps::Fluid<Dim> water;
  const mps::Filling filling = mps::fill(water, settings.walls, rest.pool);
  Simulation still{water, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                   SemiImplicit<>{}};
  Result result{0, 0, double(water.size()) * std::pow(l0, Dim) / filling.volume - 1};
  for (double t = 1; t < until + 1e-9; t += 0.05) {
    still.run({.until = t});
    for (const auto& u : still.particles()[velocity]) {
      result.speed = std::max(result.speed, u.norm() / scale);
    }
  }
  for (const Face<Dim>& face : rest.faces) {
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      Vec<Dim> x = 0.4 * face.corners[k];
      for (const Vec<Dim>& corner : face.corners) x += 0.6 / Dim * corner;
      const double depth = rest.pool.level - x[Dim - 1];
      if (depth < l0) continue;
      Vec<Dim> normal = normal_of(face);
      if (normal.dot(rest.pool.inside - x) < 0) normal = -normal;
      const double p = WallGauge<Dim>{x, normal, l0}.read(still.particles(), mps::pressure);
      result.pressure =
          std::max(result.pressure, std::abs(p - 1000 * g * depth) / (1000 * g * rest.height));
    }
  }
  std::printf("%s: %zu particles, deviation %.1e, speed %.1e, pressure %.2f %%, volume %.1e\n",
              rest.name.c_str(), std::size_t(water.size()), filling.deviation, result.speed,
              100 * result.pressure, result.volume);
  return result;
}

std::vector<Vec<2>> polygon(int sides, double radius, const Vec<2>& centre) {
  std::vector<Vec<2>> corners;
  for (int k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    corners.push_back(centre + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  }
  return corners;
}
std::vector<Face<2>> round_tank() {
  auto corners = polygon(48, 0.3, {0, 0.3});
  corners.push_back(corners[0]);
  return polyline(corners);
}

void expect_rest(const Rest<2>& rest) {
  const Result result = result_of(rest, 1.5);
  EXPECT_LT(result.speed, 2e-3) << rest.name;
  EXPECT_LT(result.pressure, 5e-3) << rest.name;
  EXPECT_LT(std::abs(result.volume), 1.5e-3) << rest.name;  // half a particle of 352
}

// No other test proves that water rests between walls of many shapes.
TEST(FillSlow, LeavesWaterAtRestIn2D) {
  const auto turned = [](double x, double y) {
    return Vec<2>(std::cos(0.35) * x - std::sin(0.35) * y, std::sin(0.35) * x + std::cos(0.35) * y);
  };
  expect_rest({"V", polyline({{-0.7, 0.7}, {0, 0}, {0.7, 0.7}}), {{0, 0.2}, 0.4, 0.02}, 0.4});
  expect_rest({"tilted box",
               polyline({turned(0, 0.8), turned(0, 0), turned(0.5, 0), turned(0.5, 0.8)}),
               {turned(0.25, 0.1), 0.45, 0.02},
               0.45});
  expect_rest({"half a round tank", round_tank(), {{0.001, 0.1}, 0.3, 0.02}, 0.3});
  expect_rest({"three quarters of it", round_tank(), {{0.001, 0.1}, 0.45, 0.02}, 0.45});
  expect_rest({"chamfered tank",
               polyline({{0, 0.6}, {0, 0.13}, {0.13, 0}, {0.5, 0}, {0.5, 0.6}}),
               {{0.3, 0.2}, 0.4, 0.02},
               0.4});
  expect_rest({"tank of 0.39 m × 0.41 m",
               polyline({{0, 0.8}, {0, 0}, {0.39, 0}, {0.39, 0.8}}),
               {{0.2, 0.2}, 0.41, 0.04},
               0.41});
  expect_rest({"column of 0.395 m",
               polyline({{0, 0.8}, {0, 0}, {0.4, 0}, {0.4, 0.8}}),
               {{0.2, 0.2}, 0.395, 0.02},
               0.395});
  expect_rest(
      {"beach", polyline({{0, 0.6}, {0, 0}, {0.5, 0}, {3, 0.5}}), {{0.3, 0.1}, 0.3, 0.02}, 0.3});
}

// The sides of a prism of corners in the plane of the other two axes, between two ends along
// `axis`.
std::vector<Face<3>> prism(const std::vector<Vec<2>>& corners, int axis, double from, double to,
                           bool has_second_end, bool is_closed) {
  const auto at = [&](const Vec<2>& x, double along) {
    return axis == 1 ? Vec<3>(x[0], along, x[1]) : Vec<3>(x[0], x[1], along);
  };
  Vec<2> middle = Vec<2>::Zero();
  for (const Vec<2>& x : corners) middle += x / double(corners.size());
  std::vector<Face<3>> faces;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec<2>& a = corners[k];
    const Vec<2>& b = corners[(k + 1) % corners.size()];
    if (is_closed || k + 1 < corners.size()) {
      faces.push_back({{at(a, from), at(a, to), at(b, from)}});
      faces.push_back({{at(b, from), at(a, to), at(b, to)}});
    }
    faces.push_back({{at(middle, from), at(a, from), at(b, from)}});
    if (has_second_end) faces.push_back({{at(middle, to), at(a, to), at(b, to)}});
  }
  return faces;
}

// No other test proves it in space, with faces at more than one angle.
TEST(FillSlow, LeavesWaterAtRestIn3D) {
  const Result cylinder = result_of(Rest<3>{"cylinder",
                                            prism(polygon(24, 0.2, {0, 0}), 2, 0, 0.3, false, true),
                                            {{0.001, 0.002, 0.1}, 0.2, 0.02},
                                            0.2},
                                    1.2);
  const Result chamfer = result_of(
      Rest<3>{"chamfered tank",
              prism({{0, 0.4}, {0, 0.13}, {0.13, 0}, {0.3, 0}, {0.3, 0.4}}, 1, 0, 0.2, true, false),
              {{0.2, 0.1, 0.1}, 0.24, 0.02},
              0.24},
      1.2);
  for (const Result& result : {cylinder, chamfer}) {
    EXPECT_LT(result.speed, 2e-3);
    EXPECT_LT(result.pressure, 5e-3);
    EXPECT_LT(std::abs(result.volume), 1e-3);
  }
}

}  // namespace
}  // namespace silt::test::fill_slow_test
