// SPDX-License-Identifier: MIT
// Sliding, rolling and oblique impacts against rigid-body mechanics.
#include "support/check.hpp"
#include "support/grains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test {
namespace {

// Disc or sphere: what differs is the moment of inertia, I = c m R².
struct Body {
  dem::Shape shape;
  double c;
};
template <int Dim>
std::vector<Body> bodies() {
  if constexpr (Dim == 2) {
    return {{dem::Shape::natural, 0.5}, {dem::Shape::sphere, 0.4}};
  } else {
    return {{dem::Shape::natural, 0.4}};
  }
}

// Spin of a grain as seen along the axis about which it rolls in +x on a floor whose normal is the
// last axis: positive when rolling forward.
double forward_spin(double spin) { return -spin; }
double forward_spin(const Vec<3>& spin) { return spin[1]; }

constexpr double g = 9.81;
constexpr double R = 0.01;

struct Floor {
  double mu;
  double theta;            // inclination, turned into the direction of gravity
  double stiffness = 1e5;
};

// A grain on the floor, already sunk in to where the floor carries it.
template <int Dim>
auto on_floor(const Body& body, const Floor& floor, double u0) {
  const auto [mu, theta, k] = floor;
  const dem::CundallStrack law{.normal_stiffness = k,
                               .tangential_stiffness = 0.8 * k,
                               .restitution = 0.5,
                               .friction_angle = std::atan(mu)};
  auto grains = one_grain<Dim>(Vec<Dim>(R * Vec<Dim>::Unit(Dim - 1)), Vec<Dim>(u0 * Vec<Dim>::Unit(0)),
                               {.radius = R, .density = 2500, .shape = body.shape});
  grains[position][0][Dim - 1] -= grains[mass][0] * g * std::cos(theta) / k;
  Vec<Dim> down = Vec<Dim>::Zero();
  down[0] = g * std::sin(theta);
  down[Dim - 1] = -g * std::cos(theta);
  return Simulation{grains, UniformGrid<Dim>{}, Forces{Gravity<Dim>{down}, dem::Contacts{law, dem::Plane<Dim>{}}},
                    Leapfrog{}};
}

template <int Dim>
void slides_then_rolls() {
  for (const Body& body : bodies<Dim>()) {
    for (const double mu : {0.2, 0.6, 1.0}) {
      const double u0 = 0.1;
      // Until the slider gives way the dashpot pulls, too, which costs a speed of about beta mu g;
      // a stiff floor makes that small against the one per cent asked for.
      auto sim = on_floor<Dim>(body, {.mu = mu, .theta = 0, .stiffness = 1e8}, u0);
      // Slowed by mu g and spun up by mu g/(c R) until both agree.
      const double t_roll = u0 / (mu * g * (1 + 1 / body.c));
      sim.run({.until = 0.5 * t_roll});
      EXPECT_NEAR(sim.particles()[velocity][0][0], u0 - mu * g * sim.time(), 0.01 * u0);
      EXPECT_NEAR(forward_spin(sim.particles()[spin][0]) * R, mu * g * sim.time() / body.c, 0.01 * u0);
      // Rolling: the tangential spring rings a little around it, so take a mean.
      sim.run({.until = 2 * t_roll});
      double u = 0;
      double w = 0;
      const int samples = 4000;
      for (int k = 0; k < samples; ++k) {
        sim.step();
        u += sim.particles()[velocity][0][0] / samples;
        w += forward_spin(sim.particles()[spin][0]) / samples;
      }
      EXPECT_NEAR(u / u0, 1 / (1 + body.c), 0.005) << "mu " << mu;
      EXPECT_NEAR(w * R / u0, 1 / (1 + body.c), 0.005) << "mu " << mu;
    }
  }
}

TEST(Friction, ASlidingDiscEndsUpRollingWithTwoThirdsOfItsSpeed) { slides_then_rolls<2>(); }
TEST(Friction, ASlidingSphereEndsUpRollingWithFiveSeventhsOfItsSpeed) { slides_then_rolls<3>(); }

template <int Dim>
void goes_downhill() {
  for (const Body& body : bodies<Dim>()) {
    const double theta = 0.5;
    const double least_mu = std::tan(theta) / (1 + 1 / body.c);  // that lets it roll
    for (const double mu : {0.5 * least_mu, 1.5 * least_mu}) {
      auto sim = on_floor<Dim>(body, {.mu = mu, .theta = theta}, 0);
      sim.run({.until = 0.2});
      const double u = sim.particles()[velocity][0][0] / sim.time();
      const double w = forward_spin(sim.particles()[spin][0]) * R / sim.time();
      if (mu < least_mu) {
        EXPECT_NEAR(u, g * (std::sin(theta) - mu * std::cos(theta)), 0.01 * g);
        EXPECT_NEAR(w, mu * g * std::cos(theta) / body.c, 0.01 * g);
        EXPECT_GT(u, 1.1 * w) << "it slips";
      } else {
        EXPECT_NEAR(u, g * std::sin(theta) / (1 + body.c), 0.01 * g);
        EXPECT_NEAR(w, u, 0.01 * g) << "it rolls";
      }
    }
  }
}

TEST(Friction, ADiscRollsDownAnInclineOrSlipsWhereItIsTooSteep) { goes_downhill<2>(); }
TEST(Friction, ASphereRollsDownAnInclineOrSlipsWhereItIsTooSteep) { goes_downhill<3>(); }

struct Rebound {
  double normal;
  double tangential;
  double spin;  // forward, times R
};

template <int Dim>
Rebound oblique(const Body& body, const dem::CundallStrack& law, double vt, double vn) {
  Vec<Dim> v = Vec<Dim>::Zero();
  v[0] = vt;
  v[Dim - 1] = -vn;
  auto grains = one_grain<Dim>(Vec<Dim>((R + 1e-5) * Vec<Dim>::Unit(Dim - 1)), v,
                               {.radius = R, .density = 2500, .shape = body.shape});
  Simulation sim{grains, UniformGrid<Dim>{}, dem::Contacts{law, dem::Plane<Dim>{}}, Leapfrog{}};
  through_contact(sim, sim.time_step() / 10);
  const auto& out = sim.particles();
  return {out[velocity][0][Dim - 1], out[velocity][0][0], forward_spin(out[spin][0]) * R};
}

template <int Dim>
void slides_through_the_impact() {
  for (const Body& body : bodies<Dim>()) {
    for (const double e : {1.0, 0.7}) {
      for (const double mu : {0.1, 0.3}) {
        const double vn = 1e-3;
        const double vt = 2 * (1 + 1 / body.c) * mu * (1 + e) * vn;  // twice what sliding needs
        const auto out = oblique<Dim>(body,
                                      {.normal_stiffness = 1e6,
                                       .tangential_stiffness = 8e5,
                                       .restitution = e,
                                       .friction_angle = std::atan(mu)},
                                      vt, vn);
        const double loss = mu * (1 + e) * vn;
        EXPECT_NEAR(out.normal, e * vn, 0.005 * vn);
        EXPECT_NEAR(out.tangential, vt - loss, 0.01 * loss);
        EXPECT_NEAR(out.spin, loss / body.c, 0.01 * loss / body.c);
      }
    }
  }
}

TEST(Friction, AnObliqueImpactThatSlidesLosesMuTimesTheNormalImpulse) {
  slides_through_the_impact<2>();
  slides_through_the_impact<3>();
}

template <int Dim>
void sticks() {
  for (const Body& body : bodies<Dim>()) {
    // The surface swings on the tangential spring with ω² = k_s (1 + 1/c)/m. Choose k_s such that
    // the contact lasts a quarter of that period: the surface is then at rest, as if it had stuck.
    const double k_n = 1e6;
    const double k_s = k_n / 4 / (1 + 1 / body.c);
    const auto out = oblique<Dim>(body,
                                  {.normal_stiffness = k_n,
                                   .tangential_stiffness = k_s,
                                   .friction_angle = 1.5},
                                  1e-3, 1e-2);
    EXPECT_NEAR(out.tangential / 1e-3, 1 / (1 + body.c), 0.01);
    EXPECT_NEAR(out.spin / 1e-3, 1 / (1 + body.c), 0.01);
  }
}

TEST(Friction, AGrainWhoseSurfaceStopsInTheImpactLeavesRolling) {
  sticks<2>();
  sticks<3>();
}

// The force of the law alone, for a contact that slides.
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
  dem::CundallStrack::Memory<2, double> memory;
  Vec<2> force = Vec<2>::Zero();
  const auto contact = sliding_contact(overlap, speed);
  for (int k = 0; k < 1000; ++k) force = law.parts(contact, memory).force(contact.normal);
  return force;
}

TEST(Friction, AContactThatSlidesHasNoTangentialDamping) {
  dem::CundallStrack law{.normal_stiffness = 1e4, .tangential_stiffness = 1e4, .friction_angle = 0.5};
  law.beta = 1e-2;
  const Vec<2> slow = after_sliding(law, 0.01, 1);
  const Vec<2> fast = after_sliding(law, 0.01, 100);
  EXPECT_NEAR(slow[0], -100 * std::tan(0.5), 1e-9);
  EXPECT_NEAR(fast[0], slow[0], 1e-9) << "friction does not depend on the speed";
}

TEST(Friction, ACohesionHoldsWithoutLoad) {
  const dem::CundallStrack law{.normal_stiffness = 1e4, .tangential_stiffness = 1e4, .cohesion = 3};
  EXPECT_NEAR(after_sliding(law, 1e-12, 1)[0], -3, 1e-6);
}

TEST(Friction, OfTwoMaterialsTheSmallerAngleAndCohesionCount) {
  const dem::CundallStrack rough{.normal_stiffness = 1e4, .tangential_stiffness = 1e4,
                                 .friction_angle = 0.8, .cohesion = 1};
  const dem::CundallStrack sticky{.normal_stiffness = 1e4, .tangential_stiffness = 1e4,
                                  .friction_angle = 0.2, .cohesion = 5};
  const dem::Materials<dem::CundallStrack> materials{rough, sticky};
  for (const auto& [a, b] : {std::pair{0u, 1u}, std::pair{1u, 0u}}) {
    const Vec<2> force = after_sliding(materials.between(a, b), 0.01, 1);
    EXPECT_NEAR(force[0], -(100 * std::tan(0.2) + 1), 1e-9);
  }
  EXPECT_NEAR(after_sliding(materials.between(0, 0), 0.01, 1)[0], -(100 * std::tan(0.8) + 1), 1e-9);
  EXPECT_NEAR(after_sliding(materials.between(1, 1), 0.01, 1)[0], -(100 * std::tan(0.2) + 5), 1e-9);
}

TEST(Friction, OfTwoMaterialsTheSpringsActInSeriesAndTheLowerRestitutionCounts) {
  const dem::CundallStrack stiff{.normal_stiffness = 3e4, .restitution = 0.9};
  const dem::CundallStrack soft{.normal_stiffness = 1e4, .restitution = 0.5};
  const auto mixed = dem::CundallStrack::mix(stiff, soft);
  // Each grain's own spring is twice its pair's: two in series.
  EXPECT_DOUBLE_EQ(mixed.normal_stiffness, 1 / (1 / (2 * 3e4) + 1 / (2 * 1e4)));
  EXPECT_EQ(mixed.restitution.value, 0.5);
  EXPECT_DOUBLE_EQ(dem::CundallStrack::mix(stiff, stiff).normal_stiffness, 3e4);
}

TEST(Friction, HoldsAGrainThatCannotTurnAtRestOnASlopeForGood) {
  const double theta = 0.3;
  auto sim = on_floor<2>({dem::Shape::natural, 0.5}, {.mu = 1, .theta = theta}, 0);
  sim.particles()[inertia][0] *= 1e12;
  sim.run({.until = 0.5, .time_step = 1e-5});
  const double settled = sim.particles()[position][0][0];
  const double stretch = sim.particles()[mass][0] * g * std::sin(theta) / 0.8e5;
  EXPECT_NEAR(settled, stretch, 1e-3 * stretch) << "the tangential spring carries its weight";
  sim.run({.until = 1.0, .time_step = 1e-5});
  EXPECT_NEAR(sim.particles()[position][0][0], settled, 1e-6 * stretch);
}

}  // namespace
}  // namespace silt::test
