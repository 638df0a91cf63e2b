// SPDX-License-Identifier: MIT
// A free surface half a spacing outside of the outermost particles.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/policy/outer_surface.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test::outer_surface_test {
namespace {

using Surface = mps::OuterSurface<mps::BothConditions>;
static_assert(mps::FreeSurface<Surface> && mps::HasOuterSurface<Surface>);
static_assert(!mps::HasOuterSurface<mps::BothConditions>);

struct Outer : mps::Recommended {
  mps::NoFriction friction{};
};
// Other weights of the Laplacian than of the density.
struct OuterWithHigherOrderLaplacian : Outer {
  mps::HigherOrderLaplacian laplacian{};
};

constexpr double l0 = 0.02;  // [m]

template <class Scheme>
auto still_tank() {
  mps::FlowSettings<2, Scheme> settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.3, 0}, {0.3, 1}});
  return Simulation{fluid_at(lattice<2>({{0, 0}, {0.3, 0.2}}, l0), Box<2>{}), UniformGrid<2>{},
                    mps::Flow<Scheme>(settings), SemiImplicit<>{}};
}

template <class Scheme>
void expect_pressure_of_depth() {
  auto sim = still_tank<Scheme>();
  for (int k = 0; k < 100; ++k) sim.step();
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    EXPECT_LT(water[velocity][i].norm(), 1e-6);
    EXPECT_NEAR(water[mps::pressure][i], 9810 * (0.2 - water[position][i][1]), 0.02);
  }
}

TEST(OuterSurface, HasThePressureOfDepthUpToTheWaterline) {
  expect_pressure_of_depth<Outer>();
  expect_pressure_of_depth<OuterWithHigherOrderLaplacian>();
}

// The radius of the drop is that of its outermost particles and half a spacing more.
TEST(OuterSurface, LeavesDropsInFreeFallWithoutPressure) {
  std::vector<Vec<2>> points;
  for (const auto& x : lattice<2>({{-0.1, -0.1}, {0.1, 0.1}}, l0)) {
    if (x.norm() < 0.1) points.push_back(x);
  }
  Simulation sim{fluid_at(points, Box<2>{}), UniformGrid<2>{},
                 mps::Flow<Outer>(
                     {.spacing = l0, .speed_scale = 2, .walls = {.let_fluid_fall = true}}),
                 SemiImplicit<>{}};
  for (int k = 0; k < 20; ++k) sim.step();
  const auto& drop = sim.particles();
  for (Index i = 0; i < drop.size(); ++i) {
    EXPECT_NEAR(drop[mps::pressure][i], 0, 1e-6);
    EXPECT_NEAR(drop[velocity][i][1], -9.81 * sim.time(), 1e-9);
  }
}

TEST(OuterSurface, GivesSprayNoPressure) {
  auto water = fluid_at(lattice<2>({{0, 0}, {0.2, 0.2}}, l0), Box<2>{});
  const auto lone = water.id(mps::add_particle(water, {0.1, 0.5}, mps::Kind::fluid));
  mps::FlowSettings<2, Outer> settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.2, 0}, {0.2, 1}});
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<Outer>(settings), SemiImplicit<>{}};
  for (int k = 0; k < 10; ++k) sim.step();
  const Index i = sim.particles().index_of(lone);
  EXPECT_EQ(sim.particles()[mps::pressure][i], 0);
  EXPECT_NEAR(sim.particles()[velocity][i][1], -9.81 * sim.time(), 1e-12);
}

// With the sums of the full lattice above a plane of particles.
TEST(OuterSurface, WeighsTheMissingHalfOfTheNeighbours) {
  const mps::Stencil<2, double, mps::WendlandKernel> stencil({.spacing = l0, .radius = 3.1});
  double moment = 0, weights = 0;
  for (int y = 1; y <= 3; ++y) {
    for (int x = -3; x <= 3; ++x) {
      const double r = l0 * std::hypot(x, y);
      if (r >= stencil.re) continue;
      moment += stencil.weight(r) * y * l0;
      weights += stencil.weight(r);
    }
  }
  EXPECT_NEAR(stencil.mean_height, moment / weights, 1e-15);
}

}  // namespace
}  // namespace silt::test::outer_surface_test
