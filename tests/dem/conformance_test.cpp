// SPDX-License-Identifier: MIT
// The conformance checks, applied to laws with one error each.
#include <silt/dem/conformance/conformance.hpp>
#include <silt/dem/law/cundall_strack.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

namespace silt::test::conformance_test {
namespace {

// Normal spring and dashpot, tangential spring and slider, and a spring against rolling and
// twisting; with an optional fault.
enum class Fault {
  none,
  dashpot_pulls_while_approaching,
  spring_stays_in_its_old_plane,
  softer_along_the_first_axis,
  couple_turns_on,
  stiffer_on_the_side_of_the_upper,
  divides_by_the_speed_of_sliding,
  overflows_for_fast_sliding_at_small_overlaps,
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
    AngularVec<Dim, Real> turn = zero_of<AngularVec<Dim, Real>>();  // rolling; the only one in 2D
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
    const Real k_s =
        fault == Fault::softens_with_its_load ? k * std::sqrt(contact.overlap / Real(1e-4)) : k / 2;
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

    dem::LoadComponents<C::dimension, Real> result;
    result.normal_spring = k * contact.overlap;
    result.normal_dashpot = c * contact.approach_speed();
    result.tangential_spring = history.force;
    if (fault == Fault::divides_by_the_speed_of_sliding) {
      result.tangential_dashpot = -Real(1e-6) * v_s / v_s.norm();
    }
    if (fault == Fault::overflows_for_fast_sliding_at_small_overlaps) {
      const Real ratio = Real(1e-12) * v_s.squaredNorm() / contact.overlap;
      result.tangential_dashpot = -squared(squared(ratio)) * v_s;
    }
    const Real stiffness = fault == Fault::couple_turns_on ? -20 : 20;
    result.rolling_spring = -stiffness * couple;
    return result;
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

// This check fails and is in the text; all others pass, except those in `also`.
void expect_failure(Fault fault, const std::string& name,
                    const std::vector<std::string>& also = {}) {
  const auto report = dem::conformance_of(Law{fault});
  EXPECT_FALSE(report.passes(name)) << name;
  EXPECT_NE(report.text().find(name), std::string::npos);
  for (const auto& check : report.checks) {
    const bool expected =
        check.name == name || std::find(also.begin(), also.end(), check.name) != also.end();
    EXPECT_TRUE(expected || check.passes())
        << check.dimension << "D " << check.name << ": " << check.value;
  }
}

TEST(Conformance, PassesForACorrectLaw) {
  const auto report = dem::conformance_of(Law{Fault::none});
  EXPECT_TRUE(report.passes()) << report.text();
  EXPECT_EQ(report.text(), "");
  EXPECT_EQ(report.checks.size(), 30u) << "fifteen in 2D, fifteen in 3D";
}

TEST(Conformance, DetectsADashpotOfTheWrongSign) {
  expect_failure(
      Fault::dashpot_pulls_while_approaching, "no energy gain in normal loading",
      {"restitution is at most 1", "no energy gain in impacts",
       "energy loss does not decrease with speed", "no energy gain in sliding",
       "no energy gain in sliding under changing load",
       "no energy gain in rolling", "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsASpringThatDoesNotRotateWithTheContact) {
  expect_failure(Fault::spring_stays_in_its_old_plane, "history rotates with the contact");
}

TEST(Conformance, DetectsAForceWithAFixedDirection) {
  expect_failure(
      Fault::softer_along_the_first_axis, "the same in any frame",
      {"history rotates with the contact", "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsACoupleOfTheWrongSign) {
  expect_failure(Fault::couple_turns_on, "no energy gain in rolling",
                 {"no energy gain in impacts", "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsAViolationOfActionAndReaction) {
  expect_failure(Fault::stiffer_on_the_side_of_the_upper, "action equals reaction",
                 {"the same in any frame", "history rotates with the contact",
                  "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsAResultThatIsNotFinite) {
  expect_failure(Fault::overflows_for_fast_sliding_at_small_overlaps, "finite results");
  expect_failure(Fault::divides_by_the_speed_of_sliding, "finite results",
                 {"repulsive", "the same in any frame", "history rotates with the contact",
                  "action equals reaction", "the same in float", "independent of vectorisation",
                  "no energy gain in normal loading", "no energy gain in sliding",
                  "no energy gain in rolling", "no energy gain in sliding under changing load",
                  "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsAWrongElasticEnergy) {
  expect_failure(Fault::stores_half_of_its_energy, "elastic_energy is the energy of the springs");
}

TEST(Conformance, DetectsLossOfPrecisionInFloat) {
  expect_failure(Fault::rounds_off, "the same in float");
}

TEST(Conformance, DetectsAResultThatDiffersForEightAtOnce) {
  expect_failure(Fault::answers_otherwise_in_lanes, "independent of vectorisation");
}

TEST(Conformance, DetectsASpringThatKeepsItsForceWhileItSoftens) {
  expect_failure(Fault::softens_with_its_load, "no energy gain in sliding under changing load",
                 {"no energy gain in sliding", "elastic_energy is the energy of the springs"});
}

TEST(Conformance, DetectsAnAttractiveContact) {
  const auto report = dem::conformance_of(Law{Fault::pulls});
  EXPECT_FALSE(report.passes("repulsive"));
  EXPECT_FALSE(report.passes("no such check"));
}

TEST(Conformance, ThrowsForConditionsOutOfRange) {
  const dem::CundallStrack law{.normal_stiffness = 1e6};
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.radius = -1}); },
                      {"ConformanceConditions: radius = -1"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.density = 0}); },
                      {"ConformanceConditions: density = 0"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.overlap = 0}); },
                      {"ConformanceConditions: overlap = 0"}));
  EXPECT_TRUE(refuses([&] { dem::conformance_of(law, {.overlap = 0.1}); },
                      {"overlap = 0.1 m", "radius = 0.01 m"}));
  EXPECT_TRUE(refuses([] { dem::conformance_of(dem::CundallStrack{}); }, {"normal_stiffness = 0"}));
}

}  // namespace
}  // namespace silt::test::conformance_test
