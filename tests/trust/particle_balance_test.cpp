// SPDX-License-Identifier: MIT
// Particles present plus those removed are those added, and each keeps what a step does not change,
// while particles enter, leave, cross periodic sides and are sorted.
// Only with --all: every search, in 2D and 3D.
#include <silt/dem.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::test::particle_balance_test {
namespace {

// What was known about the particles after the last step.
template <class P>
class KnownParticles {
 public:
  // Compares with the particles after another step. Returns the number of those that are new.
  Index compare(const P& particles) {
    std::map<Id, Bytes> present;
    Index added = 0;
    for (Index i = 0; i < particles.size(); ++i) {
      const Id id = particles.id(i);
      EXPECT_EQ(particles.index_of(id), i);
      Bytes constants;
      particles.for_each_field([&]<class F>(auto values, F) {
        if constexpr (role_of<F>() == Role::constant) append(constants, std::vector{values[i]});
      });
      const auto known = known_.find(id);
      if (known == known_.end()) {
        EXPECT_GE(id, next_id_) << "a removed particle is there again";
        ++added;
      } else {
        EXPECT_TRUE(known->second == constants) << "of id " << id;
      }
      EXPECT_TRUE(present.emplace(id, std::move(constants)).second) << "id " << id << " twice";
    }
    if (!present.empty()) next_id_ = std::max(next_id_, present.rbegin()->first + 1);
    known_ = std::move(present);
    return added;
  }

 private:
  std::map<Id, Bytes> known_;
  Id next_id_ = 0;
};

constexpr dem::Blend<dem::UniformSizes> pebbles{
    .sizes = {.min_radius = 0.006, .max_radius = 0.012}, .density = 2500};

// Grains rain on a slope between periodic sides; some leave through a region, others the box.
template <int Dim, class S>
void expect_balance_of_grains(Index steps, double time_step) {
  constexpr int up = Dim - 1;
  auto box = cube<Dim, double>(0, 0.2);
  box.periodic.fill(true);
  box.periodic[up] = false;
  box.lower[up] = -0.02;
  box.upper[up] = 0.6;
  box.on_escape = OnEscape::remove;
  auto above = box;
  above.lower[up] = 0.2;
  above.upper[up] = 0.4;
  auto drain = box;
  drain.periodic.fill(false);  // only bounded axes limit a region
  drain.upper[0] = 0.03;
  drain.upper[up] = 0.05;
  const dem::CundallStrack law{.normal_stiffness = 1e4,
                               .tangential_stiffness = 5e3,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  // A wall that ends: beside it, grains fall out of the box.
  Box<Dim> step = cube<Dim, double>(0.08, 0.17);
  step.lower[up] = 0;
  step.upper[up] = 0.03;
  Vec<Dim> pull = -9.81 * Vec<Dim>::Unit(up);
  pull[0] = 3;
  const auto contacts =
      dem::Contacts{law, dem::BoxWall<Dim>{step, dem::Side::outside}}.with(without_limits);
  Simulation simulation{dem::Grains<Dim>(box), S{}, Forces{Gravity<Dim>{pull}, contacts},
                        Leapfrog{}};
  dem::Inflow rain{above, pebbles,
                   {.number = steps, .rate = 1000, .velocity = -2 * Vec<Dim>::Unit(up)}};
  dem::Outflow<Box<Dim>> out{drain};
  KnownParticles<dem::Grains<Dim>> known;
  Index added = 0;
  for (Index k = 0; k < steps && !testing::Test::HasFailure(); ++k) {
    rain.before_step(simulation);
    out.before_step(simulation);
    simulation.step(time_step);
    added += known.compare(simulation.particles());
    EXPECT_EQ(rain.number(), simulation.particles().size() + out.number() +
                                 simulation.particles_lost());
  }
  EXPECT_EQ(added, rain.number());
  EXPECT_GT(added, steps / 20);
  EXPECT_GT(out.number(), steps / 500);
  EXPECT_GT(simulation.particles_lost(), steps / 500);
}

TEST(BalanceOfGrains, HoldsInEveryStep) {
  expect_balance_of_grains<2, NeighbourList<2>>(3000, 2e-4);
  expect_balance_of_grains<2, UniformGrid<2>>(3000, 2e-4);
  expect_balance_of_grains<3, NeighbourList<3, double, LevelGrid<3>>>(3000, 2e-4);
}
TEST(BalanceOfGrains, HoldsInEveryStepOfALongRunSlow) {
  // In time a grain is squeezed between so many others that a longer step would be unstable.
  expect_balance_of_grains<2, NeighbourList<2>>(50'000, 1e-4);
  expect_balance_of_grains<3, LevelGrid<3>>(50'000, 1e-4);
}

// A column collapses and spills over walls that are too low.
template <class Scheme, int Dim>
void expect_balance_of_flow(Index steps) {
  const double l0 = 0.02;
  auto [water, walls] = mps::make_tank<Scheme, Dim>(
      {.column = {6 * l0, 10 * l0},
       .size = {.length = 9 * l0, .height = 10 * l0, .depth = 4 * l0},
       .spacing = l0,
       .on_escape = OnEscape::remove});
  water.remove_if([&](Index i) {
    return water[mps::kind][i] != mps::Kind::fluid && water[position][i][Dim - 1] > 4 * l0;
  });
  if constexpr (std::same_as<decltype(walls), mps::ImageWalls>) {
    walls.segments = polyline({{0, 4 * l0}, {0, 0}, {9 * l0, 0}, {9 * l0, 4 * l0}});
  }
  const Index all = water.size();
  Simulation simulation{std::move(water), UniformGrid<Dim>{},
                        mps::Flow<Scheme, Dim>(
                            {.spacing = l0, .max_time_step = 1e-3, .walls = walls}),
                        SemiImplicit{}};
  using P = std::remove_cvref_t<decltype(simulation.particles())>;
  KnownParticles<P> known;
  EXPECT_EQ(known.compare(simulation.particles()), all);
  for (Index k = 0; k < steps && !testing::Test::HasFailure(); ++k) {
    simulation.step();
    EXPECT_EQ(known.compare(simulation.particles()), 0u);
    EXPECT_EQ(simulation.particles().size() + simulation.particles_lost(), all);
  }
  EXPECT_GT(simulation.particles_lost(), 2u);
}

TEST(BalanceOfAFlow, HoldsInEveryStep) {
  // Later, water that falls between the outer dummy particles is flung away: see FlowWatch.
  expect_balance_of_flow<mps::RecommendedForWallParticles, 2>(300);
  expect_balance_of_flow<mps::Recommended, 2>(400);
  expect_balance_of_flow<mps::Case10, 3>(500);
}

}  // namespace
}  // namespace silt::test::particle_balance_test
