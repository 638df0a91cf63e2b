// SPDX-License-Identifier: MIT
// Fluid between two walls, periodic along them, accelerated from rest by a body force (Poiseuille
// flow).
//
// If the Laplacian includes the next row only, the effective wall is the row of wall particles. A
// larger radius also includes the rows behind it, all at rest, and the effective wall is deeper: at
// the mean row at which a random walk with the row weights of the stencil first reaches a wall;
// there, profiles are linear.
// Only with --all: a comparison of whole flows.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test::channel_test {
namespace {

constexpr int rows = 20;
constexpr double l0 = 0.01;
constexpr double nu = 1e-4;
constexpr double force = 1e-6;  // [m/s²]; displacements from the lattice are negligible

// Velocity between walls at 0 and L, as the series of Morris et al. (1997).
double poiseuille(double y, double t, double L) {
  using std::numbers::pi;
  double u = force / (2 * nu) * y * (L - y);
  for (int n = 0; n < 60; ++n) {
    const double k = (2 * n + 1) * pi / L;
    u -= 4 * force / (nu * L) / std::pow(k, 3) * std::sin(k * y) * std::exp(-k * k * nu * t);
  }
  return u;
}

// A channel along x with the fluid in 0 < y < rows l0; in 3D also periodic along z.
template <int Dim>
mps::Fluid<Dim> channel() {
  constexpr int along = 8;
  constexpr int layers = 5;
  Box<Dim> box;
  for (int k = 0; k < Dim; ++k) {
    box.lower[k] = k == 1 ? -layers * l0 : 0;
    box.upper[k] = (k == 1 ? rows + layers : along) * l0;
    box.periodic[static_cast<Index>(k)] = k != 1;
  }
  mps::Fluid<Dim> fluid(box);
  for (const auto& x : lattice<Dim>(box, l0)) {
    const double outside = std::max(-x[1], x[1] - rows * l0);
    mps::add_particle(fluid, x,
                      outside < 0    ? mps::Kind::fluid
                      : outside < l0 ? mps::Kind::wall
                                     : mps::Kind::dummy);
  }
  return fluid;
}

// Maximum error of the profile at times t ν/L² from 0.05 to 0.4, relative to the steady maximum,
// for effective walls at the distance `depth` from the first and last row of fluid.
template <int Dim>
double max_error(double radius, double depth) {
  const double L = (rows - 1) * l0 + 2 * depth;
  mps::FlowSettings<Dim, mps::Case10> settings{.spacing = l0,
                                               .viscosity = nu,
                                               .gravity = force * Vec<Dim>::Unit(0),
                                               .radius = 2.1,
                                               .laplacian_radius = radius,
                                               .collision = {.distance = 0}};
  Simulation sim{channel<Dim>(), UniformGrid<Dim>{}, mps::Flow<mps::Case10, Dim>(settings),
                 SemiImplicit{}};
  double error = 0;
  const double dt = sim.time_step() / 4;
  for (const double scaled : {0.05, 0.1, 0.2, 0.4}) {
    while (sim.time() < scaled * L * L / nu) sim.step(dt);
    for (Index i = 0; i < sim.particles().size(); ++i) {
      if (sim.particles()[mps::kind][i] != mps::Kind::fluid) continue;
      const double y = sim.particles()[position][i][1] - l0 / 2 + depth;
      const double u = sim.particles()[velocity][i][0];
      error = std::max(error, std::abs(u - poiseuille(y, sim.time(), L)));
    }
  }
  return error / (force * L * L / (8 * nu));
}

TEST(Channel, DevelopsThePoiseuilleProfileBetweenItsWallParticles) {
  EXPECT_LT(max_error<2>(1.5, l0), 0.01);
}

// Depth of the effective wall: mean end point of a random walk that starts in the first row of
// fluid, steps with the row weights of the 2D stencil, and does not reach the opposite wall; as a
// distance from that row.
double depth_of_walls(double radius) {
  const int reach = static_cast<int>(std::ceil(radius)) - 1;
  const auto index = [&](int row) { return static_cast<Index>(row + reach); };
  std::vector<double> step(static_cast<Index>(2 * reach + 1), 0);
  double sum = 0;
  for (int y = -reach; y <= reach; ++y) {
    for (int x = -reach; x <= reach; ++x) {
      const double r = std::hypot(x, y);
      if (y == 0 || r >= radius) continue;
      step[index(y)] += mps::CubicKernel::weight(r / radius);
      sum += mps::CubicKernel::weight(r / radius);
    }
  }
  // Intercept of the harmonic function that is zero beyond the wall and linear far from it.
  const int far = 400;
  std::vector<double> h(far);
  for (int y = 0; y < far; ++y) h[static_cast<Index>(y)] = y + 1;
  for (int sweep = 0; sweep < 4000; ++sweep) {
    for (int y = 0; y < 200; ++y) {
      double mean = 0;
      for (int d = -reach; d <= reach; ++d) {
        if (d != 0 && y + d >= 0) mean += step[index(d)] / sum * h[static_cast<Index>(y + d)];
      }
      h[static_cast<Index>(y)] = mean;
    }
  }
  const double slope = h[120] - h[119];
  return (h[120] / slope - 120) * l0;
}

TEST(Channel, HasEffectiveWallsAtTheDepthGivenByTheStencil) {
  EXPECT_NEAR(depth_of_walls(1.5), l0, 0.02 * l0);
  const double depth = depth_of_walls(3.1);
  EXPECT_GT(depth, l0);
  EXPECT_LT(depth, 2 * l0);
  EXPECT_LT(max_error<2>(3.1, depth), 0.03);
}

}  // namespace
}  // namespace silt::test::channel_test
