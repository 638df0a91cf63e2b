// SPDX-License-Identifier: MIT
// Spheres with rolling and twisting resistance, against rigid-body mechanics.
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>

namespace silt::test::rolling_test {
namespace {

constexpr double g = 9.81;
constexpr double R = 0.01;

// A sphere on an incline that would roll without resistance.
template <int Dim>
auto on_incline(const dem::RollingResistance& resistance, double theta) {
  const double k = 1e5;
  const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = k, .restitution = 0.5},
                     dem::LinearFriction{.tangential_stiffness = 0.8 * k, .friction_angle = 1},
                     resistance};
  auto grains = one_grain<Dim>(Vec<Dim>(R * Vec<Dim>::Unit(Dim - 1)), Vec<Dim>(Vec<Dim>::Zero()),
                               {.radius = R, .density = 2500, .shape = dem::Shape::sphere});
  grains[position][0][Dim - 1] -= grains[mass][0] * g * std::cos(theta) / k;
  Vec<Dim> down = Vec<Dim>::Zero();
  down[0] = g * std::sin(theta);
  down[Dim - 1] = -g * std::cos(theta);
  return Simulation{grains, UniformGrid<Dim>{},
                    Forces{Gravity<Dim>{down}, dem::Contacts{law, dem::Plane<Dim>{}}}, Leapfrog{}};
}

template <int Dim>
void holds_below_its_coefficient() {
  const double mu = 0.2;
  auto held = on_incline<Dim>({.rolling_friction = mu}, std::atan(0.95 * mu));
  held.run({.until = 0.5});
  const double settled = held.particles()[position][0][0];
  EXPECT_LT(settled, 0.01 * R);
  EXPECT_LT(held.particles()[velocity][0].norm(), 1e-6);
  held.run({.until = 0.6});
  EXPECT_NEAR(held.particles()[position][0][0], settled, 1e-7 * R);

  // Beyond this it rolls: the couple μ_r m g cos θ R reduces the driving moment.
  const double theta = std::atan(2 * mu);
  auto rolls = on_incline<Dim>({.rolling_friction = mu}, theta);
  rolls.run({.until = 0.5});
  const double a = g * (std::sin(theta) - mu * std::cos(theta)) / 1.4;
  EXPECT_NEAR(rolls.particles()[velocity][0][0] / (a * 0.5), 1, 0.01);
}

TEST(RollingResistance, KeepsASphereAtRestBelowItsCoefficient2D) {
  holds_below_its_coefficient<2>();
}
TEST(RollingResistance, KeepsASphereAtRestBelowItsCoefficient3D) {
  holds_below_its_coefficient<3>();
}

TEST(RollingResistance, StopsASphereThatSpinsAboutTheNormal) {
  const double mu = 0.05, w = 20;
  // Little damping, because the dashpot also resists until the slider slides.
  auto sim = on_incline<3>({.twisting_friction = mu, .damping_ratio = 0.03}, 0);
  sim.particles()[spin][0] = {0, 0, w};
  // I dw/dt = −μ_t R m g with I = 2/5 m R².
  const double stops = 0.4 * R * w / (mu * g);
  sim.run({.until = stops / 2});
  EXPECT_NEAR(sim.particles()[spin][0][2], w / 2, 0.01 * w);
  sim.run({.until = 1.5 * stops});
  EXPECT_NEAR(sim.particles()[spin][0][2], 0, 0.01 * w);
  EXPECT_NEAR(sim.particles()[position][0][0], 0, 1e-12);
}

}  // namespace
}  // namespace silt::test::rolling_test
