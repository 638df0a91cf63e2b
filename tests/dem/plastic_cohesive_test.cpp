// SPDX-License-Identifier: MIT
// The plastic, cohesive spring: its lines, its tension, its loss and restitution. No other law has
// a spring that pulls.
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/plastic_cohesive.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace silt::test::plastic_cohesive_test {
namespace {

constexpr double k_1 = 100, k_2 = 500, k_c = 200;
const dem::PlasticCohesive powder{.loading_stiffness = k_1,
                                  .unloading_stiffness = k_2,
                                  .cohesive_stiffness = k_c,
                                  .plastic_depth = 0.1};

// A contact of R* = ½ m, so that δ* = 0.125 m, whose overlap is given.
class Pressed {
 public:
  explicit Pressed(const dem::PlasticCohesive& spring = powder) : law(spring) {
    contact.normal = Vec<3>::Unit(2);
    contact.effective_radius = 0.5;
    contact.effective_mass = 1;
  }
  double at(double overlap) {
    contact.overlap = overlap;
    const auto all = law.components(contact, history);
    plastic += all.plastic;
    EXPECT_NEAR(all.normal_spring,
                all.force(contact.normal)[2] + law.normal.cohesive_stiffness * overlap, 1e-7)
        << "limits friction";
    return all.force(contact.normal)[2];
  }
  // Goes to this overlap [m] in small steps; returns the work on the contact [J].
  double move(double from, double to) {
    double work = 0, before = at(from);
    for (int step = 1; step <= 1000; ++step) {
      const double force = at(from + (to - from) * step / 1000);
      work += (before + force) / 2 * (to - from) / 1000;
      before = force;
    }
    return work;
  }

  dem::Law<dem::PlasticCohesive> law;
  dem::Contact<3, double> contact;
  decltype(law)::History<3, double> history;
  double plastic = 0;
};

TEST(PlasticCohesive, FollowsItsFourLines) {
  Pressed contact;
  EXPECT_DOUBLE_EQ(contact.at(0.05), k_1 * 0.05);
  EXPECT_DOUBLE_EQ(contact.at(0.1), k_1 * 0.1);
  const double k = k_1 + (k_2 - k_1) * 0.1 / 0.125, delta_0 = (1 - k_1 / k) * 0.1;
  EXPECT_DOUBLE_EQ(contact.at(0.09), k * (0.09 - delta_0));
  EXPECT_NEAR(contact.at(delta_0), 0, 1e-12);
  const double weakest = (k - k_1) / (k + k_c) * 0.1;
  EXPECT_NEAR(contact.at(weakest), -k_c * weakest, 1e-12) << "the largest tension";
  EXPECT_NEAR(contact.at(0.09), k * (0.09 - delta_0), 1e-12) << "and back";
  EXPECT_DOUBLE_EQ(contact.at(0.5 * weakest), -k_c * 0.5 * weakest);
  EXPECT_DOUBLE_EQ(contact.at(0.4 * weakest), -k_c * 0.4 * weakest);
  EXPECT_GT(contact.at(0.5 * weakest), -k_c * 0.5 * weakest) << "reloading is steeper";
  EXPECT_DOUBLE_EQ(contact.at(0.12), k_1 * 0.12);
  EXPECT_DOUBLE_EQ(contact.at(0.2), k_2 * (0.2 - 0.1)) << "elastic beyond δ*";
  EXPECT_DOUBLE_EQ(contact.at(0.15), k_2 * (0.15 - 0.1));
  EXPECT_EQ(contact.at(0), 0);
}

TEST(PlasticCohesive, LosesTheAreaBetweenItsLines) {
  Pressed contact;
  double work = contact.move(0, 0.1) + contact.move(0.1, 0.02) + contact.move(0.02, 0.2) +
                contact.move(0.2, 0);
  EXPECT_GT(work, 0);
  EXPECT_NEAR(contact.plastic / work, 1, 1e-4);
  EXPECT_NEAR(contact.law.elastic_energy(contact.contact, contact.history), 0, 1e-12);
}

// An impact that ends before the cohesive line, or is captured by it.
TEST(PlasticCohesive, ReboundsByTheRatioOfItsStiffnessesOrSticks) {
  const auto impact = [](double cohesion) {
    Pressed contact(dem::PlasticCohesive{.loading_stiffness = 1e6,
                                         .unloading_stiffness = 4e6,
                                         .cohesive_stiffness = cohesion,
                                         .plastic_depth = 1e-3});
    double v = 1, overlap = 0, deepest = 0;
    for (int step = 0; step < 20'000 && overlap >= 0; ++step) {
      v -= contact.at(overlap) * 1e-6;
      overlap += v * 1e-6;
      deepest = std::max(deepest, overlap);
    }
    return std::pair(overlap < 0 ? -v : 0, deepest);
  };
  const auto [restitution, deepest] = impact(0);
  const double k = 1e6 + 3e6 * deepest / (4e-3 / 3);
  EXPECT_NEAR(restitution, std::sqrt(1e6 / k), 1e-3);
  EXPECT_LT(impact(1e5).first, restitution - 0.01);
  EXPECT_EQ(impact(1e7).first, 0) << "sticks";
}

TEST(PlasticCohesive, RefusesWhatCannotBe) {
  const auto with = [](auto change) {
    return [change] {
      dem::PlasticCohesive law = powder;
      change(law);
      law.check();
    };
  };
  EXPECT_TRUE(refuses(with([](auto& l) { l.loading_stiffness = 0; }), {"loading_stiffness = 0"}));
  EXPECT_TRUE(refuses(with([](auto& l) { l.unloading_stiffness = k_1; }),
                      {"unloading_stiffness = 100", "not above loading_stiffness = 100"}));
  EXPECT_TRUE(
      refuses(with([](auto& l) { l.cohesive_stiffness = -1; }), {"cohesive_stiffness = -1"}));
  EXPECT_TRUE(refuses(with([](auto& l) { l.plastic_depth = 0; }), {"plastic_depth = 0"}));
  EXPECT_TRUE(refuses(with([](auto& l) { l.plastic_depth = 2; }), {"plastic_depth = 2"}));
  EXPECT_TRUE(refuses(with([](auto& l) { l.dashpot = -2; }), {"dashpot = -2"}));
}

}  // namespace
}  // namespace silt::test::plastic_cohesive_test
