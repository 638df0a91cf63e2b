// SPDX-License-Identifier: MIT
// Partial slip: the force and the loss of a contact under a constant load, which have closed forms,
// and oblique impacts beside finite elements and a measurement. No other test has a contact whose
// rim slips while its centre sticks.
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>

#include "support/oblique_impacts.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace silt::test::partial_slip_test {
namespace {

const dem::Elastic glass{.young_modulus = 70e9, .poisson_ratio = 0.25};
const dem::MindlinDeresiewicz slipping{.elastic = glass, .friction_angle = 0.3};

static_assert(dem::LawInLanes<dem::Law<dem::Hertz, dem::MindlinDeresiewicz>, 3, double>);

// A contact under a constant load F_n, which is sheared in the direction of the angle `along`.
template <int Dim>
class Sheared {
  using Contact = dem::Contact<Dim, double>;

 public:
  explicit Sheared(double along = 0) {
    contact_.normal = Vec<Dim>::Unit(Dim - 1);
    contact_.overlap = 1e-6;
    contact_.effective_radius = 1e-3;
    contact_.effective_mass = 1e-5;
    contact_.time_step = 1e-7;
    direction_[0] = std::cos(along);
    if (Dim == 3) direction_[1] = std::sin(along);
    // The first contact, so that the area is that of F_n.
    move(0);
  }

  // Shears by this displacement [no-slip displacement at the largest friction]; returns the
  // friction [F_n tan φ] against it.
  double shear(double displacement) {
    const int steps = 200;
    for (int step = 0; step < steps; ++step) move(displacement / steps);
    return force;
  }

  double force = 0;  // [F_n tan φ]
  double work = 0;   // of the displacement [F_n tan φ times the unit of displacement]
  double friction = 0;

 private:
  void move(double displacement) {
    const double k = slipping.stiffness(contact_, {}).tangential;
    contact_.relative_velocity = direction_ * (displacement * limit / k / contact_.time_step);
    const dem::NormalForce<Contact> normal{.spring = limit / std::tan(0.3)};
    const auto t = slipping.tangential_force(contact_, normal, history_);
    const double before = force;
    force = -t.spring.dot(direction_) / limit;
    EXPECT_NEAR((t.spring + force * limit * direction_).norm(), 0, 1e-12 * limit);
    work += (before + force) / 2 * displacement;
    friction += t.friction * k / squared(limit);
    EXPECT_NEAR(slipping.elastic_energy(contact_, history_) * k / squared(limit), work - friction,
                1e-9);
  }

  static constexpr double limit = 2;  // [N]
  Contact contact_;
  Vec<Dim> direction_ = Vec<Dim>::Zero();
  typename dem::MindlinDeresiewicz::History<Dim, double> history_;
};

// Displacement at which the friction has risen from 0 to f, both in the units above; Cattaneo and
// Mindlin.
double displacement_at(double f) { return 1.5 * (1 - std::cbrt(squared(1 - f))); }
// Mindlin and Deresiewicz (1953): from the turn at f_max, the curve has twice the size.
double displacement_after_turn(double f, double f_max) {
  return 2 * displacement_at((f_max - f) / 2);
}

template <int Dim>
void expect_the_curves(double along) {
  for (const double f_max : {0.3, 0.6, 0.9}) {
    Sheared<Dim> contact(along);
    EXPECT_NEAR(contact.shear(displacement_at(f_max)), f_max, 0.006);
    double moved = 0;
    for (const double f : {0.5 * f_max, 0.0, -0.5 * f_max, -f_max}) {
      const double to = displacement_after_turn(f, f_max);
      EXPECT_NEAR(contact.shear(moved - to), f, 0.008) << f_max;
      moved = to;
    }
    // Back to the first turn, and on along the first curve.
    EXPECT_NEAR(contact.shear(moved), f_max, 0.008);
    EXPECT_NEAR(contact.shear(1.6 - displacement_at(f_max)), 1, 1e-12);
  }
}

TEST(MindlinDeresiewicz, FollowsTheClosedFormsUnderAConstantLoad) {
  expect_the_curves<2>(0);
  expect_the_curves<3>(0);
  expect_the_curves<3>(1);
}

// In smaller loops, only the outermost spring slips.
TEST(MindlinDeresiewicz, LosesTheEnergyOfAClosedLoop) {
  for (const double f : {0.7, 0.9}) {
    Sheared<3> contact;
    contact.shear(displacement_at(f));
    const double before = contact.friction;
    const double width = displacement_after_turn(-f, f);
    contact.shear(-width);
    contact.shear(width);
    // Twice the area between the curve of the unloading and its chord.
    const int parts = 2000;
    double area = 0;
    for (int p = 0; p < parts; ++p) {
      const double from = f - 2 * f * p / parts, to = f - 2 * f * (p + 1) / parts;
      area += (from + to) / 2 * (displacement_after_turn(to, f) - displacement_after_turn(from, f));
    }
    EXPECT_NEAR((contact.friction - before) / (-2 * area), 1, 0.04) << f;
  }
}

// A grain that is pressed, sheared and released on any path loses energy, and never gains it.
TEST(MindlinDeresiewicz, LosesEnergyOnEveryPathOfLoading) {
  for (const double v : {0.05, 0.1, 0.3, 0.6, 1.0}) {
    ObliqueBodies elastic{
        "glass", {.R = 2.5e-3, .density = 2500, .elastic = glass}, {.elastic = glass}, 1, 0.1};
    const double I = 0.4 * squared(elastic.sphere.R);
    const auto energy = [&](const ObliqueMotion& m) {
      return squared(m.v) + squared(m.v_n) + I * squared(m.spin);
    };
    const ObliqueMotion before{.v = v, .v_n = 1, .spin = 0};
    const auto after = bounce(elastic, before, ImpactForm::partial_slip);
    EXPECT_LE(energy(after), energy(before) * (1 + 1e-4)) << v;
  }
}

// Test 5 of Chung and Ooi (2011), for which they give finite elements of Wu, Li and Thornton.
TEST(MindlinDeresiewicz, ReboundsAsFiniteElements) {
  constexpr double of_elements[][2] = {{0.272, -0.027}, {0.876, -0.08}, {1.553, -0.373},
                                       {2.314, -0.947}, {3.317, -1.52}, {4.755, -1.707},
                                       {5.758, -1.2},   {7.124, 0.133}};
  const ObliqueBodies steel{"steel", {1e-5, 7850, {208e9, 0.3}}, {.elastic = {1e30, 0}}, 1, 0.3};
  for (const auto& [before, expected] : of_elements) {
    const double v_n = 5;
    const auto after = bounce(steel, {.v = before * steel.friction * v_n, .v_n = v_n, .spin = 0},
                              ImpactForm::partial_slip);
    const double rebound = (after.v - steel.sphere.R * after.spin) / (steel.friction * after.v_n);
    EXPECT_NEAR(rebound, expected, 0.11) << before;
  }
}

// Aluminium oxide on glass at 3.9 m/s, measured by Kharaz, Gorham and Salman (2001), as digitised
// by the project Lethe: angle [°] and spin after the impact [1/s].
TEST(MindlinDeresiewicz, SpinsAsMeasured) {
  constexpr double measured[][2] = {{10.991, 265.69}, {21.251, 577.65}, {31.157, 612.88}};
  const ObliqueBodies spheres{
      "aluminium oxide", {2.5e-3, 4000, {380e9, 0.23}}, {.elastic = glass}, 0.98, 0.092};
  for (const auto& [degrees, expected] : measured) {
    const double angle = degrees * std::numbers::pi / 180;
    const ObliqueMotion before{.v = 3.9 * std::sin(angle), .v_n = 3.9 * std::cos(angle), .spin = 0};
    const auto after = bounce(spheres, before, ImpactForm::partial_slip);
    EXPECT_NEAR(after.spin / expected, 1, 0.07) << degrees;
  }
}

}  // namespace
}  // namespace silt::test::partial_slip_test
