// SPDX-License-Identifier: MIT
// The watch over the energy of a step: contacts that give more energy than they had are refused in
// that step, and nothing else is.
// Only with --all: forty kinds of contacts; watch_test.cpp has errors of each kind of step.
#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/euler.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::energy_watch_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double R = pebble.radius;

// A spring whose force has an error of units, or its energy.
struct Spring {
  double stiffness_in_force = 1e4;  // [N/m]
  double stiffness_in_energy = 1e4;

  template <class C>
  dem::NormalForce<C> normal_force(const C& contact) const {
    return {.spring = typename C::Real(stiffness_in_force) * contact.overlap};
  }
  template <class C>
  double elastic_energy(const C& contact) const {
    return stiffness_in_energy * double(contact.overlap) * double(contact.overlap) / 2;
  }
  template <class C>
  dem::Stiffness stiffness(const C&) const {
    return {.normal = stiffness_in_energy};
  }
};
constexpr Spring wrong{.stiffness_in_force = 1e8};

// The same without its energy.
struct SpringOfUnknownEnergy {
  template <class C>
  dem::NormalForce<C> normal_force(const C& contact) const {
    return wrong.normal_force(contact);
  }
};

// Two grains of 10 g that approach each other with 0.1 m/s.
template <int Dim>
auto approaching_grains() {
  return two_grains<Dim>(1e-5, -0.1 * Vec<Dim>::Unit(0),
                         {.radius = R, .density = Dim == 2 ? 30.0 : 2500.0});
}

// Steps of dt until one fails; returns the text of the error, empty if none fails.
template <class Sim>
std::string text_of_failure(Sim& sim, double dt, int steps) {
  try {
    for (int k = 0; k < steps; ++k) sim.step(dt);
  } catch (const Error& error) {
    EXPECT_EQ(error.where().step, std::optional<std::uint64_t>(sim.steps()));
    EXPECT_EQ(error.where().time, std::optional<double>(sim.time()));
    EXPECT_TRUE(error.where().id.has_value());
    return error.what();
  }
  return {};
}

constexpr double dt = 4e-5;

// Returns the text of the error.
template <class Sim>
std::string expect_refused(Sim sim) {
  const std::string text = text_of_failure(sim, dt, 10);
  EXPECT_NE(text.find("J in the springs of contacts"), std::string::npos) << text;
  EXPECT_NE(text.find("more than max_energy_gain = 10 times"), std::string::npos) << text;
  EXPECT_NE(text.find("check its force and its elastic energy"), std::string::npos) << text;
  // The step is rolled back: the next one fails in the same way.
  const auto before = state_of(sim.particles());
  EXPECT_EQ(text_of_failure(sim, dt, 1), text);
  EXPECT_TRUE(state_of(sim.particles()) == before);
  return text;
}

TEST(EnergyWatch, RefusesALawThatGivesMoreEnergyThanItsSpringsHold) {
  expect_refused(Simulation{approaching_grains<3>(), BruteForce<3>{},
                            dem::Contacts{dem::Law{wrong}}, Leapfrog{}});
  expect_refused(Simulation{approaching_grains<2>(), BruteForce<2>{},
                            dem::Contacts{dem::Law{wrong}}, Leapfrog{}});
  expect_refused(Simulation{one_grain<3>({0, 0, 1.001 * R}, {0, 0, -0.1}), BruteForce<3>{},
                            dem::Contacts{dem::Law{wrong}, dem::Plane<3>{}},
                            Leapfrog{GlobalDamping{.alpha = 1}}});
}

// A wall at rest does no work, and one that recedes takes energy.
TEST(EnergyWatch, NamesMovingWallsThatDidWork) {
  for (const double speed : {0.01, 0.0, -0.001}) {
    const dem::Moving floor{dem::Plane<3>{}, dem::Translation<3>{{0, 0, speed}}};
    const std::string text =
        expect_refused(Simulation{one_grain<3>({0, 0, 1.001 * R}, {0, 0, -0.1}), BruteForce<3>{},
                                  dem::Contacts{dem::Law{wrong}, floor}, Leapfrog{}});
    EXPECT_EQ(text.find("J by moving walls and the") != std::string::npos, speed > 0) << text;
    EXPECT_NE(text.find("J by other forces"), std::string::npos) << text;
  }
}

// Neither overlaps nor displacements are far from their usual values.
TEST(EnergyWatch, RefusesWhatOtherLimitsDoNot) {
  Simulation sim{approaching_grains<3>(), BruteForce<3>{},
                 dem::Contacts{dem::Law{wrong}}.with({.max_energy_gain = infinity}), Leapfrog{}};
  const double before = kinetic_energy(sim.particles());
  EXPECT_EQ(text_of_failure(sim, dt, 10), "");
  EXPECT_GT(kinetic_energy(sim.particles()), 100 * before);
}

TEST(EnergyWatch, NamesTheEnergyOfSpringsBeforeTheStep) {
  Simulation sim{approaching_grains<3>(), BruteForce<3>{}, dem::Contacts{dem::Law{wrong}},
                 Leapfrog{}};
  const std::string text = text_of_failure(sim, dt, 10);
  const auto x = sim.particles()[position];
  const double stored = wrong.stiffness_in_energy * squared(R + R - (x[1] - x[0]).norm()) / 2;
  EXPECT_GT(stored, 0);
  EXPECT_NE(text.find("the " + to_text(stored) + " J in the springs"), std::string::npos) << text;
}

// Accelerates the relative rotation of grains.
struct Motor {
  double couple_per_spin;  // [N m s]

  template <class C>
  dem::RollingCouple<C> rolling_couple(const C& contact, const dem::NormalForce<C>&) const {
    return {.spring = typename C::Real(couple_per_spin) * contact.relative_spin};
  }
  template <class C>
  double elastic_energy(const C&) const {
    return 0;
  }
};
template <int Dim>
void expect_motor_to_be_refused(const AngularVec<Dim>& turning) {
  auto grains = approaching_grains<Dim>();
  for (const double sign : {1, -1}) grains[spin][sign > 0] = sign * turning;
  expect_refused(Simulation{grains, BruteForce<Dim>{},
                            dem::Contacts{dem::Law{Spring{}, Motor{100 * grains[inertia][0] / dt}}},
                            Leapfrog{}});
}
TEST(EnergyWatch, RefusesCouplesThatGiveEnergyToRotation) {
  expect_motor_to_be_refused<2>(10);
  expect_motor_to_be_refused<3>({10, 10, 10});
}

TEST(EnergyWatch, ChecksTheStepsOfAnyIntegrator) {
  expect_refused(Simulation{approaching_grains<3>(), BruteForce<3>{},
                            Forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{dem::Law{wrong}}},
                            Euler{}});
  Simulation right{approaching_grains<3>(), BruteForce<3>{}, dem::Contacts{dem::Law{Spring{}}},
                   Euler{}};
  EXPECT_EQ(text_of_failure(right, dt, 100), "");
}

TEST(EnergyWatch, RefusesSpringsThatAreUnstable) {
  const dem::CundallStrack stiff{.normal_stiffness = 1e7};  // stable to 4.6e-5 s
  const auto grains = approaching_grains<3>();
  const auto contacts = dem::Contacts{stiff};
  Simulation checked{grains, BruteForce<3>{}, contacts, Leapfrog{}};
  EXPECT_NE(text_of_failure(checked, 1.6e-4, 2).find("stable time step"), std::string::npos);
  Simulation unchecked{grains, BruteForce<3>{}, contacts.with({.check_stability = false}),
                       Leapfrog{}};
  EXPECT_NE(text_of_failure(unchecked, 1.6e-4, 2).find("max_energy_gain"), std::string::npos);
}

TEST(EnergyWatch, NeedsTheEnergyOfAllSprings) {
  Simulation sim{approaching_grains<3>(), BruteForce<3>{},
                 dem::Contacts{dem::Law{SpringOfUnknownEnergy{}}}, Leapfrog{}};
  EXPECT_EQ(text_of_failure(sim, dt, 10), "");
}

TEST(EnergyWatch, GivesTheSameTextOnAnyNumberOfThreads) {
  dem::Grains<3> grains;
  for (const auto& x : random_points(2000, cube<3, double>(0, 1), 3)) {
    const Vec<3> place{std::floor(16 * x[0]), std::floor(16 * x[1]), std::floor(16 * x[2])};
    const Vec<3> gap = (2 * R + 1e-5 * (1 + x[0])) * Vec<3>::Unit(0);
    if (std::any_of(grains[position].begin(), grains[position].end(),
                    [&](const auto& y) { return (y - 0.1 * place).norm() < 1e-9; })) {
      continue;
    }
    dem::add_grain(grains, 0.1 * place, pebble);
    const Index second = dem::add_grain(grains, 0.1 * place + gap, pebble);
    grains[velocity][second] = {-0.1 - 0.01 * x[1], 0, 0};
  }
  ASSERT_GT(grains.size(), 2 * chunk_size);
  Simulation sim{grains, UniformGrid<3>{}, dem::Contacts{dem::Law{wrong}}, Leapfrog{}};
  const auto text = [&](int number) {
    return with_threads(number, [copy = sim]() mutable { return text_of_failure(copy, dt, 10); });
  };
  const std::string alone = text(1);
  EXPECT_NE(alone.find("max_energy_gain"), std::string::npos) << alone;
  for (const int number : {2, 3, 4}) EXPECT_EQ(text(number), alone) << number << " threads";
}

TEST(EnergyWatch, RefusesGainsThatAreNotAboveOne) {
  const dem::Contacts contacts{Spring{}.stiffness(0)};
  for (const double gain : {1.0, 0.0, -1.0, std::nan("")}) {
    EXPECT_TRUE(refuses([&] { contacts.with({.max_energy_gain = gain}); }, {"max_energy_gain = "}));
  }
}

// No false alarm.

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.8,
                             .friction_angle = 0.4};

template <class Sim>
void expect_accepted(Sim sim, double time_step, int steps) {
  EXPECT_EQ(text_of_failure(sim, time_step, steps), "");
}
template <class Sim>
void expect_accepted(Sim sim, int steps) {
  const double time_step = sim.time_step();
  expect_accepted(std::move(sim), time_step, steps);
}

TEST(EnergyWatch, AcceptsFreeFallFromRest) {
  const Gravity<3> gravity{{0, 0, -9.81}};
  for (const double height : {R, R * (1 + 1e-14), 1.001 * R}) {
    expect_accepted(Simulation{one_grain<3>({0, 0, height}, {0, 0, 0}), BruteForce<3>{},
                               Forces{gravity, dem::Contacts{law, dem::Plane<3>{}}}, Leapfrog{}},
                    500);
  }
}

// Also with the longest time step that is stable.
TEST(EnergyWatch, AcceptsGrainsThatAreReleasedFromOverlaps) {
  for (const double overlap : {1e-14, 1e-9, 1e-4, 0.1}) {
    const auto grains = two_grains<3>(-overlap * R, {0, 0, 0});
    const double stable = 2 * std::sqrt(grains[mass][0] / 2 / law.normal_stiffness);
    const dem::CundallStrack spring{.normal_stiffness = law.normal_stiffness};
    expect_accepted(Simulation{grains, BruteForce<3>{}, dem::Contacts{law}, Leapfrog{}}, 200);
    for (const double share : {0.999, 0.5, 0.1}) {
      expect_accepted(Simulation{grains, BruteForce<3>{}, dem::Contacts{spring}, Leapfrog{}},
                      share * stable, 20);
      expect_accepted(Simulation{grains, BruteForce<3>{}, dem::Contacts{spring}, Euler{}},
                      share * stable, 20);
    }
    const dem::Hertz hertz{.elastic = {.young_modulus = 1e7, .poisson_ratio = 0.3}};
    expect_accepted(Simulation{grains, BruteForce<3>{}, dem::Contacts{dem::Law{hertz}}, Leapfrog{}},
                    200);
  }
}

// A single grain between two walls stands still twice in every period.
TEST(EnergyWatch, AcceptsTurningPoints) {
  const dem::CundallStrack spring{.normal_stiffness = 1e5};
  const dem::Plane<3> lid{.point = {0, 0, 1.9 * R}, .normal = {0, 0, -1}};
  for (const double time_step : {1e-5, 1.7e-5, 1e-4, 2.9e-4}) {
    expect_accepted(Simulation{one_grain<3>({0, 0, 0.9 * R}, {0, 0, 0}), BruteForce<3>{},
                               dem::Contacts{spring, dem::Plane<3>{}, lid}, Leapfrog{}},
                    time_step, 2000);
  }
}

// The energy is that of the surfaces: the springs are not even compressed.
TEST(EnergyWatch, AcceptsGrainsThatSnapIntoAnAdhesiveContact) {
  const dem::LinearSpringDashpot spring{.normal_stiffness = 1e5, .restitution = 0.5};
  const dem::DmtAdhesion dmt{.surface_energy = 1};
  const dem::ConstantCohesion cohesion{.pull = 1};
  for (const double speed : {1e-9, 1e-6, 1e-3}) {
    const auto grains = two_grains<3>(1e-6 * speed, Vec<3>(-speed, 0, 0));
    expect_accepted(
        Simulation{grains, BruteForce<3>{}, dem::Contacts{dem::Law{spring, dmt}}, Leapfrog{}}, 300);
    expect_accepted(
        Simulation{grains, BruteForce<3>{}, dem::Contacts{dem::Law{spring, cohesion}}, Leapfrog{}},
        300);
  }
}

// Grains pressed less than their adhesion would: the energy of the contact is negative.
TEST(EnergyWatch, AcceptsAdhesiveGrainsThatAreReleased) {
  const dem::Law law_of_powder{dem::LinearSpringDashpot{.normal_stiffness = 1e5},
                               dem::ConstantCohesion{.pull = 10}};  // balanced at 1e-4 m
  for (const double overlap : {1e-8, 0.5e-4, 1.01e-4, 1.5e-4, 2e-4, 2.01e-4, 3e-4}) {
    const auto grains = two_grains<3>(-overlap, {0, 0, 0});
    for (const double time_step : {1e-5, 4e-4}) {
      expect_accepted(Simulation{grains, BruteForce<3>{}, dem::Contacts{law_of_powder}, Leapfrog{}},
                      time_step, 50);
    }
  }
}

template <int Dim, class Real>
auto bed_at_rest() {
  auto grains = dem::make_grains(
      lattice(Box<Dim, Real>{Vec<Dim, Real>::Zero(), Vec<Dim, Real>::Constant(Real(0.082))},
              Real(0.0205)),
      pebble);
  const Vec<Dim, Real> g = Real(-9.81) * Vec<Dim, Real>::Unit(Dim - 1);
  Box<Dim, Real> box;
  box.lower.setZero();
  box.upper = Vec<Dim, Real>::Constant(Real(0.085));
  box.upper[Dim - 1] = Real(infinity);
  return Simulation{
      grains, UniformGrid<Dim, Real>{},
      Forces{Gravity<Dim, Real>{g}, dem::Contacts{law, dem::BoxWall<Dim, Real>{.box = box}}},
      Leapfrog{GlobalDamping{.alpha = 50}}};
}

template <class Sim>
void expect_rest_is_accepted(Sim bed) {
  EXPECT_EQ(text_of_failure(bed, bed.time_step(), 12000), "");
  EXPECT_LT(energy_of_motion(bed.particles()),
            1e-3 * double(bed.interaction().template part<1>().elastic_energy(bed.particles())));
  EXPECT_EQ(text_of_failure(bed, bed.time_step(), 4000), "");
}
TEST(EnergyWatch, AcceptsABedAtRest) {
  expect_rest_is_accepted(bed_at_rest<2, double>());
  expect_rest_is_accepted(bed_at_rest<3, double>());
  expect_rest_is_accepted(bed_at_rest<2, float>());
  expect_rest_is_accepted(bed_at_rest<3, float>());
}

TEST(EnergyWatch, AcceptsAGas) {
  auto grains = crowd<3, double>(8, 3);
  auto box = cube<3, double>(0, 0.17);
  box.periodic = {true, true, true};
  grains.set_box(box);
  expect_accepted(Simulation{std::move(grains), NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}},
                  1000);
}

// The work of the wall is not the contacts' own.
TEST(EnergyWatch, AcceptsAWallThatHitsGrainsAtRest) {
  const dem::CundallStrack damped{.normal_stiffness = 1e5, .restitution = 0.1};
  for (const double speed : {1e-3, 1.0, 30.0}) {
    const dem::Moving piston{dem::Plane<3>{.point = {0, 0, -1e-6}},
                             dem::Translation<3>{{0, 0, speed}}};
    expect_accepted(Simulation{one_grain<3>({0, 0, R}, {0, 0, 0}), BruteForce<3>{},
                               dem::Contacts{damped, piston}, Leapfrog{}},
                    400);
  }
  const dem::Moving floor{dem::Plane<3>{},
                          dem::Vibration<3>{.amplitude = {0, 0, 1e-3}, .frequency = 50}};
  expect_accepted(Simulation{one_grain<3>({0, 0, R}, {0, 0, 0}), BruteForce<3>{},
                             dem::Contacts{damped, floor}, Leapfrog{}},
                  2000);
}

// The wall takes as much as gravity gives to a grain that turns round.
TEST(EnergyWatch, AcceptsAWallThatRecedes) {
  const dem::CundallStrack spring{.normal_stiffness = 1e5};
  auto grain = one_grain<3>({0, 0, 0}, {0, 0, 0});
  const double omega = std::sqrt(spring.normal_stiffness / grain[mass][0]);
  const double time_step = 0.2 / omega;
  const double g = 9.81;
  const double overlap = g * time_step * time_step;
  grain[position][0] = {0, 0, R - overlap};
  grain[velocity][0] = {g * time_step / 2, 0, omega * omega * overlap * time_step / 2};
  for (const double speed : {0.0, 0.1, 1.0}) {
    const dem::Moving floor{dem::Plane<3>{}, dem::Translation<3>{{0, 0, -speed}}};
    expect_accepted(
        Simulation{grain, BruteForce<3>{},
                   Forces{Gravity<3>{{g, 0, 0}}, dem::Contacts{spring, floor}}, Leapfrog{}},
        time_step, 5);
  }
}

// A user-defined force that acts on grains with contacts.
struct Blow {
  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& grains, const S&, double) const {
    grains[force][0][0] += 1e3;
  }
};

TEST(EnergyWatch, AcceptsTheWorkOfOtherForces) {
  expect_accepted(Simulation{two_grains<3>(-1e-6, {0, 0, 0}), BruteForce<3>{},
                             Forces{dem::Contacts{law}, Blow{}}, Leapfrog{}},
                  1e-5, 5);
}

TEST(EnergyWatch, AcceptsAnInflow) {
  dem::Grains<3> grains;
  const dem::Blend<dem::UniformSizes> blend{.sizes = {.min_radius = 0.006, .max_radius = 0.012},
                                            .density = 2500};
  dem::Inflow rain(Box<3>{{0, 0, 0.1}, {0.2, 0.2, 0.2}}, blend,
                   {.number = 100, .rate = 500, .velocity = {0, 0, -1}});
  Simulation sim{grains, UniformGrid<3>{},
                 Forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{law, dem::Plane<3>{}}},
                 Leapfrog{}};
  EXPECT_TRUE(sim.run({.until = 0.3, .time_step = 5e-5}, rain));
  EXPECT_EQ(rain.number(), 100u);
}

using EnergyWatchFiles = FileTest;
TEST_F(EnergyWatchFiles, AcceptsStepsAfterARestart) {
  auto bed = bed_at_rest<3, double>();
  const double time_step = bed.time_step();
  for (int k = 0; k < 100; ++k) bed.step(time_step);
  write_checkpoint(path, bed);
  auto resumed = bed_at_rest<3, double>();
  read_checkpoint(path, resumed);
  expect_accepted(resumed, time_step, 100);
  expect_accepted(resumed, time_step / 100, 10);
  for (auto& v : resumed.particles()[velocity]) v.setZero();
  for (auto& w : resumed.particles()[spin]) w.setZero();
  expect_accepted(resumed, time_step, 100);
}

}  // namespace
}  // namespace silt::test::energy_watch_test
