// SPDX-License-Identifier: MIT
// After the first steps, a step allocates no memory.
#include "support/allocations.hpp"

#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

namespace silt::test::warm_step_test {
namespace {

// Allocations of ten steps of a still tank after twenty steps.
template <int Dim, class Scheme = mps::Case10, class Search>
std::uint64_t allocations_of_tank(Search search, double spacing) {
  const mps::Tank<Dim> tank{.column = {0.2, 0.2},
                            .size = {.length = 0.2, .height = 0.3, .depth = 0.2},
                            .spacing = spacing};
  mps::FlowSettings<Dim, Scheme> settings{.spacing = spacing, .speed_scale = 1.4};
  mps::Fluid<Dim> fluid;
  if constexpr (requires { settings.walls.template faces<Dim>(); }) {
    auto made = mps::make_tank<Scheme, Dim>(tank);
    fluid = std::move(made.particles);
    settings.walls = made.walls;
  } else {
    fluid = mps::make_tank<Dim>(tank);
  }
  Simulation simulation{std::move(fluid), std::move(search), mps::Flow<Scheme, Dim>{settings},
                        SemiImplicit<>{}};
  const double dt = simulation.time_step() / 4;
  for (int k = 0; k < 20; ++k) simulation.step(dt);
  const std::uint64_t before = allocations;
  for (int k = 0; k < 10; ++k) simulation.step(dt);
  return allocations - before;
}

TEST(WarmStep, OfWaterAllocatesNothing) {
  EXPECT_EQ(allocations_of_tank<2>(UniformGrid<2>{}, 0.005), 0U);
  EXPECT_EQ(allocations_of_tank<3>(UniformGrid<3>{}, 0.02), 0U);
  EXPECT_EQ(allocations_of_tank<2>(NeighbourList<2>{}, 0.005), 0U);
  EXPECT_EQ(allocations_of_tank<3>(NeighbourList<3>{}, 0.02), 0U);
}
TEST(WarmStep, OfWaterBetweenFacesAllocatesNothing) {
  EXPECT_EQ((allocations_of_tank<2, mps::Recommended>(UniformGrid<2>{}, 0.005)), 0U);
  EXPECT_EQ((allocations_of_tank<3, mps::Recommended>(UniformGrid<3>{}, 0.02)), 0U);
}

// Verifies that allocations are counted, without which the test above would always pass.
TEST(Allocations, AreCounted) {
  const std::uint64_t before = allocations;
  const std::vector<double> one(100);
  EXPECT_EQ(allocations - before, 1U) << one[0];
}

}  // namespace
}  // namespace silt::test::warm_step_test
