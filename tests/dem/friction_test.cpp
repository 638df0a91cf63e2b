// SPDX-License-Identifier: MIT
// Friction forces. Sliding, rolling and oblique impacts are in validation/dem_reference.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test::friction_test {
namespace {

constexpr double g = 9.81;
constexpr double R = 0.01;

// The force of a law for a sliding contact.
dem::Contact<2, double> sliding_contact(double overlap, double speed) {
  dem::Contact<2, double> contact;
  contact.normal = {0, 1};
  contact.overlap = overlap;
  contact.relative_velocity = {speed, 0};
  contact.effective_mass = 1;
  contact.effective_radius = 1;
  contact.time_step = 1e-3;
  return contact;
}

Vec<2> after_sliding(const dem::CundallStrack& law, double overlap, double speed) {
  dem::CundallStrack::History<2, double> history;
  Vec<2> force = Vec<2>::Zero();
  const auto contact = sliding_contact(overlap, speed);
  for (int k = 0; k < 1000; ++k) force = law.components(contact, history).force(contact.normal);
  return force;
}

// A spring force with a part in the contact plane that is as small as can be.
template <class Real>
void expect_finite_spring(double normal_part) {
  using Vec = silt::Vec<3, Real>;
  const Vec n(0, 0, 1);
  for (double part = 1; part > 1e-200; part /= 16) {
    const Vec spring(Real(part), 0, Real(normal_part));
    const Vec rotated = dem::rotated_into_plane(spring, n);
    const double size = std::hypot(part, normal_part);
    ASSERT_GE(double(rotated[0]), 0) << part << " of " << normal_part;
    ASSERT_LE(double(rotated[0]), 1.0001 * size) << part << " of " << normal_part;
    if (part > 1e-18 * size && part > 1e-15) {
      EXPECT_NEAR(double(rotated[0]) / size, 1, 1e-6) << part << " of " << normal_part;
    }
  }
}

TEST(Friction, HasAFiniteSpringWhateverTheRotationOfTheContact) {
  for (const double normal_part : {0.0, 1e-3, 1.0, 1e3, 1e9}) {
    expect_finite_spring<float>(normal_part);
    expect_finite_spring<double>(normal_part);
    expect_finite_spring<Lane<float>>(normal_part);
  }
}

TEST(Friction, ASlidingContactHasNoTangentialDamping) {
  dem::CundallStrack law{
      .normal_stiffness = 1e4, .tangential_stiffness = 1e4, .friction_angle = 0.5};
  law.beta = 1e-2;
  const Vec<2> slow = after_sliding(law, 0.01, 1);
  const Vec<2> fast = after_sliding(law, 0.01, 100);
  EXPECT_NEAR(slow[0], -100 * std::tan(0.5), 1e-9);
  EXPECT_NEAR(fast[0], slow[0], 1e-9) << "friction does not depend on the speed";
}

TEST(Friction, CohesionActsWithoutLoad) {
  const dem::CundallStrack law{.normal_stiffness = 1e4, .tangential_stiffness = 1e4, .cohesion = 3};
  EXPECT_NEAR(after_sliding(law, 1e-12, 1)[0], -3, 1e-6);
}

TEST(Friction, OfTwoMaterialsHasTheSmallerAngleAndCohesion) {
  const dem::CundallStrack rough{
      .normal_stiffness = 1e4, .tangential_stiffness = 1e4, .friction_angle = 0.8, .cohesion = 1};
  const dem::CundallStrack sticky{
      .normal_stiffness = 1e4, .tangential_stiffness = 1e4, .friction_angle = 0.2, .cohesion = 5};
  const dem::Materials<dem::CundallStrack> materials{rough, sticky};
  for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{1u, 0u}}) {
    const Vec<2> force = after_sliding(materials.between(a, b), 0.01, 1);
    EXPECT_NEAR(force[0], -(100 * std::tan(0.2) + 1), 1e-9);
  }
  EXPECT_NEAR(after_sliding(materials.between(0, 0), 0.01, 1)[0], -(100 * std::tan(0.8) + 1), 1e-9);
  EXPECT_NEAR(after_sliding(materials.between(1, 1), 0.01, 1)[0], -(100 * std::tan(0.2) + 5), 1e-9);
}

TEST(Friction, OfTwoMaterialsHasSpringsInSeriesAndTheLowerRestitution) {
  const dem::CundallStrack stiff{.normal_stiffness = 3e4, .restitution = 0.9};
  const dem::CundallStrack soft{.normal_stiffness = 1e4, .restitution = 0.5};
  const auto mixed = dem::CundallStrack::mix(stiff, soft);
  // The spring of a single grain is twice that of its pair: two in series.
  EXPECT_DOUBLE_EQ(mixed.normal_stiffness, 1 / (1 / (2 * 3e4) + 1 / (2 * 1e4)));
  EXPECT_EQ(mixed.restitution.value, 0.5);
  EXPECT_DOUBLE_EQ(dem::CundallStrack::mix(stiff, stiff).normal_stiffness, 3e4);
}

TEST(Friction, KeepsAGrainThatCannotRotateAtRestOnASlope) {
  const double theta = 0.3;
  const double k = 1e5;
  const dem::CundallStrack law{.normal_stiffness = k,
                               .tangential_stiffness = 0.8 * k,
                               .restitution = 0.5,
                               .friction_angle = std::numbers::pi / 4};
  auto grains = one_grain<2>({0, R}, {0, 0});
  const double weight = grains[mass][0] * g;
  grains[position][0][1] -= weight * std::cos(theta) / k;
  grains[inertia][0] *= 1e12;
  Simulation sim{grains, UniformGrid<2>{},
                 Forces{Gravity<2>{{g * std::sin(theta), -g * std::cos(theta)}},
                        dem::Contacts{law, dem::Plane<2>{}}},
                 Leapfrog{}};
  sim.run({.until = 0.5, .time_step = 1e-5});
  const double settled = sim.particles()[position][0][0];
  const double stretch = weight * std::sin(theta) / law.tangential_stiffness;
  EXPECT_NEAR(settled, stretch, 1e-3 * stretch) << "the tangential spring carries the weight";
  sim.run({.until = 1.0, .time_step = 1e-5});
  EXPECT_NEAR(sim.particles()[position][0][0], settled, 1e-6 * stretch);
}

}  // namespace
}  // namespace silt::test::friction_test
