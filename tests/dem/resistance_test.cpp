// SPDX-License-Identifier: MIT
// Resistance to sliding, rolling and twisting: forces, and the balance of stored, returned and lost
// energy.
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::resistance_test {
namespace {

constexpr double pi = std::numbers::pi;

template <int Dim>
dem::Contact<Dim, double> pressed(double overlap) {
  dem::Contact<Dim, double> contact;
  contact.normal = Vec<Dim>::Unit(Dim - 1);
  contact.overlap = overlap;
  contact.effective_mass = 0.01;
  contact.effective_radius = 0.01;
  contact.time_step = 1e-6;
  return contact;
}

// --- Mindlin -------------------------------------------------------------------------------------

const dem::Elastic glass{.young_modulus = 1e9, .poisson_ratio = 0.25};
const dem::Law hertz_mindlin{dem::Hertz{.elastic = glass},
                             dem::Mindlin{.elastic = glass, .friction_angle = 0.4}};
using HertzMindlin = std::remove_const_t<decltype(hertz_mindlin)>;

double mindlin_stiffness(double overlap) {
  return 8 * glass.contact_shear_modulus() * std::sqrt(0.01 * overlap);
}

TEST(Mindlin, HasTheStiffnessOfTheContactArea) {
  HertzMindlin::History<3, double> history;
  auto contact = pressed<3>(1e-5);
  contact.relative_velocity = {1e-3, 0, 0};
  for (int step = 0; step < 10; ++step) hertz_mindlin.components(contact, history);
  const double F = mindlin_stiffness(1e-5) * 1e-8;
  EXPECT_NEAR(history.tangential.force[0] / -F, 1, 1e-12);

  contact.relative_velocity.setZero();
  contact.overlap = 4e-5;
  hertz_mindlin.components(contact, history);
  EXPECT_NEAR(history.tangential.force[0] / -F, 1, 1e-12) << "a growing area keeps the force";
  contact.overlap = 1e-5;
  hertz_mindlin.components(contact, history);
  EXPECT_NEAR(history.tangential.force[0] / -F, 0.5, 1e-12)
      << "a shrinking area keeps the deflection";
}

TEST(Mindlin, SlidesAtTheFrictionAngle) {
  HertzMindlin::History<2, double> history;
  auto contact = pressed<2>(1e-5);
  contact.relative_velocity = {-1, 0};
  for (int step = 0; step < 100; ++step) hertz_mindlin.components(contact, history);
  const auto forces = hertz_mindlin.components(contact, history);
  EXPECT_NEAR(forces.tangential_spring[0] / forces.normal_spring, std::tan(0.4), 1e-12);
  EXPECT_EQ(forces.tangential_dashpot, Vec<2>(0, 0));
  EXPECT_NEAR(forces.friction / (forces.tangential_spring[0] * 1e-6), 1, 1e-9);
}

// Repeatedly load, shear, unload and shear back: this would gain energy if the force were kept.
TEST(Mindlin, ClosedPathsOfLoadAndShearGenerateNoEnergy) {
  for (const double direction : {1.0, -1.0}) {
    HertzMindlin::History<2, double> history;
    auto contact = pressed<2>(0);
    double work = 0, before = 0;
    const int round = 4000;
    for (int step = 0; step < 3 * round; ++step) {
      const double phase = 2 * pi * (step % round) / round;
      contact.overlap = 1e-5 * (1.2 + direction * std::sin(phase));
      contact.relative_velocity = {1e-1 * std::sin(phase) / round, 0};
      const double F = hertz_mindlin.components(contact, history).tangential_spring[0];
      work += (F + before) / 2 * contact.relative_velocity[0] * contact.time_step;
      before = F;
    }
    EXPECT_LT(work, 0) << direction;
  }
}

// --- rolling and twisting, single component
// -------------------------------------------------------

const dem::RollingResistance rolling{.rolling_friction = 0.2, .twisting_friction = 0.1};
const dem::Law rough{dem::LinearSpringDashpot{.normal_stiffness = 1e5}, rolling};
using Rough = std::remove_const_t<decltype(rough)>;

TEST(RollingResistance, ActsAsSpringAndDashpotUpToItsLimit) {
  const double k = 2.25 * 1e5 * squared(0.2 * 0.01);
  const double limit = 0.2 * 0.01 * 1e5 * 1e-4;
  Rough::History<2, double> history;
  auto contact = pressed<2>(1e-4);
  contact.relative_spin = 10;
  auto forces = rough.components(contact, history);
  EXPECT_NEAR(forces.rolling_spring / (-k * 10 * 1e-6), 1, 1e-12);
  EXPECT_NEAR(forces.rolling_dashpot / (-10 * 2 * 0.3 * std::sqrt(k * 1.4 * 0.01) * 0.01), 1,
              1e-12);
  for (int step = 0; step < 100000; ++step) forces = rough.components(contact, history);
  EXPECT_NEAR(forces.rolling_spring / -limit, 1, 1e-12);
  EXPECT_EQ(forces.rolling_dashpot, 0);
  EXPECT_NEAR(forces.rolling_friction / (limit * 10 * 1e-6), 1, 1e-9);
}

TEST(RollingResistance, ResistsTwistingWithItsCoefficientAndRotatesWithTheContact) {
  Rough::History<3, double> history;
  auto contact = pressed<3>(1e-4);
  contact.relative_spin = {1, 0, 2};
  auto forces = rough.components(contact, history);
  EXPECT_NEAR(forces.rolling_spring[2] / forces.rolling_spring[0], 2 * squared(0.1 / 0.2), 1e-12);
  const double rolls = -forces.rolling_spring[0];
  const double twists = -forces.rolling_spring[2];
  // A rigid rotation about y by a quarter turn.
  contact.relative_spin.setZero();
  for (int step = 1; step <= 100; ++step) {
    const double angle = pi / 2 * step / 100;
    contact.normal = {std::sin(angle), 0, std::cos(angle)};
    forces = rough.components(contact, history);
  }
  EXPECT_NEAR(forces.rolling_spring[0] / -twists, 1, 1e-9);
  EXPECT_NEAR(forces.rolling_spring[2] / rolls, 1, 1e-9);
}

// --- energy stored, returned and lost ------------------------------------------------------------

struct Balance {
  double normal = 0, tangential = 0, rolling = 0;  // largest residuals [J]
  double stored = 0;                               // maximum [J]
  double lost = 0;                                 // by yielding and sliding [J]
};

template <int Dim>
double times(const AngularVec<Dim>& couple, const AngularVec<Dim>& spin) {
  if constexpr (Dim == 2) {
    return couple * spin;
  } else {
    return couple.dot(spin);
  }
}

// A contact along a smooth path until it ends. For each spring, the stored plus the lost energy
// must be the work done on it; the residual is the integration error.
template <int Dim, class Law>
Balance balance_along(const Law& law, int steps) {
  constexpr bool rolls = dem::GivesCouple<Law, Dim, double>;
  const double duration = 1e-2;
  // Two loadings of different depth in one contact, with oscillating shear and spin.
  const auto overlap = [&](double t) {
    return 2e-4 * std::sin(pi * t / duration) * (1.2 + std::sin(5 * pi * t / duration));
  };
  auto contact = pressed<Dim>(0);
  const double dt = contact.time_step = duration / steps;
  typename Law::template History<Dim, double> history{};
  decltype(law.components(contact, history)) before;
  Balance balance, residual;
  for (int step = 1; step < steps; ++step) {
    const double t = step * dt;
    contact.overlap = overlap(t);
    const double closing = overlap(t) - overlap(t - dt);
    const Vec<Dim> slip = Vec<Dim>::Unit(0) * 0.1 * std::sin(700 * (t - dt / 2)) * dt;
    contact.relative_velocity = (slip - closing * contact.normal) / dt;
    if constexpr (Dim == 2) {
      contact.relative_spin = 60 * std::sin(900 * (t - dt / 2));
    } else {
      contact.relative_spin = {60 * std::sin(900 * (t - dt / 2)), 10, 50 * std::cos(500 * t)};
    }
    const auto forces = law.components(contact, history);
    const auto stored = law.elastic_energies(contact, history);
    residual.normal += forces.plastic - (forces.normal_spring + before.normal_spring) / 2 * closing;
    residual.tangential +=
        forces.friction + (forces.tangential_spring + before.tangential_spring).dot(slip) / 2;
    balance.lost += forces.plastic + forces.friction;
    if constexpr (rolls) {
      residual.rolling +=
          forces.rolling_friction +
          times<Dim>((forces.rolling_spring + before.rolling_spring) / 2, contact.relative_spin) *
              dt;
      balance.lost += forces.rolling_friction;
      balance.rolling = std::max(balance.rolling, std::abs(residual.rolling + stored.rolling));
    }
    balance.normal = std::max(balance.normal, std::abs(residual.normal + stored.normal));
    balance.tangential =
        std::max(balance.tangential, std::abs(residual.tangential + stored.tangential));
    balance.stored = std::max(balance.stored, stored.sum());
    before = forces;
  }
  return balance;
}

template <int Dim, class Law>
void expect_the_balance_closes(const Law& law, const char* name) {
  const Balance coarse = balance_along<Dim>(law, 1000);
  const Balance fine = balance_along<Dim>(law, 8000);
  EXPECT_GT(fine.lost, 0.01 * fine.stored) << name << " also yields or slides";
  const auto closes = [&](double of_coarse, double of_fine, const char* what) {
    EXPECT_LT(of_coarse, 0.01 * coarse.stored) << name << ' ' << what;
    // Second order: 64 times smaller; a little more where sliding begins within a step.
    EXPECT_LT(of_fine, of_coarse / 30 + 1e-12 * fine.stored) << name << ' ' << what;
  };
  closes(coarse.normal, fine.normal, "normal");
  closes(coarse.tangential, fine.tangential, "tangential");
  closes(coarse.rolling, fine.rolling, "rolling");
}

TEST(Law, BalancesTheEnergyOfItsSprings) {
  const dem::LinearSpringDashpot spring{.normal_stiffness = 1e5, .restitution = 0.7};
  const dem::LinearFriction friction{.tangential_stiffness = 8e4, .friction_angle = 0.3};
  expect_the_balance_closes<2>(dem::Law{spring, friction, rolling}, "linear");
  expect_the_balance_closes<3>(
      dem::Law{dem::WaltonBraun{.loading_stiffness = 1e5, .restitution = 0.7}, friction, rolling},
      "Walton-Braun");
  expect_the_balance_closes<3>(dem::Law{dem::Hertz{.elastic = glass}, rolling,
                                        dem::Mindlin{.elastic = glass, .friction_angle = 0.3}},
                               "Hertz-Mindlin");
  expect_the_balance_closes<2>(dem::CundallStrack{.normal_stiffness = 1e5,
                                                  .tangential_stiffness = 8e4,
                                                  .restitution = 0.7,
                                                  .friction_angle = 0.3},
                               "Cundall-Strack");
}

}  // namespace
}  // namespace silt::test::resistance_test
