// SPDX-License-Identifier: MIT
// Stability: rejected time steps, and that instability begins at the limit.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

namespace silt::test::time_step_test {
namespace {

constexpr double k = 1e6;
const dem::CundallStrack spring{.normal_stiffness = k};

double mass_of(const dem::Grain& grain) {
  return one_grain<3>({0, 0, 0}, {0, 0, 0}, grain)[mass][0];
}

// The smallest rejected time step.
template <class Make>
double limit_of(Make make) {
  double low = 1e-7;
  double high = 1;
  while (high / low > 1 + 1e-6) {
    const double dt = std::sqrt(low * high);
    auto sim = make();
    try {
      sim.step(dt);
      low = dt;
    } catch (const Error&) {
      high = dt;
    }
  }
  return low;
}

// A chain, triangle or tetrahedron of slightly overlapping spheres.
auto cluster(const std::vector<Vec<3>>& points, const dem::CundallStrack& law, bool refuse) {
  std::vector<Vec<3>> scaled;
  for (const auto& x : points) scaled.push_back(0.01999 * x);
  return Simulation{dem::make_grains(scaled, pebble), UniformGrid<3>{},
                    dem::Contacts{law}.with({.check_stability = refuse}), Leapfrog{}};
}

const std::vector<Vec<3>> pair_of{{0, 0, 0}, {1, 0, 0}};
const std::vector<Vec<3>> triangle{{0, 0, 0}, {1, 0, 0}, {0.5, std::sqrt(0.75), 0}};

TEST(TimeStep, OfAPairIsStableUpToTwoOverItsFrequency) {
  const double limit = limit_of([] { return cluster(pair_of, spring, true); });
  // At most 6 % of ω² too small, never too large.
  const double exact = std::sqrt(2 * mass_of(pebble) / k);
  EXPECT_LE(limit, exact * (1 + 1e-6));
  EXPECT_GE(limit, exact * 0.97);
}

// Overlap amplitude after many steps over the initial one; the law may be attractive, so that it
// stays linear.
struct Attached {
  double stiffness;
  template <class C>
  typename C::Vec force(const C& contact) const {
    return
        typename C::Real(stiffness) * (contact.overlap - typename C::Real(0.005)) * contact.normal;
  }
};

double growth(double dt_over_limit, const std::vector<Vec<3>>& points, double limit) {
  std::vector<Vec<3>> at;
  for (const auto& x : points) at.push_back(0.015 * x);
  auto grains = dem::make_grains(at, pebble);
  const auto kicks = random_points(at.size(), cube<3, double>(-1e-7, 1e-7), 1);
  for (Index i = 0; i < at.size(); ++i) grains[position][i] += kicks[i];
  Simulation sim{grains, UniformGrid<3>{}, dem::Contacts{Attached{k}}.with(without_limits),
                 Leapfrog{}};
  double most = 0;
  for (int step = 0; step < 300; ++step) {
    sim.step(dt_over_limit * limit);
    for (Index i = 0; i < at.size(); ++i) {
      most = std::max(most, (sim.particles()[position][i] - at[i]).norm());
    }
    if (most > 1e-3) break;
  }
  return most / 1e-7;
}

TEST(TimeStep, OscillationsAreBoundedBelowTheLimitAndGrowAboveIt) {
  const double of_pair = std::sqrt(2 * mass_of(pebble) / k);
  EXPECT_LT(growth(0.98, pair_of, of_pair), 50);
  EXPECT_GT(growth(1.02, pair_of, of_pair), 1e4);
  // Breathing mode of a triangle with all three contacts, ω² = 3 k/m.
  const double of_triangle = 2 / std::sqrt(3 * k / mass_of(pebble));
  EXPECT_LT(growth(0.98, triangle, of_triangle), 50);
  EXPECT_GT(growth(1.02, triangle, of_triangle), 1e4);
}

TEST(TimeStep, AcceptedForATriangleIsStable) {
  const double limit = limit_of([] { return cluster(triangle, spring, true); });
  const double exact = 2 / std::sqrt(3 * k / mass_of(pebble));
  EXPECT_LE(limit, exact * (1 + 1e-6));
  EXPECT_GE(limit, exact * 0.9);
}

TEST(TimeStep, OfThePaperIsSafeOnAFloorButRejectedForAPair) {
  const double dt =
      0.8 * dem::sah_choi_critical_time_step({.mass = mass_of(pebble), .stiffness = k});
  EXPECT_TRUE(refuses([&] { cluster(pair_of, spring, true).step(dt); },
                      {"time_step = " + to_text(dt), "stable", "lower it", "particle 0", "id 0"}));
  auto grains = one_grain<3>({0, 0, 0.00999}, {0, 0, 0});
  Simulation on_floor{grains, UniformGrid<3>{}, dem::Contacts{spring, dem::Plane<3>{}}, Leapfrog{}};
  EXPECT_NO_THROW(on_floor.step(dt));
  auto trusted = cluster(pair_of, spring, false);
  EXPECT_NO_THROW(trusted.step(dt)) << "the check can be switched off";
}

TEST(TimeStep, OnAWallIsStableUpToTheCriticalOneOfThePaper) {
  const double limit = limit_of([] {
    return Simulation{one_grain<2>({0, 0.00999}, {0, 0}), UniformGrid<2>{},
                      dem::Contacts{spring, dem::Plane<2>{}}, Leapfrog{}};
  });
  const double m = one_grain<2>({0, 0}, {0, 0})[mass][0];
  const double paper = dem::sah_choi_critical_time_step({.mass = m, .stiffness = k});
  EXPECT_LE(limit, paper * (1 + 1e-6));
  EXPECT_GE(limit, 0.97 * paper);
}

TEST(TimeStep, IsShorterWithATangentialSpringAndWithADashpot) {
  const auto limit = [](const dem::CundallStrack& law) {
    return limit_of([&] { return cluster(pair_of, law, true); });
  };
  const double plain = limit(spring);
  auto rough = spring;
  rough.tangential_stiffness = k;
  // 1 + m R²/I = 7/2 for spheres.
  EXPECT_NEAR(limit(rough) / plain, std::sqrt(2.0 / 7), 0.04);
  auto damped = spring;
  damped.restitution = 0.3;
  EXPECT_LT(limit(damped), 0.8 * plain);
}

TEST(TimeStep, OfTheIncrementalFormWithADashpotIsUnstableJustAboveTheLimit) {
  // Two spheres with an overlap so large that they do not separate during the test.
  const double zeta = 0.3;
  const double omega = std::sqrt(2 * k / mass_of(pebble));
  const double limit =
      dem::stable_time_step({.angular_frequency = omega, .beta = 2 * zeta / omega});
  EXPECT_NEAR(limit, 2 / omega * (std::sqrt(1.09) - 0.3), 1e-12);
  const auto deviation = [&](double dt) {
    dem::CundallStrackIncremental law{.normal_stiffness = k};
    law.beta = 2 * zeta / omega;
    std::vector<Vec<3>> at{{0, 0, 0}, {0.01, 0, 0}};
    auto grains = dem::make_grains(at, pebble);
    grains[velocity][1][0] = 1e-6;
    auto settings = without_limits;
    settings.check_stability = false;
    Simulation sim{grains, UniformGrid<3>{}, dem::Contacts{law}.with(settings), Leapfrog{}};
    double late = 0;
    for (int step = 0; step < 200; ++step) {
      sim.step(dt);
      if (step > 150) late = std::max(late, std::abs(sim.particles()[velocity][1][0]));
    }
    return late;
  };
  EXPECT_LT(deviation(0.97 * limit), 1e-6);
  EXPECT_GT(deviation(1.03 * limit), 1e-5);
}

TEST(TimeStep, DefaultIsAFractionOfTheShortestContactOfTheLightestGrains) {
  auto grains = two_grains<2>(0.1, Vec<2>(0, 0));
  dem::add_grain(grains, {0, 1}, {.radius = 0.005, .density = 2500});
  const double light = grains[mass][2];
  const double contact = dem::contact_duration({.mass = light / 2, .stiffness = k});
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{spring}, Leapfrog{}};
  EXPECT_NEAR(sim.time_step(), contact / 50, 1e-12);
  Simulation finer{grains, UniformGrid<2>{}, dem::Contacts{spring}.with({.steps_per_contact = 200}),
                   Leapfrog{}};
  EXPECT_NEAR(finer.time_step(), contact / 200, 1e-12);
}

}  // namespace
}  // namespace silt::test::time_step_test
