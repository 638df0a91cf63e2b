// SPDX-License-Identifier: MIT
// Runs stopped at 200 random steps, with every search, in 2D and 3D, with several laws and schemes,
// in open and in periodic boxes.
#include "support/file_test.hpp"
#include "support/restarted_grains.hpp"

#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::restart_slow_test {
namespace {

using RestartOfGrains = FileTest;
using RestartOfWater = FileTest;

const Restarts restarts{.steps = 400, .number = 200};

const dem::CundallStrack linear{.normal_stiffness = 1e6,
                                .tangential_stiffness = 5e5,
                                .restitution = 0.6,
                                .friction_angle = 0.5};
const dem::Elastic glass{.young_modulus = 1e7, .poisson_ratio = 0.3};
const dem::Law rolling{dem::Hertz{.elastic = glass, .restitution = 0.6},
                       dem::Mindlin{.elastic = glass, .friction_angle = 0.5},
                       dem::RollingResistance{.rolling_friction = 0.1}};

template <int Dim, class Law, class S>
void expect_same_grains(const std::filesystem::path& path, const std::vector<Index>& along,
                        const Law& law, S search) {
  const RestartedGrains<Dim> bed(along);
  expect_the_same_bits_after_restarts(
      path, restarts, [&] { return bed.make(law, search); },
      [&](const auto& run) { return bed.measured(run); });
}

TEST_F(RestartOfGrains, KeepsTheBitsWithANeighbourListSlow) {
  for (const double skin : {0.0, 0.05, 0.4}) {
    expect_same_grains<2>(path, {40, 28}, linear, NeighbourList<2>{{.skin_fraction = skin}});
  }
  expect_same_grains<2>(path, {24, 20}, linear, NeighbourList<2>{});
}
TEST_F(RestartOfGrains, KeepsTheBitsWithAUniformGridSlow) {
  expect_same_grains<2>(path, {40, 28}, linear, UniformGrid<2>{});
}
TEST_F(RestartOfGrains, KeepsTheBitsWithALevelGridSlow) {
  expect_same_grains<2>(path, {40, 28}, linear, LevelGrid<2>{});
}
TEST_F(RestartOfGrains, KeepsTheBitsWithBruteForceSlow) {
  expect_same_grains<2>(path, {18, 16}, linear, BruteForce<2>{});
}
TEST_F(RestartOfGrains, KeepsTheBitsIn3DWithRollingResistanceSlow) {
  expect_same_grains<3>(path, {12, 10, 10}, rolling, NeighbourList<3, double, LevelGrid<3>>{});
}

template <class Flow, class S>
void expect_same_flow(const std::filesystem::path& path, const mps::Fluid<2>& start,
                      const Flow& flow, S search) {
  expect_the_same_bits_after_restarts(
      path, restarts, [&] { return RunWith{Simulation{start, search, flow, SemiImplicit<>{}}}; },
      [](const auto& run) {
        const mps::FlowEnergy& energy = run.simulation.interaction().energy();
        return std::vector{energy.kinetic, energy.by_pressure, energy.by_collision, energy.added};
      });
}

template <class Scheme, class S>
void expect_same_water(const std::filesystem::path& path, S search) {
  const double l0 = 0.03;
  const auto tank = mps::make_tank<Scheme, 2>(
      {.column = {0.39, 0.81}, .size = {.length = 1.2, .height = 0.99}, .spacing = l0});
  const mps::Flow<Scheme> water{{.spacing = l0, .speed_scale = 2.8, .walls = tank.walls}};
  expect_same_flow(path, tank.particles, water, search);
}

// Vortices that carry the fluid across the sides of a periodic box, without a free surface.
template <class S>
void expect_same_vortices(const std::filesystem::path& path, S search) {
  constexpr double l0 = 0.05;
  const Box<2> cell{.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, true}};
  mps::Fluid<2> fluid{cell};
  for (const auto& x : lattice<2>(cell, l0)) {
    const Vec<2> k = 2 * std::numbers::pi * x;
    const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
    fluid[velocity][i] = {0.5 + std::sin(k[0]) * std::cos(k[1]),
                          -std::cos(k[0]) * std::sin(k[1])};
  }
  using Settings = mps::FlowSettings<2, mps::Recommended>;
  const mps::Flow<mps::Recommended> flow{mps::without_free_surface(
      Settings{.spacing = l0, .viscosity = 1e-2, .gravity = {0, 0}, .speed_scale = 1})};
  expect_same_flow(path, fluid, flow, search);
}

TEST_F(RestartOfWater, KeepsTheBitsOfTheRecommendedSchemeSlow) {
  expect_same_water<mps::Recommended>(path, NeighbourList<2>{});
  expect_same_water<mps::Recommended>(path, NeighbourList<2>{{.skin_fraction = 0.02}});
}
TEST_F(RestartOfWater, KeepsTheBitsOfTheRecommendedSchemeWithAUniformGridSlow) {
  expect_same_water<mps::Recommended>(path, UniformGrid<2>{});
}
TEST_F(RestartOfWater, KeepsTheBitsOfTheRecommendedSchemeWithBruteForceSlow) {
  expect_same_water<mps::Recommended>(path, BruteForce<2>{});
}
TEST_F(RestartOfWater, KeepsTheBitsInAPeriodicBoxSlow) {
  expect_same_vortices(path, NeighbourList<2>{});
  expect_same_vortices(path, UniformGrid<2>{});
  expect_same_vortices(path, BruteForce<2>{});
}
TEST_F(RestartOfWater, KeepsTheBitsOfTheOriginalSchemeSlow) {
  expect_same_water<mps::Case00>(path, NeighbourList<2>{});
}
TEST_F(RestartOfWater, KeepsTheBitsOfTheLastCaseOfThePaperSlow) {
  expect_same_water<mps::Case10>(path, BruteForce<2>{});
}

}  // namespace
}  // namespace silt::test::restart_slow_test
