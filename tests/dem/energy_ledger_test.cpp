// SPDX-License-Identifier: MIT
#include <silt/dem/measure/energy_ledger.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/ledger.hpp"
#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <cmath>

namespace silt::test::energy_ledger_test {
namespace {

const dem::CundallStrack rough_spring{.normal_stiffness = 1e6,
                                      .tangential_stiffness = 5e5,
                                      .restitution = 0.9,
                                      .friction_angle = 0.4};

// A law without components().
struct Stubborn {
  double stiffness = 0;
  double dashpot = 0;

  template <class C>
  typename C::Vec force(const C& c) const {
    using Real = typename C::Real;
    return (Real(stiffness) * c.overlap + Real(dashpot) * c.approach_speed()) * c.normal;
  }
};

// One type of simulation for many tests, as each takes seconds to compile: gravity, a floor and
// global damping, any of which may be zero.
struct Setting {
  Vec<2> gravity = Vec<2>::Zero();
  double damping = 0;
  double floor = -1e3;
};
template <class Law>
auto simulation(const dem::Grains<2>& grains, const Law& law, const Setting& setting) {
  const dem::Plane<2> floor{.point = {0, setting.floor}};
  return Simulation{grains, UniformGrid<2>{},
                    Forces{Gravity<2>{setting.gravity}, dem::Contacts{law, floor}},
                    Leapfrog{GlobalDamping{.alpha = setting.damping}}};
}
auto heap(const Box<2>& box = {}) {
  auto grains = crowd<2, double>(8, 3);
  grains.set_box(box);
  return grains;
}
const Setting rough{.gravity = {3, -9.81}, .damping = 2, .floor = 0};

TEST(EnergyLedger, ClosesInEveryStepWithGravityAndDampingAtAFloor) {
  auto sim = simulation(heap(), rough_spring, rough);
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 1000, 2e-5);
  const auto& works = ledger.work();
  EXPECT_LT(works.normal_dashpot, 0);
  EXPECT_LT(works.tangential_dashpot, 0);
  EXPECT_LT(works.damping, 0);
  EXPECT_EQ(works.walls, 0) << "the floor is at rest";
  EXPECT_EQ(works.other, 0);
  EXPECT_EQ(works.removed_grains, 0);
  EXPECT_GT(ledger.losses().friction, 0);
}

TEST(EnergyLedger, ClosesAcrossPeriodicSidesAndWhenTheStepChanges) {
  auto box = cube<2, double>(0, 8 * 0.0205);
  box.periodic[0] = true;
  box.lower[1] = -1;
  box.upper[1] = 1;
  auto sim = simulation(heap(box), rough_spring, {.gravity = {3, -9.81}});
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 200, 2e-5);
  expect_closing(sim, ledger, 200, 1e-5);
  EXPECT_EQ(ledger.added_energy(), 0);
}

TEST(EnergyLedger, ClosesWhenAGrainIsRemovedDuringAContact) {
  auto grains = two_grains<2>(-1e-4, Vec<2>(3, 0));
  Box<2> box{.lower = {-1, -1}, .upper = {0.02, 1}, .on_escape = OnEscape::remove};
  grains.set_box(box);
  grains[velocity][0] = {2.9, 0.1};
  auto sim = simulation(grains, rough_spring, {});
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 100, 1e-6);
  EXPECT_EQ(sim.particles_lost(), 1u);
  EXPECT_NEAR(ledger.added_energy(), -grains[mass][0] * 9 / 2, 0.2) << "its energy was removed";
  EXPECT_NE(ledger.work().removed_grains, 0);
}

TEST(EnergyLedger, AccountsForManualChanges) {
  auto sim = simulation(heap(), rough_spring, rough);
  dem::EnergyLedger ledger{sim};
  const auto push = [&](auto& simulation) {
    dem::add_grain(simulation.particles(), {0.5, 0.5 + 0.1 * double(simulation.steps())}, pebble);
    simulation.particles()[velocity].back() = {0, 2};
  };
  for (int k = 0; k < 20; ++k) {
    push(sim);
    ledger.before_step(sim);
    sim.step(2e-5);
    ledger.after_step(sim);
    if (k > 0) {
      expect_closed(ledger, k);
    }
  }
  const double each = sim.particles()[mass][0] * 4 / 2;
  EXPECT_NEAR(ledger.added_energy(), 18 * each, 1e-12 * each)
      << "two were added before the balance began";
}

TEST(EnergyLedger, ClosesForALawWithoutComponents) {
  auto sim = simulation(heap(), Stubborn{.stiffness = 1e6, .dashpot = 20}, rough);
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 300, 2e-5);
  EXPECT_NE(ledger.work().contact, 0);
  EXPECT_EQ(ledger.work().normal_spring, 0);
  EXPECT_TRUE(std::isnan(ledger.integration_error()));
}

TEST(EnergyLedger, HasTheEnergyLostInABounce) {
  const double e = 0.6;
  const dem::CundallStrack law{.normal_stiffness = 1e6, .restitution = e};
  const double m = one_grain<2>({0, 0}, {0, 0})[mass][0];
  auto sim = simulation(one_grain<2>({0, 0.0101}, {0, -1}), law, {.floor = 0});
  dem::EnergyLedger ledger{sim};
  for (int step = 0; step < 8000; ++step) {
    sim.step(1e-6);
    ledger.after_step(sim);
  }
  EXPECT_EQ(sim.interaction().part<1>().size(), 0u) << "the contact has ended";
  EXPECT_NEAR(ledger.time(), sim.time() - 1e-6, 1e-12) << "that of the state before the last step";
  EXPECT_NEAR(ledger.initial_energies().sum(), m / 2, 1e-12);
  EXPECT_NEAR(-ledger.work().normal_dashpot, m / 2 * (1 - e * e), 1e-3 * m);
  EXPECT_NEAR(ledger.work().normal_spring, 0, 1e-5 * m);
  EXPECT_NEAR(ledger.energies().sum(), m / 2 * e * e, 1e-3 * m);
}

TEST(EnergyLedger, HasTheEnergyLostInSliding) {
  // A disc sliding on a floor ends with 2/3 of its speed and therefore 2/3 of its energy.
  auto grain = one_grain<2>({0, 0}, {0.1, 0});
  const double m = grain[mass][0];
  grain[position][0][1] = 0.01 - m * 10 / 1e6;
  auto sim = simulation(grain, rough_spring, {.gravity = {0, -10}, .floor = 0});
  dem::EnergyLedger ledger{sim};
  for (int step = 0; step < 15000; ++step) {
    sim.step(2e-5);
    ledger.after_step(sim);
  }
  const double first = m * 0.01 / 2;
  // The balance begins after the first step, in which the dashpot acts already.
  const auto& initial = ledger.initial_energies();
  const double noted = initial.kinetic + initial.rotational + initial.elastic.tangential;
  EXPECT_NEAR(noted, first, 2e-3 * first);
  const double lost = ledger.losses().friction - ledger.work().tangential_dashpot;
  EXPECT_NEAR(lost, noted - first * 2 / 3, 1e-3 * first);
  EXPECT_LT(-ledger.work().tangential_dashpot, 0.1 * lost);
  EXPECT_NEAR(ledger.energies().rotational / ledger.energies().kinetic, 0.5, 1e-3);
  EXPECT_NEAR(ledger.integration_error(), 0, 1e-4 * first);
}

// For impacts that begin, and begin to slide, at different times within a step.
double rms_integration_error(double dt) {
  double sum = 0;
  constexpr int phases = 24;
  for (int phase = 0; phase < phases; ++phase) {
    const double gap = 1e-4 + 1.5 * dt * phase / phases;
    const double along = 0.3 + 0.013 * (phase * 5 % phases);
    auto sim = simulation(two_grains<2>(gap, Vec<2>(-1.5, along)), rough_spring, {});
    dem::EnergyLedger ledger{sim};
    while (sim.time() < 0.006) {
      sim.step(dt);
      ledger.after_step(sim);
    }
    sum += squared(ledger.integration_error());
  }
  return std::sqrt(sum / phases);
}

TEST(EnergyLedger, HasAnIntegrationErrorOfSecondOrder) {
  const double coarse = rms_integration_error(4e-5);
  const double fine = rms_integration_error(5e-6);
  EXPECT_NEAR(std::log(coarse / fine) / std::log(8), 2, 0.15);
}

struct Wind {
  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    for (auto& f : particles[force]) f += Vec<2>(0.3, 0);
  }
};

TEST(EnergyLedger, SumsUnknownForcesInOneTerm) {
  Simulation sim{one_grain<2>({0, 0}, {1, 0}), UniformGrid<2>{},
                 Forces{Gravity<2>{{0, -1}}, Wind{}}, Leapfrog{}};
  dem::EnergyLedger ledger{sim};
  expect_closing(sim, ledger, 20, 0.01);
  // 0.3 N during 0.18 s, from 0.01 s on.
  const double a = 0.3 / sim.particles()[mass][0];
  EXPECT_NEAR(ledger.work().other, 0.3 * (0.18 + a * (squared(0.19) - squared(0.01)) / 2), 1e-6);
}

#if SILT_SLOW_TESTS
TEST(EnergyLedger, ClosesInFloatToItsRoundOff) {
  Simulation sim{crowd<2, float>(6, 3), BruteForce<2, float>{}, dem::Contacts{rough_spring},
                 Leapfrog{}};
  dem::EnergyLedger ledger{sim};
  sim.step(2e-5);
  ledger.after_step(sim);
  for (int k = 1; k < 300; ++k) {
    sim.step(2e-5);
    ledger.after_step(sim);
    ASSERT_LT(std::abs(ledger.imbalance()), 1e-6 * ledger.energies().kinetic) << k;
  }
  EXPECT_GT(ledger.losses().friction, 0.01 * ledger.energies().kinetic);
}
#endif

TEST(EnergyLedger, ThrowsForGrainsAddedWithoutBeforeStep) {
  auto sim = simulation(heap(), rough_spring, {});
  dem::EnergyLedger ledger{sim};
  dem::add_grain(sim.particles(), {1, 1}, pebble);
  sim.step(1e-5);
  EXPECT_TRUE(refuses([&] { ledger.after_step(sim); }, {"EnergyLedger", "before_step", "id 64"}));
}

TEST(EnergyLedger, ThrowsForAMissedStep) {
  auto sim = simulation(heap(), rough_spring, {});
  dem::EnergyLedger ledger{sim};
  sim.step(1e-5);
  sim.step(1e-5);
  EXPECT_TRUE(refuses([&] { ledger.after_step(sim); }, {"EnergyLedger", "step 0", "step 2"}));
}

using EnergyLedgerInACheckpoint = FileTest;

TEST_F(EnergyLedgerInACheckpoint, GoesOnWithTheNextStep) {
  const auto make = [] { return simulation(heap(), rough_spring, rough); };
  const auto step = [](auto& sim, auto& ledger) {
    sim.step(1e-5);
    ledger.after_step(sim);
  };
  auto sim = make();
  dem::EnergyLedger ledger{sim};
  for (int k = 0; k < 5; ++k) step(sim, ledger);
  write_checkpoint(path, sim, ledger);
  auto resumed = make();
  dem::EnergyLedger of_resumed{resumed};
  read_checkpoint(path, resumed, of_resumed);
  step(sim, ledger);
  step(resumed, of_resumed);
  EXPECT_EQ(of_resumed.time(), ledger.time());
  EXPECT_EQ(of_resumed.energies().sum(), ledger.energies().sum());
  EXPECT_EQ(of_resumed.work().sum(), ledger.work().sum());
}

}  // namespace
}  // namespace silt::test::energy_ledger_test
