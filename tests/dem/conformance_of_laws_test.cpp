// SPDX-License-Identifier: MIT
// The conformance checks for every contact law of the library.
#include <silt/dem/conformance/conformance.hpp>
#include <silt/dem/law/adhesion.hpp>
#include <silt/dem/law/capillary_bridge.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/jkr.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>
#include <silt/dem/law/plastic_cohesive.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>

#include <gtest/gtest.h>

namespace silt::test::conformance_of_laws_test {
namespace {

template <class Law>
void expect_sound(const Law& law, const dem::ConformanceConditions& trial = {}) {
  const auto report = dem::conformance_of(law, trial);
  EXPECT_TRUE(report.passes()) << report.text();
  EXPECT_GE(report.checks.size(), 26u) << "both dimensions were checked";
}

const dem::LinearFriction friction{.tangential_stiffness = 8e5, .friction_angle = 0.4};

TEST(ConformanceOfLaws, CundallStrackPasses) {
  expect_sound(dem::CundallStrack{.normal_stiffness = 1e6,
                                  .tangential_stiffness = 5e5,
                                  .restitution = 0.6,
                                  .friction_angle = 0.5,
                                  .cohesion = 0.1});
  expect_sound(dem::CundallStrack{
      .normal_stiffness = 1e4, .tangential_stiffness = 1e4, .friction_angle = 1.4});
  expect_sound(
      dem::CundallStrack{.normal_stiffness = 1e8, .restitution = 0.05, .limit_damping = true},
      {.radius = 1, .overlap = 1e-5});
}

TEST(ConformanceOfLaws, CundallStrackIncrementalPasses) {
  expect_sound(dem::CundallStrackIncremental{.normal_stiffness = 1e6,
                                             .tangential_stiffness = 5e5,
                                             .restitution = 0.6,
                                             .friction_angle = 0.5});
  expect_sound(dem::CundallStrackIncremental{.normal_stiffness = 1e6, .tangential_stiffness = 5e5});
}

TEST(ConformanceOfLaws, LinearSpringDashpotPassesAloneAndWithFriction) {
  const dem::LinearSpringDashpot normal{.normal_stiffness = 1e6, .restitution = 0.7};
  expect_sound(dem::Law{normal});
  expect_sound(dem::Law{normal, friction});
}

TEST(ConformanceOfLaws, WaltonBraunPassesWithFriction) {
  for (const double e : {0.2, 0.9, 1.0}) {
    expect_sound(dem::Law{dem::WaltonBraun{.loading_stiffness = 1e6, .restitution = e}, friction});
  }
}

TEST(ConformanceOfLaws, PlasticCohesivePassesWithFriction) {
  const dem::PlasticCohesive powder{
      .loading_stiffness = 1e6, .unloading_stiffness = 5e6, .cohesive_stiffness = 1e6};
  expect_sound(dem::Law{powder, friction});
  dem::PlasticCohesive damped = powder;
  damped.dashpot = 1;
  expect_sound(dem::Law{damped, friction});
}

TEST(ConformanceOfLaws, HertzAndMindlinPass) {
  const dem::Elastic glass{.young_modulus = 5e9, .poisson_ratio = 0.2};
  const dem::Hertz hertz{.elastic = glass, .restitution = 0.8};
  expect_sound(dem::Law{hertz});
  expect_sound(dem::Law{hertz, dem::Mindlin{.elastic = glass, .friction_angle = 0.4}});
  expect_sound(dem::Law{hertz, dem::MindlinDeresiewicz{.elastic = glass, .friction_angle = 0.4}});
}

TEST(ConformanceOfLaws, RollingResistancePassesWithLinearSpringsAndHertz) {
  const dem::RollingResistance rolling{.rolling_friction = 0.2, .twisting_friction = 0.1};
  const dem::LinearSpringDashpot linear{.normal_stiffness = 1e6, .restitution = 0.7};
  const dem::Hertz hertz{.elastic = {.young_modulus = 5e9, .poisson_ratio = 0.2}};
  expect_sound(dem::Law{linear, friction, rolling});
  expect_sound(dem::Law{hertz, rolling});
}

TEST(ConformanceOfLaws, AdhesionPasses) {
  const dem::LinearSpringDashpot linear{.normal_stiffness = 1e6, .restitution = 0.7};
  const dem::Hertz hertz{.elastic = {.young_modulus = 5e9, .poisson_ratio = 0.2},
                         .restitution = 0.9};
  expect_sound(dem::Law{linear, dem::ConstantCohesion{.pull = 3}});
  expect_sound(dem::Law{hertz, dem::DmtAdhesion{.surface_energy = 10}});
  expect_sound(dem::Law{
      hertz, dem::CapillaryBridge{.surface_tension = 70, .contact_angle = 0.2, .volume = 1e-8}});
  const dem::Jkr jkr{.elastic = {.young_modulus = 5e9, .poisson_ratio = 0.2},
                     .surface_energy = 10,
                     .restitution = 0.9};
  expect_sound(dem::Law{jkr});
  expect_sound(dem::Law{jkr, dem::Mindlin{.elastic = jkr.elastic, .friction_angle = 0.3}});
}

}  // namespace
}  // namespace silt::test::conformance_of_laws_test
