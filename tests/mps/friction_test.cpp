// SPDX-License-Identifier: MIT
// Friction between pairs of particles.
#include <silt/mps.hpp>
#include <silt/mps/policy/friction.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace silt::test::friction_test {
namespace {

static_assert(mps::Friction<mps::NoFriction> && mps::Friction<mps::PairFriction>);
static_assert(mps::HasFriction<mps::PairFriction> && !mps::HasFriction<mps::NoFriction>);
static_assert(!mps::Friction<mps::NoShifting>);

struct Rubbing : mps::RecommendedForWallParticles {
  mps::NoShifting shifting{};
  mps::PairFriction friction{.rate = 1};
};

constexpr double l0 = 0.02;  // [m]
constexpr double dt = 1e-4;  // [s]

template <int Dim = 2>
mps::FlowSettings<Dim, Rubbing> settings() {
  return {.spacing = l0, .viscosity = 0, .speed_scale = 2};
}

/// Its first step, without the pressure: change of velocity of each particle by friction [m/s].
template <int Dim, class P>
std::vector<Vec<Dim>> changes_of(P water, const mps::FlowSettings<Dim, Rubbing>& with) {
  mps::Flow<Rubbing, Dim> flow(with);
  UniformGrid<Dim> grid;
  grid.set_radius(flow.reach(water));
  grid.update(water);
  const std::vector<Vec<Dim>> before(water[velocity].begin(), water[velocity].end());
  flow.predict(water, grid, dt);
  std::vector<Vec<Dim>> changes;
  for (Index i = 0; i < water.size(); ++i) {
    changes.push_back(water[velocity][i] - before[i] - dt * with.gravity);
  }
  return changes;
}

TEST(PairFriction, DoesNotChangeLinearFlows) {
  auto water = blob<2, double>(12, l0, 0.2);
  for (Index i = 0; i < water.size(); ++i) {
    const Vec<2> x = water[position][i];
    water[velocity][i] = {1 + 2 * x[0] - 3 * x[1], 4 * x[0] - 2 * x[1]};
  }
  for (const auto& change : changes_of(water, settings())) EXPECT_LT(change.norm(), 1e-14);
}

template <int Dim>
void expect_a_loss_without_a_change_of_momentum() {
  auto water = full_box<Dim, double>(8, l0, 0.2);
  give_random_velocities(water, 0.1, 3);
  Vec<Dim> momentum = Vec<Dim>::Zero();
  double change_of_energy = 0;
  const auto changes = changes_of(water, settings<Dim>());
  for (Index i = 0; i < water.size(); ++i) {
    momentum += changes[i];
    const Vec<Dim> u = water[velocity][i];
    change_of_energy += (u + changes[i]).squaredNorm() - u.squaredNorm();
  }
  EXPECT_LT(momentum.norm(), 1e-15 * double(water.size()));
  EXPECT_LT(change_of_energy, 0);
}
TEST(PairFriction, TakesEnergyAndNoMomentum) {
  expect_a_loss_without_a_change_of_momentum<2>();
  expect_a_loss_without_a_change_of_momentum<3>();
}

// The noise of a lattice with velocities ±u in turn has no gradient.
TEST(PairFriction, DampsNoiseAtItsRate) {
  auto water = full_box<2, double>(8, l0);
  const auto alternating = [](const Vec<2>& x) {
    return int(std::floor(x[0] / l0) + std::floor(x[1] / l0)) % 2 == 0 ? 0.1 : -0.1;
  };
  for (Index i = 0; i < water.size(); ++i) water[velocity][i] = {alternating(water[position][i]), 0};
  const auto with = settings();
  const mps::Stencil<2, double, mps::WendlandKernel> stencil(
      {.spacing = l0, .radius = with.radius});
  double sum = 0;  // Σ w (x/r)² over the neighbours of the other sign
  for (int y = -3; y <= 3; ++y) {
    for (int x = -3; x <= 3; ++x) {
      const double r = std::hypot(x, y);
      if ((x + y) % 2 != 0 && r * l0 < stencil.re) sum += stencil.weight(r * l0) * x * x / (r * r);
    }
  }
  const double share = dt * std::sqrt(9.81 / l0) * 2 / stencil.n0 * sum;
  const auto changes = changes_of(water, with);
  for (Index i = 0; i < water.size(); ++i) {
    EXPECT_NEAR(changes[i][0], -2 * share * water[velocity][i][0], 1e-6 * share);
  }
}

TEST(PairFriction, NeedsAForce) {
  auto water = blob<2, double>(8, l0, 0.2);
  give_random_velocities(water, 0.1, 3);
  auto with = settings();
  with.gravity = {0, 0};
  for (const auto& change : changes_of(water, with)) EXPECT_EQ(change.norm(), 0);
}

TEST(PairFriction, LeavesSprayAlone) {
  mps::Fluid<2> spray;
  for (const double x : {0.0, 0.02, 0.04}) {
    const Index i = mps::add_particle(spray, {x, 0.01}, mps::Kind::fluid);
    spray[velocity][i] = {10 * x * x, 0};
  }
  for (const auto& change : changes_of(spray, settings())) EXPECT_EQ(change.norm(), 0);
}

auto dam() {
  const auto tank = mps::make_tank<Rubbing>(small_tank<2>());
  auto with = settings();
  with.walls = tank.walls;
  return Simulation{tank.particles, UniformGrid<2>{}, mps::Flow<Rubbing>(with), SemiImplicit<>{}};
}

TEST(PairFriction, IsBookedInTheEnergyBalance) {
  auto sim = dam();
  give_random_velocities(sim.particles(), 0.05, 4);
  for (int k = 0; k < 50; ++k) sim.step();
  const mps::FlowEnergy& energy = sim.interaction().energy();
  EXPECT_LT(energy.by_friction, -1e-5 * energy.initial);
  EXPECT_NEAR(energy.imbalance(), 0, 1e-12 * energy.initial);
}

TEST(PairFriction, IsBitwiseIdenticalForAnyNumberOfThreads) {
  const auto by = [](int number) {
    return with_threads(number, [] {
      auto sim = dam();
      for (int k = 0; k < 20; ++k) sim.step();
      return std::pair{speed_sum(sim.particles()), sim.interaction().energy().by_friction};
    });
  };
  const auto serial = by(1);
  for (const int number : {2, 3}) EXPECT_EQ(by(number), serial) << number;
}

TEST(PairFriction, RefusesANegativeRate) {
  auto with = settings();
  with.friction.rate = -1;
  EXPECT_TRUE(refuses([&] { mps::Flow<Rubbing>{with}; }, {"PairFriction", "rate", "-1"}));
}

}  // namespace
}  // namespace silt::test::friction_test
