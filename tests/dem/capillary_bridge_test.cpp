// SPDX-License-Identifier: MIT
// Liquid bridges: their force, their rupture in a simulation, and a crowd of them in a box. No
// other adhesion component lasts in a gap.
#include <silt/dem/law/capillary_bridge.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/mindlin.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::capillary_bridge_test {
namespace {

constexpr double pi = std::numbers::pi;
const dem::Hertz hertz{.elastic = {.young_modulus = 1e8, .poisson_ratio = 0.3}, .restitution = 0.7};
const dem::CapillaryBridge water{.surface_tension = 0.072, .contact_angle = 0.3, .volume = 1e-12};
const dem::Law law{hertz, dem::Mindlin{.elastic = hertz.elastic, .friction_angle = 0.4}, water};
using Moist = decltype(law);

static_assert(
    dem::LawInLanes<dem::Law<dem::Hertz, dem::Mindlin, dem::NoComponent, dem::CapillaryBridge>, 3,
                    double>);

TEST(CapillaryBridge, PullsAsMeasuredForEqualSpheres) {
  const double R = 1e-3;
  dem::Contact<3, double> contact;
  contact.effective_radius = R / 2;
  contact.relative_velocity = {1e-15, 0, 0};
  contact.time_step = 1e-6;
  contact.normal = Vec<3>::Unit(0);
  const auto pull_at = [&](double gap) {
    contact.overlap = -gap;
    dem::StepsOfContact<double> steps{.number = 2};
    return -water.adhesion_force(contact, steps);
  };
  const double at_touch = 2 * pi * R * 0.072 * std::cos(0.3);
  EXPECT_NEAR(pull_at(0) / at_touch, 1, 1e-12);
  EXPECT_NEAR(pull_at(-1e-5) / at_touch, 1, 1e-12) << "while they touch";
  const double D = 5e-5, s = D * std::sqrt(R / 1e-12);
  EXPECT_NEAR(pull_at(D) / (at_touch / (1 + 1.05 * s + 2.5 * s * s)), 1, 1e-12);
  const double rupture = 1.15 * (1e-4 + 1e-8 / (10 * R));
  EXPECT_NEAR(water.max_gap(R / 2) / rupture, 1, 1e-12);
  // The energy is the integral of the force.
  contact.overlap = 0;
  double work = 0;
  const int parts = 4000;
  for (int p = 0; p < parts; ++p) work += pull_at((p + 0.5) / parts * rupture) * rupture / parts;
  contact.overlap = -rupture;
  EXPECT_NEAR(water.elastic_energy(contact, dem::StepsOfContact<double>{}) / work, 1, 1e-6);
}

// A moist grain that was thrown against a plane and comes back loses what the bridge takes.
TEST(CapillaryBridge, RupturesInSimulationsOrHolds) {
  const double R = 1e-3, m = 4.0 / 3 * pi * R * R * R * 2500;
  dem::Contact<3, double> contact;
  contact.effective_radius = R;
  contact.overlap = -water.max_gap(R);
  const double taken = water.elastic_energy(contact, dem::StepsOfContact<double>{});
  for (const double speed : {0.05, 0.5}) {
    const auto bounce = [&](const auto& any_law) {
      auto grains =
          one_grain<3>({0, 0, R * (1 + 1e-6)}, {0, 0, -speed}, {.radius = R, .density = 2500});
      Simulation simulation{grains, NeighbourList<3>{}, dem::Contacts{any_law, dem::Plane<3>{}},
                            Leapfrog{}};
      double gap = 0;
      bool has_touched = false;
      for (int step = 0; step < 200'000; ++step) {
        simulation.step(2e-7);
        const auto& contacts = simulation.interaction();
        contacts.for_each_contact(simulation.particles(),
                                  [&](Index, Index, const auto& each, const Vec<3>&) {
                                    gap = std::max(gap, -each.overlap);
                                  });
        has_touched |= contacts.size() > 0;
        if (has_touched && contacts.size() == 0) break;
      }
      return std::pair(simulation.particles()[velocity][0][2], gap);
    };
    const auto dry = bounce(dem::Law{hertz});
    const auto moist = bounce(law);
    EXPECT_EQ(dry.second, 0);
    const double left = squared(dry.first) - 2 * taken / m;
    if (left > 0) {
      EXPECT_NEAR(moist.first / std::sqrt(left), 1, 0.02) << speed;
      EXPECT_NEAR(moist.second / water.max_gap(R), 1, 0.01);
    } else {
      EXPECT_LT(moist.second, water.max_gap(R)) << "holds";
      EXPECT_LT(std::abs(moist.first), speed);
    }
  }
}

TEST(CapillaryBridge, RefusesWhatCannotBe) {
  const auto with = [](auto change) {
    return [change] {
      dem::CapillaryBridge bridge = water;
      change(bridge);
      dem::Contacts{dem::Law{hertz, bridge}};
    };
  };
  EXPECT_TRUE(refuses(with([](auto& b) { b.surface_tension = 0; }), {"surface_tension = 0"}));
  EXPECT_TRUE(refuses(with([](auto& b) { b.contact_angle = 90; }), {"contact_angle = 90"}));
  EXPECT_TRUE(refuses(with([](auto& b) { b.volume = -1; }), {"volume = -1"}));
}

}  // namespace
}  // namespace silt::test::capillary_bridge_test
