// SPDX-License-Identifier: MIT
// The stable and the default time step of every law: the limit, and the grain that determines it.
#include <silt/core/simulation.hpp>
#include <silt/dem/contact/contacts.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/search/brute_force.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace silt::test::stability_test {
namespace {

constexpr double R = 0.01;
constexpr double k = 1e6;
const dem::Elastic glass{.young_modulus = 1e9, .poisson_ratio = 0.25};

// Spheres in a row with these overlaps.
dem::Grains<3> row(const std::vector<double>& overlaps) {
  dem::Grains<3> grains;
  Vec<3> x = Vec<3>::Zero();
  dem::add_grain(grains, x, {.radius = R, .density = 2500});
  for (const double overlap : overlaps) {
    x[0] += 2 * R - overlap;
    dem::add_grain(grains, x, {.radius = R, .density = 2500});
  }
  return grains;
}

// The smallest rejected time step, and the message.
struct Rejection {
  double limit = 0;
  std::string message;
};
template <class Law>
Rejection rejection_of(const Law& law, dem::Grains<3> grains, double reach = 2 * R) {
  BruteForce<3> search({.radius = reach});
  search.update(grains);
  Rejection rejection;
  double high = 1;
  rejection.limit = 1e-8;
  while (high / rejection.limit > 1 + 1e-4) {
    const double dt = std::sqrt(rejection.limit * high);
    auto contacts = for_particles(dem::Contacts{law}, grains);
    try {
      contacts.accelerate(grains, search, dt);
      rejection.limit = dt;
    } catch (const Error& error) {
      high = dt;
      rejection.message = error.what();
    }
  }
  return rejection;
}

// The limit is never too large, and at most 3 % too small.
void expect_limit(const Rejection& rejection, double exact, const char* law) {
  EXPECT_LE(rejection.limit, exact * (1 + 2e-4)) << law;
  EXPECT_GE(rejection.limit, exact * 0.97) << law;
  EXPECT_NE(rejection.message.find("particle 0"), std::string::npos)
      << law << ": " << rejection.message;
  EXPECT_NE(rejection.message.find("stable"), std::string::npos)
      << law << ": " << rejection.message;
}

double mass_of_one() { return row({})[mass][0]; }

TEST(Stability, LimitOfAPairIsTwoOverTheFrequencyOfItsLaw) {
  const double m = mass_of_one();
  const double overlap = 1e-4;
  const auto limit = [&](double stiffness) { return 2 / std::sqrt(2 * stiffness / m); };

  const dem::LinearSpringDashpot spring{.normal_stiffness = k};
  expect_limit(rejection_of(dem::Law{spring}, row({overlap})), limit(k), "linear");

  const dem::Law yields{dem::WaltonBraun{.loading_stiffness = k, .restitution = 0.5}};
  expect_limit(rejection_of(yields, row({overlap})), limit(4 * k), "Walton-Braun, unloading");

  // 1 + m R²/I = 7/2 for spheres, with the lever arm R minus half of the overlap.
  const dem::Law hertz{dem::Hertz{.elastic = glass},
                       dem::Mindlin{.elastic = glass, .friction_angle = 0.3}};
  const double a = std::sqrt(R / 2 * overlap);
  const double arm = 1 - overlap / 2 / R;
  const double shear = 8 * glass.contact_shear_modulus() * a * (1 + 2.5 * arm * arm);
  ASSERT_GT(shear, 2 * glass.contact_modulus() * a);
  expect_limit(rejection_of(hertz, row({overlap})), limit(shear), "Hertz-Mindlin");

  // The couple rotates both: ω² = 2 k_r/I, with I = 2/5 m R².
  const double mu = 2;
  const double k_r = 2.25 * k * squared(mu * R / 2);
  for (const auto& resistance :
       {dem::RollingResistance{.rolling_friction = mu, .damping_ratio = 0},
        dem::RollingResistance{.twisting_friction = mu, .damping_ratio = 0}}) {
    expect_limit(rejection_of(dem::Law{spring, resistance}, row({overlap})),
                 limit(k_r / (0.4 * R * R)), "rolling or twisting");
  }
}

TEST(Stability, ARollingDashpotCountsSeparately) {
  const double mu = 2;
  const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = k},
                     dem::RollingResistance{.rolling_friction = mu, .damping_ratio = 0.3}};
  const double m = mass_of_one();
  const double k_r = 2.25 * k * squared(mu * R / 2);
  const double c_r = 2 * 0.3 * std::sqrt(k_r * 1.4 * m / 2) * R / 2;
  const double inertia = 0.4 * m * R * R / 2;  // reduced, of the pair
  const double exact =
      dem::stable_time_step({.angular_frequency = std::sqrt(k_r / inertia), .beta = c_r / k_r});
  expect_limit(rejection_of(law, row({1e-4})), exact, "rolling with a dashpot");
}

TEST(Stability, ASlightHertzContactDoesNotLowerTheLimit) {
  const dem::Law law{dem::Hertz{.elastic = glass, .restitution = 0.3}};
  // c/k of the slight contact is thirty times that of the other, but its c is a thirtieth.
  const double alone = rejection_of(law, row({1e-4})).limit;
  const double beside = rejection_of(law, row({1e-4, 1e-10})).limit;
  EXPECT_GT(beside, 0.9 * alone);
}

TEST(Stability, LimitOfALargeGrainHardlyDependsOnTheNumberOfSmallOnesAroundIt) {
  // Small grains in a spiral around a large one, which do not touch each other.
  constexpr int number = 150;
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0}, {.radius = 10 * R, .density = 2500});
  for (int n = 0; n < number; ++n) {
    const double z = 1 - (2 * n + 1.0) / number;
    const double angle = n * std::numbers::pi * (3 - std::sqrt(5.0));
    const double across = std::sqrt(1 - z * z);
    const Vec<3> outwards{across * std::cos(angle), across * std::sin(angle), z};
    dem::add_grain(grains, Vec<3>((11 * R - 1e-5) * outwards), {.radius = R, .density = 2500});
  }
  const dem::Law spring{dem::LinearSpringDashpot{.normal_stiffness = k}};
  const double m = mass_of_one();
  const double limit = rejection_of(spring, grains, 20 * R).limit;
  // A shift of the large grain, with the small ones on both sides: ω² = k/m + n/3 k/M.
  const double exact = 2 / std::sqrt(k / m * (1 + number / 3.0 / 1000));
  EXPECT_LE(limit, exact);
  EXPECT_GE(limit, 0.75 * exact);
}

TEST(Stability, MessageNamesTheLimitingGrain) {
  const auto rejection =
      rejection_of(dem::Law{dem::Hertz{.elastic = glass}}, row({1e-6, 1e-6, 1e-4}));
  EXPECT_NE(rejection.message.find("particle 2"), std::string::npos) << rejection.message;
}

TEST(Stability, DefaultTimeStepOfHertzIsThatOfAnOverlapOfOnePercentOfTheRadius) {
  const dem::Hertz hertz{.elastic = {.young_modulus = 4.8e10, .poisson_ratio = 0.2}};
  const auto grains = row({0});
  const auto contacts = for_particles(dem::Contacts{dem::Law{hertz}}, grains);
  const double m = mass_of_one() / 2;
  const double S = 2 * hertz.elastic.contact_modulus() * std::sqrt(R / 2 * R / 100);
  const double dt = contacts.time_step(grains);
  EXPECT_NEAR(dt * 50 / (std::numbers::pi * std::sqrt(m / S)), 1, 1e-12);
  // An impact at 10 m/s, with this maximum overlap, has more than fifty steps.
  const double deepest = R / 100;
  const double v = std::sqrt(16.0 / 15 * hertz.elastic.contact_modulus() * std::sqrt(R / 2) / m) *
                   std::pow(deepest, 1.25);
  EXPECT_GT(2.9433 * deepest / v / dt, 60);
}

TEST(Stability, TheDefaultTimeStepIsShortenedWhereItIsNotStable) {
  const dem::Law law{dem::Hertz{.elastic = glass, .restitution = 0.3}};
  // The default time step is that of an overlap of a hundredth of the radius.
  Simulation squeezed{row({0.49 * R, 0.49 * R}), BruteForce<3>{},
                      dem::Contacts{law}.with({.steps_per_contact = 3}), Leapfrog{}};
  const double chosen = squeezed.time_step();
  std::optional<double> stable;
  try {
    squeezed.step(chosen);
  } catch (const Error& error) {
    stable = error.stable_time_step();
  }
  ASSERT_TRUE(stable.has_value());
  squeezed.step();
  EXPECT_LE(squeezed.last_time_step(), *stable);
  EXPECT_GT(squeezed.last_time_step(), *stable / 2);
  squeezed.run({.until = 50.5 * chosen, .end_exactly = true});
  EXPECT_EQ(squeezed.time(), 50.5 * chosen);
  EXPECT_EQ(squeezed.interaction().size(), 0u);
  squeezed.step();
  EXPECT_EQ(squeezed.last_time_step(), chosen);
}

}  // namespace
}  // namespace silt::test::stability_test
