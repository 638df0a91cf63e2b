// SPDX-License-Identifier: MIT
// A run stopped at random steps and resumed with another number of threads is bitwise identical to
// an uninterrupted run. restart_slow_test.cpp covers the other searches and methods.
// Only with --all: random steps; resume_test.cpp resumes a flow at one.
#include "support/file_test.hpp"
#include "support/restart.hpp"

#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace silt::test::restart_test {
namespace {

using Restart = FileTest;

TEST_F(Restart, KeepsTheBitsOfWaterWithANeighbourList) {
  const double l0 = 0.04;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.2, .height = 1}, .spacing = l0});
  const mps::Flow<mps::Recommended> water{
      {.spacing = l0, .speed_scale = 2.8, .walls = tank.walls}};
  for (const std::optional<double> skin : {std::optional<double>(), std::optional(0.05)}) {
    const auto make = [&] {
      return RunWith{Simulation{tank.particles, NeighbourList<2>{{.skin_fraction = skin}}, water,
                                SemiImplicit<>{}}};
    };
    const auto measured = [](const auto& run) {
      const mps::FlowEnergy& energy = run.simulation.interaction().energy();
      return std::vector{energy.kinetic, energy.by_pressure, energy.by_collision, energy.added};
    };
    expect_the_same_bits_after_restarts(path, {.steps = 80, .number = 20}, make, measured);
  }
}

TEST_F(Restart, KeepsTheBitsOfWaterNextToAWallThatChangedItsKind) {
  const double l0 = 0.04;
  const auto tank = mps::make_tank<2>(
      {.column = {0.4, 0.4}, .size = {.length = 0.8, .height = 0.6}, .spacing = l0});
  const auto make = [&] {
    return Simulation{tank, UniformGrid<2>{},
                      mps::Flow<mps::RecommendedForWallParticles>{
                          {.spacing = l0, .speed_scale = 2}},
                      SemiImplicit<>{}};
  };
  auto dam = make();
  for (int k = 0; k < 10; ++k) dam.step();
  auto& particles = dam.particles();
  for (Index i = 0; i < particles.size(); ++i) {
    const bool is_of_floor = particles[position][i][1] < 0;
    if (is_of_floor && particles[mps::kind][i] == mps::Kind::dummy) {
      particles[mps::kind][i] = mps::Kind::wall;
    }
  }
  write_checkpoint(path, dam);
  auto resumed = make();
  read_checkpoint(path, resumed);
  for (int k = 0; k < 10; ++k) {
    dam.step();
    resumed.step();
  }
  EXPECT_EQ(restart::hash(RunWith{dam}), restart::hash(RunWith{resumed}));
}

}  // namespace
}  // namespace silt::test::restart_test
