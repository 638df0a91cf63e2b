// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>

#include "support/check.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace silt::test::inflow_test {
namespace {

const dem::Blend<dem::UniformSizes> pebbles{.sizes = {.min_radius = 0.008, .max_radius = 0.012},
                                            .density = 2500};
const dem::CundallStrack law{.normal_stiffness = 1e6,
                             .tangential_stiffness = 5e5,
                             .restitution = 0.5,
                             .friction_angle = 0.4};
const Box<2> above{.lower = {0, 0.3}, .upper = {0.2, 0.4}};

auto empty_bin() {
  return Simulation{dem::Grains<2>{}, NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}},
                           dem::Contacts{law, dem::Plane<2>{}, dem::Plane<2>{.normal = {1, 0}},
                                         dem::Plane<2>{.point = {0.2, 0}, .normal = {-1, 0}}}},
                    Leapfrog{}};
}

TEST(Inflow, AddsTheGivenNumberWithoutOverlap) {
  auto bin = empty_bin();
  dem::Inflow rain{above, pebbles, {.number = 100, .velocity = {0, -1}, .every = 0.02}};
  double max_energy = 0;
  const auto see = [&](const auto& sim) {
    for (Index i = 0; i < sim.particles().size(); ++i) {
      const auto& v = sim.particles()[velocity][i];
      max_energy =
          std::max(max_energy, v.squaredNorm() / 2 + 9.81 * sim.particles()[position][i][1]);
    }
  };
  bin.run({.until = 0.6, .output_every = 0.005}, see, rain);
  EXPECT_TRUE(rain.is_done());
  EXPECT_EQ(bin.particles().size(), 100u);
  EXPECT_LT(max_energy, 1.1 * (0.5 + 9.81 * 0.4)) << "no grain was accelerated by an overlap";
}

TEST(Inflow, AddsGrainsAtTheGivenRate) {
  auto bin = empty_bin();
  dem::Inflow rain{above, pebbles, {.number = 50, .rate = 100, .from = 0.1, .velocity = {0, -1}}};
  std::vector<Index> numbers;
  bin.run({.until = 1, .output_every = 0.1, .time_step = 1e-4}, rain,
          [&](const auto& sim) { numbers.push_back(sim.particles().size()); });
  // The step at 0.1 s adds the first grain.
  EXPECT_EQ(numbers, (std::vector<Index>{0, 0, 10, 20, 30, 40, 50, 50, 50, 50, 50}));
}

TEST(Inflow, DrawsGrainsIndependentOfTheRun) {
  auto rained = empty_bin();
  dem::Inflow rain{above, pebbles, {.number = 30, .rate = 1000, .seed = 5}};
  rained.run({.until = 0.2, .time_step = 1e-4}, rain);
  auto filled = empty_bin();
  dem::Inflow filling{above, pebbles, {.number = 30, .seed = 5}};
  filled.run({.until = 0.2, .time_step = 1e-4}, filling);
  ASSERT_EQ(rained.particles().size(), 30u);
  ASSERT_EQ(filled.particles().size(), 30u);
  for (Id id = 0; id < 30; ++id) {
    EXPECT_EQ(rained.particles()[radius][rained.particles().index_of(id)],
              filled.particles()[radius][filled.particles().index_of(id)]);
  }
}

TEST(Inflow, AddsNoGrainIntoAWall) {
  auto bin = empty_bin();
  // Beyond both sides and below the floor of the bin.
  const Box<2> around{.lower = {-0.1, -0.1}, .upper = {0.3, 0.1}};
  dem::Inflow filling{around, pebbles, {.number = 60}};
  filling.before_step(bin);
  const auto& grains = std::as_const(bin.particles());
  EXPECT_GT(grains.size(), 10u);
  for (Index i = 0; i < grains.size(); ++i) {
    const auto& x = grains[position][i];
    const double R = grains[radius][i];
    EXPECT_GE(x[0], R);
    EXPECT_LE(x[0], 0.2 - R);
    EXPECT_GE(x[1], R);
  }
}

TEST(Inflow, KeepsClearOfAMovingWallAtThatTime) {
  const dem::Moving piston{dem::Plane<2>{}, dem::Translation<2>{.velocity = {0, 1}}};
  Simulation lifted{dem::Grains<2>{}, NeighbourList<2>{}, dem::Contacts{law, piston}, Leapfrog{}};
  const Box<2> region{.lower = {0, 0}, .upper = {0.2, 0.4}};
  dem::Inflow filling{region, pebbles, {.number = 20, .from = 0.2}};
  lifted.run({.until = 0.201, .time_step = 1e-4}, filling);
  const auto& grains = std::as_const(lifted.particles());
  EXPECT_EQ(grains.size(), 20u);
  for (Index i = 0; i < grains.size(); ++i) {
    EXPECT_GE(grains[position][i][1], 0.2 + grains[radius][i] - 1e-12);
  }
}

// Discs of a radius of up to 12 mm in a slot: whether there is ever room for the next of them.
TEST(Inflow, RefusesARegionInWhichAGrainHasNeverRoom) {
  const auto pour = [](const Box<2>& region, const Box<2>& box = {}) {
    Simulation empty{dem::Grains<2>{box}, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
    dem::Inflow filling{region, pebbles, {.number = 100}};
    for (int attempt = 0; attempt < 100; ++attempt) filling.before_step(empty);
    return filling.number();
  };
  // Wide enough for the first ones, but not for all.
  EXPECT_TRUE(refuses([&] { pour({{0, 0}, {0.0235, 1}}); },
                      {"Inflow: a grain of radius 0.011", "no room in the region"}));
  // As wide as a grain: no random position is exactly in its middle.
  const dem::Blend<dem::EqualSizes> equal{.sizes = {0.01}, .density = 2500};
  auto bin = empty_bin();
  dem::Inflow slot{Box<2>{{0.1, 0.1}, {0.12, 0.3}}, equal, {.number = 1}};
  EXPECT_TRUE(refuses([&] { slot.before_step(bin); },
                      {"Inflow: a grain of radius 0.01 m has no room in the region: none of 100000",
                       "enlarge the region"}));
  // Wrapped, all positions are outside of the region.
  const Box<2> box{.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, false}};
  EXPECT_TRUE(refuses([&] { pour({{1.2, 0}, {1.6, 1}}, box); }, {"periodic box", "move it"}));
  EXPECT_GT(pour({{0.8, 0}, {1.2, 1}}, box), 20u) << "across a periodic side";
}

TEST(Inflow, RefusesARegionBehindWalls) {
  auto bin = empty_bin();
  dem::Inflow below{Box<2>{{0, -0.2}, {0.2, 0.015}}, pebbles, {.number = 5}};
  EXPECT_TRUE(refuses([&] { below.before_step(bin); },
                      {"Inflow: a grain of radius 0.0", "clear of the walls", "t = 0 s", "(from)"}));
  EXPECT_EQ(bin.particles().size(), 0u);
  EXPECT_EQ(below.number(), 0u);

  // Beside a wall that moves away, it may begin then.
  const dem::Moving lift{dem::Plane<2>{.point = {0, 0.1}}, dem::Translation<2>{.velocity = {0, -1}}};
  Simulation opened{dem::Grains<2>{}, NeighbourList<2>{}, dem::Contacts{law, lift}, Leapfrog{}};
  const Box<2> region{.lower = {0, 0}, .upper = {0.2, 0.1}};
  dem::Inflow early{region, pebbles, {.number = 5}};
  EXPECT_TRUE(refuses([&] { early.before_step(opened); }, {"clear of the walls"}));
  dem::Inflow later{region, pebbles, {.number = 5, .from = 0.09}};
  opened.run({.until = 0.1, .time_step = 1e-3}, later);
  EXPECT_TRUE(later.is_done());
}

// It may be drained, and is only counted: also when a wall comes later.
TEST(Inflow, WaitsForOtherGrainsToMoveAway) {
  const dem::Moving lid{dem::Plane<2>{.point = {0, 0.4}, .normal = {0, -1}},
                        dem::Translation<2>{.velocity = {0, -1}}};
  Simulation filled{dem::Grains<2>{}, NeighbourList<2>{}, dem::Contacts{law, lid}, Leapfrog{}};
  dem::Inflow rain{above, pebbles, {.number = 1000, .tries = 50}};
  for (int attempt = 0; attempt < 100; ++attempt) rain.before_step(filled);
  EXPECT_FALSE(rain.is_done());
  const Index before = rain.number();
  EXPECT_EQ(rain.positions_tried() % 50, 0u);
  const auto tried = rain.positions_tried();
  EXPECT_GT(tried, 500u);
  rain.before_step(filled);
  EXPECT_EQ(rain.number(), before);
  EXPECT_EQ(rain.positions_tried(), tried + 50);
  filled.particles().remove_if([](Index) { return true; });
  filled.run({.until = 0.12, .time_step = 1e-3});
  EXPECT_NO_THROW(rain.before_step(filled)) << "the lid is below the region";
  EXPECT_EQ(rain.number(), before);
}

TEST(Outflow, CountsRemovedGrains) {
  dem::Grains<2> grains;
  for (const double x : {0.0, 0.1, 0.2}) {
    dem::add_grain(grains, {x, 0.1 + x}, {.radius = 0.01, .density = 2500});
  }
  const double each = grains[mass][0];
  Simulation fall{grains, UniformGrid<2>{}, Gravity<2>{{0, -9.81}}, Leapfrog{}};
  Box<2> below;
  below.upper[1] = 0;
  dem::Outflow drain{below};
  // They fall by 0.1, 0.2 and 0.3 m in 0.143, 0.202 and 0.247 s.
  std::vector<Index> left;
  fall.run({.until = 0.25, .output_every = 0.05, .time_step = 1e-3}, drain,
           [&](const auto& sim) { left.push_back(sim.particles().size()); });
  EXPECT_EQ(left, (std::vector<Index>{3, 3, 3, 2, 2, 0}));
  EXPECT_EQ(drain.number(), 3u);
  EXPECT_NEAR(drain.mass(), 3 * each, 1e-12);
}

TEST(Inflow, ThrowsForValuesOutOfRange) {
  EXPECT_TRUE(refuses([] { dem::Inflow(above, pebbles, {.number = 1, .rate = 0.0}); },
                      {"Inflow: rate = 0"}));
  EXPECT_TRUE(refuses([] { dem::Inflow(above, pebbles, {.number = 1, .every = -1}); },
                      {"Inflow: every = -1"}));
  const dem::Blend<dem::EqualSizes> weightless{.sizes = {0.01}, .density = 0};
  EXPECT_TRUE(refuses([&] { dem::Inflow(above, weightless, {.number = 1}); }, {"density = 0"}));
  EXPECT_TRUE(
      refuses([] { dem::Outflow(dem::VerticalCylinder<>{}); }, {"VerticalCylinder: radius"}));
}

// Otherwise every search and list of contacts would have to look at all grains in every step.
TEST(Outflow, MovesNoGrainUnlessItRemovesOne) {
  dem::Grains<2> grain;
  dem::add_grain(grain, {0, 0}, {.radius = 0.01, .density = 2500});
  Simulation rest{grain, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  const auto& grains = std::as_const(rest).particles();
  const auto before = grains.travel();
  dem::Outflow aside{Box<2>{.lower = {1, 1}, .upper = {2, 2}}};
  aside.before_step(rest);
  EXPECT_TRUE(grains.travel().is_within(0, before));
  dem::Outflow around{Box<2>{.lower = {-1, -1}, .upper = {1, 1}}};
  around.before_step(rest);
  EXPECT_FALSE(grains.travel().is_within(0, before));
}

TEST(Outflow, MayRemoveTheLastGrainOfARun) {
  dem::Grains<2> grain;
  dem::add_grain(grain, {0, 0}, {.radius = 0.01, .density = 2500});
  dem::Outflow below{Box<2>{.lower = {-1, -2}, .upper = {1, -0.1}}};
  Simulation fall{grain, UniformGrid<2>{}, Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law}},
                  Leapfrog{}};
  fall.run({.until = 0.3}, below);
  EXPECT_EQ(below.number(), 1u);
  EXPECT_GE(fall.time(), 0.3 * (1 - 1e-12));
}

}  // namespace
}  // namespace silt::test::inflow_test
