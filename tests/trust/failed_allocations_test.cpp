// SPDX-License-Identifier: MIT
// A step or a change of the particles in which any one allocation fails changes nothing, and the
// next one has the same bits as without the failure.
// Only with --all: every allocation of several simulations; core/simulation_test.cpp rolls back one.
#include <silt/dem.hpp>
#include <silt/dem/setup/packing.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/failing_allocations.hpp"
#include "support/grains.hpp"
#include "support/restarted_grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::failed_allocations_test {
namespace {

// Time, steps and all particles by id: sorting before a step is not rolled back.
template <class Sim>
Bytes state_by_id(const Sim& simulation) {
  const auto& particles = simulation.particles();
  std::vector<Index> order(particles.size());
  for (Index i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return particles.id(a) < particles.id(b); });
  Bytes bytes;
  for (const Index i : order) append(bytes, std::vector{particles.id(i)});
  particles.for_each_field([&]<class F>(auto values, F) {
    if constexpr (role_of<F>() != Role::derived) {
      for (const Index i : order) append(bytes, std::vector{values[i]});
    }
  });
  append(bytes, std::vector{simulation.time(), double(simulation.steps())});
  return bytes;
}

// Returns the number of allocations that failed.
template <class Sim>
int fail_each_allocation(Sim simulation, int steps) {
  int failures = 0;
  for (int step = 0; step < steps; ++step) {
    const Bytes before = state_by_id(simulation);
    Sim next = simulation;
    next.step();
    const Bytes after = state_by_id(next);
    for (std::int64_t k = 1;; ++k) {
      Sim trial = simulation;
      if (!fails_with_allocation(k, [&] { trial.step(); })) break;
      ++failures;
      EXPECT_TRUE(state_by_id(trial) == before) << "step " << step << ", allocation " << k;
      trial.step();
      EXPECT_TRUE(state_by_id(trial) == after) << "step " << step << ", allocation " << k;
      if (::testing::Test::HasFailure()) return failures;
    }
    // The simulation itself, not a copy, whose memory is as it is after a step.
    for (std::int64_t k = 1; k < 1000; ++k) {
      if (!fails_with_allocation(k, [&] { simulation.step(); })) break;
      ++failures;
      EXPECT_TRUE(state_by_id(simulation) == before) << "step " << step << ", allocation " << k;
      if (::testing::Test::HasFailure()) return failures;
    }
    EXPECT_TRUE(state_by_id(simulation) == after) << "step " << step;
    simulation = std::move(next);
  }
  return failures;
}

template <class S>
class FailedAllocations : public ::testing::Test {};
using Searches = ::testing::Types<BruteForce<2>, UniformGrid<2>, LevelGrid<2>, NeighbourList<2>,
                                  NeighbourList<2, double, LevelGrid<2>>>;
TYPED_TEST_SUITE(FailedAllocations, Searches);

TYPED_TEST(FailedAllocations, LeaveGrainsAsBeforeTheStep) {
  const RestartedGrains<2> grains({12, 8});
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  auto simulation = grains.make(law, TypeParam{}).simulation;
  for (const int threads : {1, 2}) {
    with_threads(threads, [&] { EXPECT_GT(fail_each_allocation(simulation, 4), 20); });
  }
}

template <class Scheme, class S>
auto falling_column(S search) {
  const mps::Tank<2> tank{
      .column = {0.1, 0.2}, .size = {.length = 0.3, .height = 0.3}, .spacing = 0.02};
  const auto made = mps::make_tank<Scheme>(tank);
  return Simulation{made.particles, std::move(search),
                    mps::Flow<Scheme>({.spacing = tank.spacing,
                                       .max_time_step = 1e-3,
                                       .walls = made.walls}),
                    SemiImplicit{}};
}

// With a piston and a body that falls into the water.
auto falling_body() {
  auto simulation = falling_column<mps::Recommended>(UniformGrid<2>{});
  mps::FlowSettings<2, mps::Recommended> settings = simulation.interaction().settings();
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = polyline({{0.28, 0}, {0.28, 0.2}}), .motion = Translation<2>{{-0.1, 0}}}},
      .bodies = {{.faces = polyline({{0.04, 0.22}, {0.1, 0.22}, {0.1, 0.26}, {0.04, 0.26}, {0.04, 0.22}}),
                  .density = 300,
                  .velocity = {0, -1}}}};
  return Simulation{simulation.particles(), UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                    SemiImplicit{}};
}

TEST(FailedAllocation, LeavesAFlowAsBeforeTheStep) {
  for (const int threads : {1, 2}) {
    with_threads(threads, [&] {
      EXPECT_GT(
          fail_each_allocation(
              falling_column<mps::RecommendedForWallParticles>(UniformGrid<2>{}), 3), 20);
      EXPECT_GT(
          fail_each_allocation(falling_column<mps::Recommended>(UniformGrid<2>{}), 3), 20);
      EXPECT_GT(fail_each_allocation(falling_body(), 3), 20);
      EXPECT_GT(fail_each_allocation(falling_column<mps::Case10>(NeighbourList<2>{}), 3), 20);
      EXPECT_GT(fail_each_allocation(falling_column<mps::Case00>(BruteForce<2>{}), 3), 20);
    });
  }
}

template <class Simulation>
void expect_that_removed_grains_are_restored(Simulation simulation, double dt) {
  simulation.step(dt);  // removes those that are outside already
  const Index before = simulation.particles().size();
  for (int step = 0; step < 10; ++step) {
    for (std::int64_t k = 1;; ++k) {
      auto trial = simulation;
      const Bytes state = state_by_id(trial);
      if (!fails_with_allocation(k, [&] { trial.step(dt); })) break;
      EXPECT_TRUE(state_by_id(trial) == state) << "step " << step << ", allocation " << k;
      EXPECT_EQ(trial.particles_lost(), simulation.particles_lost());
      EXPECT_EQ(trial.time(), simulation.time());
    }
    simulation.step(dt);
  }
  EXPECT_LT(simulation.particles().size(), before);
}
TEST(FailedAllocation, LeavesGrainsThatEscapeAsBeforeTheStep) {
  auto grains = crowd<2, double>(6, 1);
  auto box = cube<2, double>(0, 0.12);
  box.on_escape = OnEscape::remove;
  grains.set_box(box);
  expect_that_removed_grains_are_restored(
      Simulation{grains, BruteForce<2>{}, Gravity<2>{{0, -9.81}}, Leapfrog{}}, 1e-3);
  for (Index i = 0; i < grains.size(); ++i) {  // away from the centre
    grains[velocity][i] = 40 * (grains[position][i] - Vec<2>(0.06, 0.06));
  }
  const dem::Contacts contacts{dem::CundallStrack{.normal_stiffness = 1e5}};
  expect_that_removed_grains_are_restored(
      Simulation{grains, NeighbourList<2>{}, contacts, Leapfrog{}}, 1e-3);
}

// Calls change(particles) with each of its allocations failing.
template <class P, class Change>
void fail_each_allocation_of_change(const P& particles, Change&& change) {
  const Bytes before = state_of(particles);
  for (std::int64_t k = 1;; ++k) {
    P trial = particles;
    if (!fails_with_allocation(k, [&] { change(trial); })) {
      EXPECT_GT(k, 1) << "nothing was allocated";
      EXPECT_FALSE(state_of(trial) == before && trial.total() == particles.total());
      break;
    }
    EXPECT_TRUE(state_of(trial) == before) << "allocation " << k;
    EXPECT_EQ(trial.size(), particles.size());
    for (Index i = 0; i < trial.size(); ++i) EXPECT_EQ(trial.index_of(trial.id(i)), i);
    // All columns still fit together.
    const Index added = trial.add(Vec<3>(1, 2, 3));
    trial.add_ghost(added, Vec<3>::Ones());
    EXPECT_EQ(trial.with_ghosts(position).back(), (Vec<3>(2, 3, 4)));
    EXPECT_EQ(trial.with_ghosts(mass).size(), trial.total());
    EXPECT_EQ(trial.with_ghosts(torque).size(), trial.total());
  }
}

TEST(FailedAllocation, LeavesParticlesAsBefore) {
  const auto grains = dem::make_grains(lattice<3>({{0, 0, 0}, {3, 3, 3}}, 1.0), pebble);
  fail_each_allocation_of_change(grains, [](auto& p) { p.add(Vec<3>::Zero()); });
  fail_each_allocation_of_change(grains, [](auto& p) { p.add_ghost(4, Vec<3>::Ones()); });
  fail_each_allocation_of_change(
      grains, [](auto& p) { p.remove_if([](Index i) { return i % 3 == 1; }); });
  std::vector<Index> backwards(grains.size());
  for (Index i = 0; i < backwards.size(); ++i) backwards[i] = backwards.size() - 1 - i;
  fail_each_allocation_of_change(grains, [&](auto& p) { p.reorder(backwards); });
}

TEST(FailedAllocation, OfAPlacementNamesTheNumberOfGrains) {
  const dem::Blend<dem::EqualSizes> discs{.sizes = {.value = 0.05}, .density = 2500};
  dem::Grains<2> grains;
  for (int k = 0; k < 100; ++k) dem::add_grain(grains, {2.0 + k, 0}, {.radius = 0.1, .density = 1});
  grains.remove_if([](Index i) { return i > 2; });
  const Bytes before = state_of(grains);
  const auto expect_refused = [&](const dem::Scatter& how, const std::string& asked) {
    int refusals = 0;
    for (std::int64_t k = 1; k < 200; ++k) {  // sorting does without its own
      bool refused = false;
      auto trial = grains;
      EXPECT_FALSE(fails_with_allocation(k, [&] {
        try {
          dem::scatter(trial, discs, Box<2>{.lower = {0, 0}, .upper = {1, 1}}, how);
        } catch (const Error& error) {
          refused = true;
          EXPECT_NE(std::string(error.what()).find(asked), std::string::npos) << error.what();
        }
      })) << "allocation " << k;
      EXPECT_EQ(state_of(trial) == before, refused) << "allocation " << k;
      refusals += refused;
    }
    EXPECT_GT(refusals, 20);
    EXPECT_LT(refusals, 198);
  };
  expect_refused({.number = 20}, "number = 20 grains do not fit into memory; place fewer");
  expect_refused({.solid_fraction = 0.1},
                 "solid_fraction = 0.1 gives 12.7324 grains, which do not fit into memory");
}

TEST(Particles, MayBeAddedAtThePositionOfAnother) {
  dem::Grains<3> grains;
  grains.add(Vec<3>(1, 2, 3));
  for (int k = 0; k < 100; ++k) {
    const Index i = grains.add(grains[position][0]);
    EXPECT_EQ(grains[position][i], Vec<3>(1, 2, 3));
  }
}

}  // namespace
}  // namespace silt::test::failed_allocations_test
