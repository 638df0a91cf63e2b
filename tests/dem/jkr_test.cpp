// SPDX-License-Identifier: MIT
// JKR: the exact curve of force and overlap, and contacts of simulations that last beyond zero
// overlap, at walls and between grains. No other law has contacts in a gap.
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/jkr.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/mindlin.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::jkr_test {
namespace {

constexpr double pi = std::numbers::pi;
constexpr dem::Elastic rubber{.young_modulus = 1e7, .poisson_ratio = 0.4};
const dem::Jkr sticky{.elastic = rubber, .surface_energy = 0.05};
const double E = rubber.contact_modulus(), w = 0.1;

static_assert(dem::LawInLanes<dem::Law<dem::Jkr, dem::Mindlin>, 3, double>);

// δ and F of the contact radius a.
double overlap_at(double a, double R) { return a * a / R - std::sqrt(2 * pi * w * a / E); }
double force_at(double a, double R) {
  return 4 * E * a * a * a / (3 * R) - std::sqrt(8 * pi * w * E * a * a * a);
}
double pull_off(double R) { return 1.5 * pi * w * R; }
double least_radius(double R) { return std::cbrt(pi * w * R * R / (8 * E)); }

TEST(Jkr, HasTheExactForceAtEveryOverlap) {
  for (const double R : {1e-6, 1e-4, 1e-2}) {
    dem::Contact<3, double> contact;
    contact.normal = Vec<3>::Unit(0);
    contact.effective_radius = R;
    contact.effective_mass = 1;
    contact.time_step = 1e-9;
    const dem::Law law{sticky};
    for (const double ratio : {1.0001, 1.01, 1.2, std::cbrt(4.0), 1.8, 2.5, 4.0, 10.0, 100.0}) {
      const double a = ratio * least_radius(R);
      contact.overlap = overlap_at(a, R);
      contact.relative_velocity = {-1e-15, 0, 0};
      decltype(law)::History<3, double> history;
      history.normal.steps.number = 2;
      const auto all = law.components(contact, history);
      const double force = all.force(contact.normal)[0];
      EXPECT_NEAR(force, force_at(a, R), 1e-8 * pull_off(R) + 1e-10 * std::abs(force))
          << R << " " << ratio;
      EXPECT_NEAR(all.normal_spring, force + 2 * pull_off(R), 1e-7 * all.normal_spring);
    }
    EXPECT_NEAR(sticky.max_gap(R) / -overlap_at(least_radius(R), R), 1, 1e-12);
    EXPECT_NEAR(force_at(least_radius(R), R) / pull_off(R), -5.0 / 9, 1e-12);
  }
}

// A heavy grain moves away from a plane, or from another heavy grain, at constant speed.
struct Separation {
  double gap = 0;      // of the last contact [m]
  double tension = 0;  // the largest one [N]
  double last = 0;     // [N]
  double work = 0;     // of the contact, from zero overlap on [J]
  double energy = 0;   // in the last contact [J]
};
Separation separate(bool at_wall, double R) {
  auto grains = one_grain<3>({0, 0, R * 0.999}, {0, 0, 0}, {.radius = R, .density = 1e15});
  if (!at_wall) dem::add_grain(grains, {0, 0, -R}, {.radius = R, .density = 1e15});
  const double speed = 1e-3;
  grains[velocity][0] = {0, 0, speed};
  const dem::Plane<3> plane{.point = {0, 0, at_wall ? 0.0 : -1.0}};
  Simulation simulation{grains, UniformGrid<3>{}, dem::Contacts{dem::Law{sticky}, plane},
                        Leapfrog{}};
  Separation result;
  const double R_eff = at_wall ? R : R / 2;
  const double dt = sticky.max_gap(R_eff) / speed / 2000;
  double before = 0;
  for (int step = 0; step < 100'000; ++step) {
    simulation.step(dt);
    const auto& contacts = simulation.interaction();
    if (contacts.size() == 0) break;
    contacts.for_each_contact(simulation.particles(),
                              [&](Index, Index, const auto& contact, const Vec<3>& force) {
                                result.gap = -contact.overlap;
                                result.last = force[2];
                                result.tension = std::min(result.tension, force[2]);
                                if (contact.overlap < 0)
                                  result.work += (before + force[2]) / 2 * speed * dt;
                                before = force[2];
                              });
    result.energy = contacts.elastic_energy(simulation.particles());
  }
  return result;
}

TEST(Jkr, LastsInSimulationsUntilTheNeckBreaks) {
  const double R = 1e-3;
  for (const bool at_wall : {true, false}) {
    const double R_eff = at_wall ? R : R / 2;
    const double gap = sticky.max_gap(R_eff);
    const auto found = separate(at_wall, R);
    EXPECT_NEAR(found.gap / gap, 1, 1e-3);
    EXPECT_NEAR(found.tension / -pull_off(R_eff), 1, 1e-5);
    EXPECT_NEAR(found.energy / -found.work, 1, 5e-3);
    // 0.3 E* a_0⁵/R² and what it takes to the end.
    const double a_0 = std::cbrt(2 * pi * w * R_eff * R_eff / E);
    const double a_c = least_radius(R_eff);
    const auto energy_at = [&](double a) {
      const double k = std::sqrt(2 * pi * w / E);
      return E * (8.0 / 15 * std::pow(a, 5) / squared(R_eff) -
                  4.0 / 3 * k * std::pow(a, 3.5) / R_eff + squared(k * a) / 2);
    };
    EXPECT_NEAR(found.energy / (energy_at(a_c) - energy_at(a_0)), 1, 5e-3);
  }
}

// A slow grain is caught, a fast one rebounds and loses what the neck takes.
TEST(Jkr, CatchesSlowGrains) {
  const auto rebound = [](double speed) {
    const double R = 1e-4;
    auto grains =
        one_grain<3>({0, 0, R * (1 + 1e-6)}, {0, 0, -speed}, {.radius = R, .density = 1000});
    Simulation simulation{grains, UniformGrid<3>{},
                          dem::Contacts{dem::Law{sticky}, dem::Plane<3>{}}, Leapfrog{}};
    bool has_touched = false;
    for (int step = 0; step < 20'000; ++step) {
      simulation.step(2e-8);
      has_touched |= simulation.interaction().size() > 0;
      if (has_touched && simulation.interaction().size() == 0) break;
    }
    const bool sticks = simulation.interaction().size() > 0;
    return sticks ? 0 : simulation.particles()[velocity][0][2];
  };
  const double R = 1e-4, m = 4.0 / 3 * pi * R * R * R * 1000;
  const dem::Law law{sticky};
  dem::Contact<3, double> contact;
  contact.effective_radius = R;
  contact.overlap = -sticky.max_gap(R);
  const double lost = law.elastic_energy(contact, decltype(law)::History<3, double>{});
  const double critical = std::sqrt(2 * lost / m);
  EXPECT_EQ(rebound(0.95 * critical), 0);
  for (const double ratio : {1.2, 2.0, 5.0}) {
    const double v = ratio * critical;
    EXPECT_NEAR(rebound(v) / std::sqrt(v * v - critical * critical), 1, 0.01) << ratio;
  }
}

// At the turning points of its oscillation a pair has no kinetic energy, and the energy of the
// contact is below that at zero overlap; no step is refused.
TEST(Jkr, OscillatesAboutItsEquilibrium) {
  const double R = 1e-3;
  const double a = std::cbrt(18 * pi * w * R * R / (4 * E) / 2);
  for (const double e : {1.0, 0.8}) {
    dem::Jkr law = sticky;
    law.restitution = e;
    for (const double share : {0.3, 0.7, 1.5, 3.0}) {
      auto grains = one_grain<3>({0, 0, R - share * overlap_at(a, R)}, {0, 0, 0},
                                 {.radius = R, .density = 1000});
      Simulation simulation{grains, UniformGrid<3>{}, dem::Contacts{dem::Law{law}, dem::Plane<3>{}},
                            Leapfrog{}};
      for (int step = 0; step < 2000; ++step) simulation.step();
      EXPECT_EQ(simulation.interaction().size(), 1u);
    }
  }
}

TEST(Jkr, RefusesWhatCannotBe) {
  EXPECT_TRUE(refuses([] { dem::Contacts{dem::Law{dem::Jkr{.elastic = rubber}}}; },
                      {"Jkr: surface_energy = 0"}));
  EXPECT_TRUE(refuses([] { dem::Contacts{dem::Law{dem::Jkr{.surface_energy = 1}}}; },
                      {"Jkr: young_modulus = 0"}));
}

}  // namespace
}  // namespace silt::test::jkr_test
