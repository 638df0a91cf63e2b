// SPDX-License-Identifier: MIT
// The energy balance of a flow: it closes, and has the exact terms of simple flows.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <silt/io/checkpoint.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <utility>

namespace silt::test::flow_energy_test {
namespace {

using mps::Case00;
using mps::Case10;
using mps::Flow;
using mps::FlowEnergy;

// A scheme with particle shifting.
struct Shifted : mps::Case10 {
  mps::ParticleShifting shifting{};
};

template <class Scheme = Case10, int Dim = 2, class Real = double>
auto simulation(mps::Fluid<Dim, Real> particles, mps::FlowSettings<Dim, Scheme> settings) {
  return Simulation{std::move(particles), UniformGrid<Dim, Real>{},
                    Flow<Scheme, Dim, Real>(settings), SemiImplicit{}};
}

// Computed independently of the flow [J].
template <class P>
double kinetic_of(const P& particles, double mass) {
  double sum = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::fluid) continue;
    sum += mass * particles[velocity][i].template cast<double>().squaredNorm() / 2;
  }
  return sum;
}

template <class Scheme, int Dim, class Real>
void expect_closed_balance(double rounding) {
  const double l0 = 0.02;
  const auto tank = mps::make_tank<Scheme, Dim, Real>(small_tank<Dim>(l0));
  auto sim = simulation<Scheme, Dim, Real>(tank.particles, {.spacing = l0,
                                                            .density = 800,
                                                            .viscosity = 1e-3,
                                                            .speed_scale = 2,
                                                            .walls = tank.walls});
  const double mass = 800 * std::pow(l0, Dim);
  const double first = sim.interaction().energy_of(sim.particles()).total();
  for (int k = 0; k < (Dim == 2 ? 200 : 20); ++k) {
    sim.step();
    const FlowEnergy& energy = sim.interaction().energy();
    EXPECT_NEAR(energy.kinetic, kinetic_of(sim.particles(), mass), rounding * first);
    EXPECT_NEAR(energy.imbalance(), 0, rounding * first);
    EXPECT_NEAR(energy.added, 0, rounding * first);
  }
  const FlowEnergy& energy = sim.interaction().energy();
  EXPECT_NEAR(energy.initial, first, rounding * first);
  EXPECT_GT(energy.kinetic, 0.02 * first) << "the column collapses";
  EXPECT_LT(energy.by_viscosity, -1e-6 * first);
  EXPECT_LT(energy.by_collision, -1e-4 * first);
  EXPECT_NE(energy.by_pressure, 0);
  EXPECT_EQ(energy.by_force, 0);
  EXPECT_LT(energy.total(), first);
}

TEST(FlowEnergy, OfADamBreakIsBalancedToRoundOff) {
  expect_closed_balance<Case10, 2, double>(1e-13);
  expect_closed_balance<mps::RecommendedForWallParticles, 3, double>(1e-13);
  expect_closed_balance<mps::Recommended, 2, double>(1e-13);
  expect_closed_balance<Shifted, 2, double>(1e-13);
  expect_closed_balance<Case00, 2, double>(1e-13);
  expect_closed_balance<Case10, 2, float>(1e-5);
}

TEST(FlowEnergy, OfFreeFallIsThatOfTheTimeIntegration) {
  // With semi-implicit Euler the distance exceeds t² g/2 by g t Δt/2.
  const double dt = 1e-3;
  auto sim = simulation(blob<2, double>(8, 0.02), {.spacing = 0.02, .viscosity = 0});
  for (int k = 0; k < 50; ++k) sim.step(dt);
  const FlowEnergy& energy = sim.interaction().energy();
  const double mass = 64 * 1000 * 0.02 * 0.02;
  const double speed = 9.81 * sim.time();  // [m/s]
  EXPECT_NEAR(energy.kinetic, mass * speed * speed / 2, 1e-10);
  EXPECT_NEAR(energy.by_integration, -mass * 9.81 * speed * dt / 2, 1e-10);
  for (const double none : {energy.by_viscosity, energy.by_collision, energy.by_pressure}) {
    EXPECT_NEAR(none, 0, 1e-12);
  }
}

TEST(FlowEnergy, OfAccelerationByABodyForceIsTheWorkOfTheForce) {
  mps::FlowSettings<2, Case10> settings{.spacing = 0.02, .viscosity = 0, .gravity = Vec<2>::Zero()};
  settings.body_force = [](const Vec<2>&, double) { return Vec<2>(3, -4); };
  auto sim = simulation(blob<2, double>(8, 0.02), settings);
  EXPECT_DOUBLE_EQ(sim.time_step(), std::sqrt(0.2 * 0.02 / 5)) << "the limit is that of gravity";
  for (int k = 0; k < 50; ++k) sim.step(1e-3);
  const FlowEnergy& energy = sim.interaction().energy();
  const double mass = 64 * 1000 * 0.02 * 0.02;
  EXPECT_NEAR(energy.kinetic, mass * std::pow(5 * sim.time(), 2) / 2, 1e-10);
  EXPECT_NEAR(energy.by_force, energy.kinetic, 1e-10);
  EXPECT_EQ(energy.potential, 0);
  EXPECT_EQ(energy.by_integration, 0);
}

TEST(FlowEnergy, DissipatedByACollisionFollowsFromItsRestitution) {
  // Head-on at 1 m/s each: the fraction 1 − b² of ½ (m/2) v², v = 2 m/s, is dissipated.
  auto pair = fluid_at<2, double>({{0, 0}, {0.019, 0}});
  pair[velocity][0] = {1, 0};
  pair[velocity][1] = {-1, 0};
  mps::FlowSettings<2, Case10> settings{.spacing = 0.02, .viscosity = 0, .gravity = Vec<2>::Zero()};
  settings.collision.restitution = 0.3;
  auto sim = simulation(std::move(pair), settings);
  sim.step(1e-3);
  const double mass = 1000 * 0.02 * 0.02;
  EXPECT_NEAR(sim.interaction().energy().initial, mass, 1e-15);
  EXPECT_NEAR(sim.interaction().energy().by_collision, -mass * (1 - 0.3 * 0.3), 1e-12);
  EXPECT_EQ(sim.interaction().energy().by_pressure, 0);
}

TEST(FlowEnergy, DissipatedByViscosityIsThatOfAShearWave) {
  // u = U sin ky in a periodic box: K decays as exp(−2 ν k² t), and there is no other effect.
  constexpr int along = 20;
  constexpr double k = 2 * std::numbers::pi;
  const double nu = 0.1;
  auto fluid = full_box<2, double>(along, 1.0 / along);
  for (Index i = 0; i < fluid.size(); ++i) {
    // Displacements are negligible.
    fluid[velocity][i] = {1e-3 * std::sin(k * fluid[position][i][1]), 0};
  }
  mps::FlowSettings<2, Case10> settings{
      .spacing = 1.0 / along, .viscosity = nu, .gravity = Vec<2>::Zero()};
  settings.collision.distance = 0;
  auto sim = simulation(std::move(fluid), settings);
  for (int step = 0; step < 100; ++step) sim.step(5e-4);
  const FlowEnergy& energy = sim.interaction().energy();
  const double lost = 1 - std::exp(-2 * nu * k * k * sim.time());
  EXPECT_NEAR(-energy.by_viscosity / energy.initial, lost, 0.03 * lost);
  EXPECT_NEAR(energy.by_viscosity, energy.kinetic - energy.initial, 1e-3 * energy.initial);
}

TEST(FlowEnergy, IsBitwiseIdenticalForAnyNumberOfThreads) {
  const auto by = [](int number) {
    return with_threads(number, [] {
      auto sim = simulation<Case10>(
          mps::make_tank<2>({.column = {0.8, 0.8},
                             .size = {.length = 1.6, .height = 1.2},
                             .spacing = 0.02}),
          {.spacing = 0.02, .speed_scale = 2.8});
      for (int k = 0; k < 6; ++k) sim.step();
      const FlowEnergy& e = sim.interaction().energy();
      return std::vector{e.kinetic,      e.potential,   e.initial,       e.by_viscosity,
                         e.by_collision, e.by_pressure, e.by_integration, e.added};
    });
  };
  const auto serial = by(1);
  for (const int number : {2, 3, 4}) EXPECT_EQ(by(number), serial) << number;
}

auto dam() { return simulation<Case10>(small_dam<2>(), {.spacing = 0.02, .speed_scale = 2}); }

TEST(FlowEnergy, IsUnchangedByAFailedStep) {
  auto sim = dam();
  auto other = dam();
  for (int k = 0; k < 5; ++k) sim.step(), other.step();
  EXPECT_TRUE(refuses([&] { sim.step(1.0); }, {"time_step"}));
  const auto original = sim.particles()[position][4];
  sim.particles()[position][4] = sim.particles()[position][5];
  EXPECT_THROW(sim.step(), Error);
  sim.particles()[position][4] = original;
  sim.step();
  other.step();
  EXPECT_EQ(sim.interaction().energy().total(), other.interaction().energy().total());
  EXPECT_EQ(sim.interaction().energy().added, other.interaction().energy().added);
  EXPECT_EQ(sim.interaction().energy().by_collision, other.interaction().energy().by_collision);
}

TEST(FlowEnergy, ResumesFromACheckpoint) {
  const auto path = std::filesystem::path(testing::TempDir()) / "silt_energy.silt";
  auto uninterrupted = dam();
  for (int k = 0; k < 20; ++k) uninterrupted.step();
  write_checkpoint(path, uninterrupted);
  auto resumed = dam();
  read_checkpoint(path, resumed);
  std::filesystem::remove(path);
  for (int k = 0; k < 5; ++k) uninterrupted.step(), resumed.step();
  const FlowEnergy& a = uninterrupted.interaction().energy();
  const FlowEnergy& b = resumed.interaction().energy();
  EXPECT_EQ(b.total(), a.total());
  EXPECT_EQ(b.initial, a.initial);
  EXPECT_EQ(b.by_pressure, a.by_pressure);
  EXPECT_EQ(b.by_integration, a.by_integration);
  EXPECT_EQ(b.imbalance(), a.imbalance());
}

TEST(FlowEnergy, AddedBetweenStepsIsThatOfTheChangesByTheUser) {
  auto sim = dam();
  sim.step();
  const double mass = 1000 * 0.02 * 0.02;
  const Vec<2> u = sim.particles()[velocity][7];
  sim.particles()[velocity][7] = {0, 3};
  const double added = mass * (9 - u.squaredNorm()) / 2;
  sim.step(1e-4);
  EXPECT_NEAR(sim.interaction().energy().added, added, 1e-10);
  const FlowEnergy before = sim.interaction().energy_of(sim.particles());
  sim.particles().remove_if([](Index i) { return i < 10; });
  const FlowEnergy after = sim.interaction().energy_of(sim.particles());
  sim.step(1e-4);
  EXPECT_NEAR(sim.interaction().energy().added - added, after.total() - before.total(), 1e-10);
  EXPECT_NEAR(sim.interaction().energy().imbalance(), 0, 1e-10);
}

}  // namespace
}  // namespace silt::test::flow_energy_test
