// SPDX-License-Identifier: MIT
// Measures of flows against each other and against a known surface, in motion. The Slow tests have
// half the spacing. Only with --all: whole flows.
#include <silt/measure/surface_height.hpp>

#include "support/water_loads.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::water_probes_test {
namespace {

// Gauges by the load, a spacing apart, against the load of the wall, in windows of 20 ms from the
// first contact on. Those by the pressure read 0.7 of it in the first of them at 20 mm. In that, a
// part of the load is on rows of the wall that the fluid has not reached yet, where gauges read 0.
void expect_loads(double l0, double first) {
  const WaterScene scene{.spacing = l0,
                         .water = {{{0, 0}, {0.4, 0.8}}},
                         .walls = polyline({{0, 3}, {0, 0}, {1.6, 0}, {1.6, 3}}),
                         .speed_scale = 2.8};
  auto sim = scene.simulation();
  double end = 0.42, gauges = 0, load = 0;
  run_water(sim, 0.6, [&](const auto&, double dt) {
    if (sim.time() < 0.4) return;
    for (double y = l0 / 2; y < 1.6; y += l0) {
      gauges += dt * l0 * WallGauge<2>{{1.6, y}, {-1, 0}, l0}.read_load(sim);
    }
    load += dt * load_on(sim, {1.6, 0, 3, -1});
    if (sim.time() < end) return;
    if (end > 0.43) {
      EXPECT_NEAR(gauges / load, 1, end < 0.45 ? first : 0.01) << end;
    }
    gauges = load = 0, end += 0.02;
  });
}
TEST(Impact, HasTheSameLoadByGaugesAndByMomentum) { expect_loads(0.02, 0.03); }
TEST(Impact, HasTheSameLoadByGaugesAndByMomentumSlow) { expect_loads(0.01, 0.02); }

// A standing wave of 1 m in 0.25 m of water, amplitude 0.01 m, from linear theory: levels at the
// walls, and the mean level, which the volume of the particles gives.
void expect_levels(double l0) {
  constexpr double length = 0.5, depth = 0.24, a = 0.01, k = std::numbers::pi / length;
  WaterScene scene{.spacing = l0,
                   .walls = polyline({{0, 1}, {0, 0}, {length, 0}, {length, 1}}),
                   .speed_scale = 1.5};
  const Vec<2> half = Vec<2>::Constant(l0 / 2);
  for (const Vec<2>& x : lattice<2>({{0, 0}, {length, depth}}, l0)) {
    const double deep = std::sinh(k * depth);
    const Vec<2> displaced(x[0] - a * std::cosh(k * x[1]) / deep * std::sin(k * x[0]),
                           x[1] + a * std::sinh(k * x[1]) / deep * std::cos(k * x[0]));
    scene.water.push_back({displaced - half, displaced + half});
  }
  auto sim = scene.simulation();
  const double omega = std::sqrt(9.81 * k * std::tanh(k * depth));
  const auto level = [&](double x) {
    return SurfaceHeight<2>{.point = {x, 0}, .spacing = l0}.read(sim);
  };
  double of_walls = 0, of_mean = 0;
  run_water(sim, 2 * std::numbers::pi / omega, [&](const auto&, double) {
    const double wave = a * std::cos(omega * sim.time());
    of_walls = std::max(
        {of_walls, std::abs(level(0) - depth - wave), std::abs(level(length) - depth + wave)});
    double mean = 0;
    for (int n = 0; n <= 50; ++n) mean += (n % 50 == 0 ? 0.5 : 1) / 50.0 * level(length * n / 50);
    of_mean = std::max(of_mean, std::abs(mean - depth));
  });
  EXPECT_LT(of_walls, 0.1 * l0);
  EXPECT_LT(of_mean, 0.05 * l0);
}
TEST(StandingWave, HasTheLevelOfLinearTheoryToATenthOfASpacing) { expect_levels(0.02); }
TEST(StandingWave, HasTheLevelOfLinearTheoryToATenthOfASpacingSlow) { expect_levels(0.01); }

}  // namespace
}  // namespace silt::test::water_probes_test
