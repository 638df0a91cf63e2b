// SPDX-License-Identifier: MIT
// Oblique impacts, tests 4 to 8 of Chung and Ooi (2011). Contacts that slide throughout have an
// exact result, whatever the form of the law; where they stick, the published form is compared with
// the published curves. docs/verification.md has the deviations and their reasons.
#include "support/check.hpp"
#include "support/oblique_curves.hpp"
#include "support/oblique_impacts.hpp"
#include <gtest/gtest.h>

#include <cmath>

namespace silt::test::oblique_impact_test {
namespace {

TEST(ObliqueImpact, InThePublishedFormSlidesAsExactlyAndSticksAsPublished) {
  for (const auto& curve : oblique_curves()) {
    const ImpactDeviations found = curve.deviations(ImpactForm::published);
    EXPECT_LT(found.sliding, 0.01) << curve.name();
    if (!curve.bodies().inferred.any()) {
      EXPECT_LT(found.sticking, 0.15) << curve.name();
    }
  }
}

// The other curves.
TEST(ObliqueImpact, SticksAsPublishedWithWhatIsInferredFromTheCurve) {
  for (const auto& curve : oblique_curves()) {
    if (!curve.bodies().inferred.any()) continue;
    EXPECT_LT(curve.deviations(ImpactForm::inferred).sticking, 0.18) << curve.name();
    EXPECT_GT(curve.deviations(ImpactForm::published).sticking, 0.3) << curve.name();
  }
}

// The lever arm to the contact point is R − δ, where δ is up to 2.7 % of R for polyethylene.
TEST(ObliqueImpact, ByDefaultSlidesAsExactlyToWithinTheOverlap) {
  for (const auto& curve : oblique_curves()) {
    const bool is_soft = curve.bodies().name == "polyethylene";
    EXPECT_LT(curve.deviations(ImpactForm::by_default).sliding, is_soft ? 0.04 : 0.01)
        << curve.name();
  }
}

// Test 7.
TEST(ObliqueImpact, WithoutSlipChangesNoSpin) {
  for (const auto form : {ImpactForm::by_default, ImpactForm::published}) {
    for (const double spin : {0.5, 5.0, 20.0}) {
      const ObliqueMotion after = meet(spin, form);
      EXPECT_NEAR(after.spin, spin, 1e-12 * spin);
      EXPECT_NEAR(after.v, 0, 1e-13);
    }
  }
}

// Without loss, a spring that is sheared and then compressed must not gain energy.
TEST(ObliqueImpact, ByDefaultCreatesNoEnergy) {
  ObliqueBodies elastic = bodies_of_test(4, 0);
  elastic.restitution = 1;
  const double I = 0.4 * squared(elastic.sphere.R);  // over the mass
  const auto energy = [&](const ObliqueMotion& m) {
    return squared(m.v) + squared(m.v_n) + I * squared(m.spin);
  };
  for (const double v : {0.1, 0.3, 0.6, 1.0}) {
    const ObliqueMotion before{.v = v, .v_n = 3.9, .spin = 0};
    const auto after = bounce(elastic, before, ImpactForm::by_default);
    EXPECT_LE(energy(after), energy(before) * (1 + 1e-4)) << v;
  }
}

TEST(ChungOoi, RefusesWhatItsComponentsRefuse) {
  const auto contacts = [](const dem::ChungOoiMaterial& values) {
    dem::Contacts{dem::chung_ooi_law(values)};
  };
  EXPECT_TRUE(refuses([&] { contacts({}); }, {"Hertz: young_modulus = 0"}));
  EXPECT_TRUE(refuses([&] { contacts({.elastic = {1e9, 0.3}, .restitution = 1.5}); },
                      {"Hertz: restitution = 1.5"}));
  EXPECT_TRUE(refuses([&] { contacts({.elastic = {1e9, 0.3}, .friction_angle = 30}); },
                      {"Mindlin: friction_angle = 30"}));
}

}  // namespace
}  // namespace silt::test::oblique_impact_test
