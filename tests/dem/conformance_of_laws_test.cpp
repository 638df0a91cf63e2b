// SPDX-License-Identifier: MIT
// Every contact law of the library through the kit that a user's laws go through.
#include <silt/dem/adhesion.hpp>
#include <silt/dem/conformance.hpp>
#include <silt/dem/cundall_strack.hpp>
#include <silt/dem/hertz.hpp>
#include <silt/dem/law.hpp>
#include <silt/dem/linear_friction.hpp>
#include <silt/dem/linear_spring_dashpot.hpp>
#include <silt/dem/mindlin.hpp>
#include <silt/dem/rolling_resistance.hpp>
#include <silt/dem/walton_braun.hpp>

#include <gtest/gtest.h>

namespace silt::test {
namespace {

template <class Law>
void expect_sound(const Law& law, const dem::LawTrial& trial = {}) {
  const auto verdict = dem::conformance_of(law, trial);
  EXPECT_TRUE(verdict.holds()) << verdict.text();
  EXPECT_GE(verdict.findings.size(), 26u) << "it was tried in both dimensions";
}

const dem::LinearFriction friction{.tangential_stiffness = 8e5, .friction_angle = 0.4};

TEST(ConformanceOfLaws, CundallStrackHolds) {
  expect_sound(dem::CundallStrack{.normal_stiffness = 1e6,
                                  .tangential_stiffness = 5e5,
                                  .restitution = 0.6,
                                  .friction_angle = 0.5,
                                  .cohesion = 0.1});
  expect_sound(dem::CundallStrack{.normal_stiffness = 1e4, .tangential_stiffness = 1e4,
                                  .friction_angle = 1.4});
  expect_sound(dem::CundallStrack{.normal_stiffness = 1e8, .restitution = 0.05, .limit_damping = true},
               {.radius = 1, .overlap = 1e-5});
}

TEST(ConformanceOfLaws, CundallStrackIncrementalHolds) {
  expect_sound(dem::CundallStrackIncremental{.normal_stiffness = 1e6,
                                             .tangential_stiffness = 5e5,
                                             .restitution = 0.6,
                                             .friction_angle = 0.5});
  expect_sound(dem::CundallStrackIncremental{.normal_stiffness = 1e6, .tangential_stiffness = 5e5});
}

TEST(ConformanceOfLaws, LinearSpringDashpotHoldsAloneAndWithFriction) {
  const dem::LinearSpringDashpot normal{.normal_stiffness = 1e6, .restitution = 0.7};
  expect_sound(dem::Law{normal});
  expect_sound(dem::Law{normal, friction});
}

TEST(ConformanceOfLaws, WaltonBraunHoldsWithFriction) {
  for (const double e : {0.2, 0.9, 1.0}) {
    expect_sound(dem::Law{dem::WaltonBraun{.loading_stiffness = 1e6, .restitution = e}, friction});
  }
}

TEST(ConformanceOfLaws, HertzAndMindlinHold) {
  const dem::Elastic glass{.young_modulus = 5e9, .poisson_ratio = 0.2};
  const dem::Hertz hertz{.elastic = glass, .restitution = 0.8};
  expect_sound(dem::Law{hertz});
  expect_sound(dem::Law{hertz, dem::Mindlin{.elastic = glass, .friction_angle = 0.4}});
}

TEST(ConformanceOfLaws, RollingResistanceHoldsOnLinearSpringsAndOnHertzs) {
  const dem::RollingResistance rolling{.rolling_friction = 0.2, .twisting_friction = 0.1};
  const dem::LinearSpringDashpot linear{.normal_stiffness = 1e6, .restitution = 0.7};
  const dem::Hertz hertz{.elastic = {.young_modulus = 5e9, .poisson_ratio = 0.2}};
  expect_sound(dem::Law{linear, friction, rolling});
  expect_sound(dem::Law{hertz, rolling});
}

TEST(ConformanceOfLaws, AdhesionHolds) {
  const dem::LinearSpringDashpot linear{.normal_stiffness = 1e6, .restitution = 0.7};
  const dem::Hertz hertz{.elastic = {.young_modulus = 5e9, .poisson_ratio = 0.2},
                         .restitution = 0.9};
  expect_sound(dem::Law{linear, dem::ConstantCohesion{.pull = 3}});
  expect_sound(dem::Law{hertz, dem::DmtAdhesion{.surface_energy = 10}});
}

}  // namespace
}  // namespace silt::test
