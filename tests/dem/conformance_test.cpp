// SPDX-License-Identifier: MIT
// The kit that tries contact laws, on laws that are wrong in one way each.
#include <silt/dem/conformance.hpp>
#include <silt/dem/cundall_strack.hpp>

#include "support/check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

namespace silt::test {
namespace {

// A spring and a dashpot along the normal, a spring with a slider along the plane, and a spring
// against rolling and twisting; a fault makes it wrong.
enum class Fault {
  none,
  dashpot_pulls_while_approaching,
  spring_stays_in_its_old_plane,
  softer_along_the_first_axis,
  couple_turns_on,
  stiffer_on_the_side_of_the_upper,
  divides_by_the_speed_of_sliding,
  stores_half_of_its_energy,
  rounds_off,
  answers_otherwise_in_lanes,
  softens_with_its_load,
  pulls,
};

struct Law {
  Fault fault = Fault::none;

  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> force = Vec<Dim, Real>::Zero();
    AngularVec<Dim, Real> turn = zero_of<AngularVec<Dim, Real>>();  // of rolling; in 2D there is no other
    Real twist = 0;
  };

  template <class C, class M>
  auto components(const C& contact, M& history) const {
    using Real = typename C::Real;
    constexpr bool in_lanes = !std::is_floating_point_v<Real>;
    const auto n = contact.normal;
    const auto v_s = contact.tangential_velocity();
    Real k = Real(1e6);
    Real c = Real(60);
    if (fault == Fault::dashpot_pulls_while_approaching) c = -c;
    if (fault == Fault::softer_along_the_first_axis) k *= 1 - Real(0.1) * squared(n[0]);
    if (fault == Fault::stiffer_on_the_side_of_the_upper) k *= 1 + Real(0.1) * n[0];
    if (fault == Fault::rounds_off) k *= (Real(1) + Real(1e-9) - Real(1)) * Real(1e9);
    if (fault == Fault::answers_otherwise_in_lanes && in_lanes) k *= Real(1.01);
    if (fault == Fault::pulls) k = -k;

    if (fault != Fault::spring_stays_in_its_old_plane) {
      history.force -= history.force.dot(n) * n;
    }
    const Real k_s = fault == Fault::softens_with_its_load
                         ? k * std::sqrt(contact.overlap / Real(1e-4))
                         : k / 2;
    history.force -= k_s * contact.time_step * v_s;
    const Real most = k * contact.overlap / 2;
    const Real size = history.force.norm();
    if (size > most) history.force *= most / size;
    auto couple = history.turn;
    if constexpr (C::dimension == 2) {
      couple = history.turn += contact.relative_spin * contact.time_step;
    } else {
      const Real twisting = contact.relative_spin.dot(n);
      history.twist += twisting * contact.time_step;
      history.turn -= history.turn.dot(n) * n;
      history.turn += (contact.relative_spin - twisting * n) * contact.time_step;
      couple = history.turn + history.twist * n;
    }

    dem::LoadComponents<C::dimension, Real> parts;
    parts.normal_spring = k * contact.overlap;
    parts.normal_dashpot = c * contact.approach_speed();
    parts.tangential_spring = history.force;
    if (fault == Fault::divides_by_the_speed_of_sliding) {
      parts.tangential_dashpot = -Real(1e-6) * v_s / v_s.norm();
    }
    const Real stiffness = fault == Fault::couple_turns_on ? -20 : 20;
    parts.rolling_spring = -stiffness * couple;
    return parts;
  }

  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    const double k = 1e6;
    const double stored = k * squared(double(contact.overlap)) / 2 +
                          double(history.force.squaredNorm()) / k +
                          10 * double(squared_norm(history.turn) + squared(history.twist));
    return fault == Fault::stores_half_of_its_energy ? stored / 2 : stored;
  }
};

// Fails this finding, says so in words, and all others hold but for these.
void expect_finding(Fault fault, const std::string& name,
                    const std::vector<std::string>& also = {}) {
  const auto verdict = dem::conformance_of(Law{fault});
  EXPECT_FALSE(verdict.holds(name)) << name;
  EXPECT_NE(verdict.text().find(name), std::string::npos);
  for (const auto& finding : verdict.findings) {
    const bool expected =
        finding.name == name || std::find(also.begin(), also.end(), finding.name) != also.end();
    EXPECT_TRUE(expected || finding.holds())
        << finding.dimension << "D " << finding.name << ": " << finding.value;
  }
}

TEST(Conformance, OfASoundLawHolds) {
  const auto verdict = dem::conformance_of(Law{Fault::none});
  EXPECT_TRUE(verdict.holds()) << verdict.text();
  EXPECT_EQ(verdict.text(), "");
  EXPECT_EQ(verdict.findings.size(), 30u) << "fifteen in the plane, fifteen in space";
}

TEST(Conformance, FindsADashpotOfTheWrongSign) {
  expect_finding(Fault::dashpot_pulls_while_approaching, "no energy from pressing",
                 {"restitution is at most 1", "no energy from impacts",
                  "a faster impact loses no less", "no energy from sliding",
                  "no energy from sliding under changing load", "no energy from rolling",
                  "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsASpringThatDoesNotTurnWithTheContact) {
  expect_finding(Fault::spring_stays_in_its_old_plane, "memory turns with the contact");
}

TEST(Conformance, FindsAForceThatKnowsADirection) {
  expect_finding(Fault::softer_along_the_first_axis, "the same in any frame",
                 {"memory turns with the contact", "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsACoupleOfTheWrongSign) {
  expect_finding(Fault::couple_turns_on, "no energy from rolling",
                 {"no energy from impacts", "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsAForceThatIsNotTheReaction) {
  expect_finding(Fault::stiffer_on_the_side_of_the_upper, "action equals reaction",
                 {"the same in any frame", "memory turns with the contact",
                  "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsAnAnswerThatIsNotFinite) {
  expect_finding(Fault::divides_by_the_speed_of_sliding, "finite answers",
                 {"pushes back", "the same in any frame", "memory turns with the contact",
                  "action equals reaction", "the same in float", "the same for eight at once",
                  "no energy from pressing", "no energy from sliding", "no energy from rolling",
                  "no energy from sliding under changing load",
                  "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsAnElasticEnergyThatIsNot) {
  expect_finding(Fault::stores_half_of_its_energy, "elastic_energy is what the springs hold");
}

TEST(Conformance, FindsWhatFloatCannotTell) {
  expect_finding(Fault::rounds_off, "the same in float");
}

TEST(Conformance, FindsAnAnswerThatDiffersForEightAtOnce) {
  expect_finding(Fault::answers_otherwise_in_lanes, "the same for eight at once");
}

TEST(Conformance, FindsASpringThatKeepsItsForceWhileItSoftens) {
  expect_finding(Fault::softens_with_its_load, "no energy from sliding under changing load",
                 {"no energy from sliding", "elastic_energy is what the springs hold"});
}

TEST(Conformance, FindsThatAContactPulls) {
  const auto verdict = dem::conformance_of(Law{Fault::pulls});
  EXPECT_FALSE(verdict.holds("pushes back"));
  EXPECT_FALSE(verdict.holds("no such finding"));
}

TEST(Conformance, RefusesATrialOutOfRange) {
  const dem::CundallStrack law{.normal_stiffness = 1e6};
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.radius = -1}); },
                      {"LawTrial: radius = -1"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.density = 0}); },
                      {"LawTrial: density = 0"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.overlap = 0}); },
                      {"LawTrial: overlap = 0"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.overlap = 0.1}); },
                      {"overlap over radius"}));
  EXPECT_TRUE(
      refuses([] { dem::conformance_of(dem::CundallStrack{}); }, {"normal_stiffness = 0"}));
}

}  // namespace
}  // namespace silt::test
