// SPDX-License-Identifier: MIT
// The free rotation of a body with three moments of inertia against Euler's solution by elliptic
// functions, to round-off of what is conserved and to second order of the orientation. No other
// test has a body that turns about more than one of its axes.
#include <silt/geometry/free_rotation.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

namespace silt::test::free_rotation_test {
namespace {

// [LandauLifshitz1976] §37: moments I1 < I2 < I3, M² > 2 E I2, ω2 = 0 at time 0.
class EulerTop {
 public:
  EulerTop(const Vec<3>& moments, const Vec<3>& spin) : I_(moments), spin_(spin) {
    const Vec<3> m = I_.cwiseProduct(spin);
    M_ = m.norm();
    const double twice_E = m.dot(spin);
    const double a = twice_E * I_[2] - M_ * M_, b = M_ * M_ - twice_E * I_[0];
    rate_ = std::sqrt((I_[2] - I_[1]) * b / I_.prod());
    k_ = std::sqrt((I_[1] - I_[0]) * a / ((I_[2] - I_[1]) * b));
    amplitude_of_2_ = std::sqrt(a / (I_[1] * (I_[2] - I_[1])));
  }
  double period() const { return 4 * std::comp_ellint_1(k_) / rate_; }
  Vec<3> momentum() const { return I_.cwiseProduct(spin_); }
  Vec<3> spin_at(double t) const {
    const double phi = amplitude(rate_ * t);
    const double s = std::sin(phi);
    return {spin_[0] * std::cos(phi), amplitude_of_2_ * s,
            spin_[2] * std::sqrt(1 - k_ * k_ * s * s)};
  }
  // The orientation, from the one at time 0 in which the axes of the body are those of space.
  Eigen::Matrix<double, 3, 3> orientation_at(double t) const {
    return frame(0).transpose() * frame(t);
  }

 private:
  // F(φ, k) = u
  double amplitude(double u) const {
    double phi = u;
    for (int i = 0; i < 100; ++i) {
      const double s = std::sin(phi);
      const double change = (u - std::ellint_1(k_, phi)) * std::sqrt(1 - k_ * k_ * s * s);
      phi += change;
      if (std::abs(change) < 1e-15 * (1 + std::abs(phi))) break;
    }
    return phi;
  }
  // From the body to a frame with M along its third axis, in which the line of nodes has turned by
  // φ: φ' = M (I1 ω1² + I2 ω2²)/(I1² ω1² + I2² ω2²).
  Eigen::Matrix<double, 3, 3> frame(double t) const {
    const Vec<3> m = I_.cwiseProduct(spin_at(t));
    const Vec<3> z = m.normalized();
    const Vec<3> x = Vec<3>(-z[1], z[0], 0).normalized();  // the line of nodes
    Eigen::Matrix<double, 3, 3> to_M;
    to_M << x, cross(z, x), z;
    const int pieces = 400;
    double phi = 0;
    for (int i = 0; i < pieces; ++i) {  // Simpson
      const double a = t * i / pieces, h = t / pieces;
      phi += h / 6 * (rate_at(a) + 4 * rate_at(a + h / 2) + rate_at(a + h));
    }
    return rotation_about(Vec<3>(Vec<3>::Unit(2)), phi) * to_M.transpose();
  }
  double rate_at(double t) const {
    const Vec<3> w = spin_at(t);
    const double a = I_[0] * w[0] * w[0], b = I_[1] * w[1] * w[1];
    return M_ * (a + b) / (I_[0] * a + I_[1] * b);
  }

  Vec<3> I_, spin_;
  double M_ = 0, rate_ = 0, k_ = 0, amplitude_of_2_ = 0;
};

const Vec<3> moments{1, 1.7, 2.2};
const Inertia<3> inverse = inverse_of(Inertia<3>(moments.asDiagonal()));

TEST(FreeRotation, HasTheOrientationOfEulersSolutionToSecondOrder) {
  const EulerTop top(moments, {0.9, 0, 1.3});
  const double end = 0.8 * top.period();
  double last = 0;
  for (const int steps : {100, 200, 400, 800}) {
    Orientation<3> now;
    for (int k = 0; k < steps; ++k)
      now = rotate_freely(now, top.momentum(), inverse, end / steps).end;
    const auto exact = top.orientation_at(end);
    const Eigen::Matrix<double, 3, 3> in_space = now.matrix();
    const double error = (in_space - exact).norm();
    if (last > 0) {
      EXPECT_NEAR(last / error, 4, 0.1) << steps;
    }
    last = error;
  }
  EXPECT_LT(last, 3e-4);
}

TEST(FreeRotation, KeepsMomentumAndEnergyFor100000Steps) {
  const Vec<3> M{0.3, 2, 0.4};
  Inertia<3> tilted;
  tilted << 1, 0.1, 0, 0.1, 2, 0.2, 0, 0.2, 3.5;
  const Inertia<3> inverse_of_tilted = inverse_of(tilted);
  Orientation<3> now;
  const double energy = M.dot(inverse_of_tilted * M) / 2;
  for (int k = 0; k < 100000; ++k) {
    const FreeRotation<3> step = rotate_freely(now, M, inverse_of_tilted, 0.05);
    now = step.end;
    if (k % 1000 != 0) continue;
    const Vec<3> in_body = now.matrix().transpose() * M;
    EXPECT_NEAR(in_body.dot(inverse_of_tilted * in_body) / 2 / energy, 1, 1e-11) << k;
    EXPECT_NEAR(now.quaternion.norm(), 1, 1e-15);
  }
}

// Dzhanibekov's: about the middle axis, nearly; it flips after each half of a long period.
TEST(FreeRotation, FlipsAtThePeriodOfEulersSolution) {
  // M² > 2 E I2, and k near 1: ω2 is the largest most of the time.
  const double w1 =
      std::sqrt(moments[2] * (moments[2] - moments[1]) / (moments[0] * (moments[1] - moments[0])));
  const EulerTop top(moments, Vec<3>(0.999 * w1, 0, 1));
  Orientation<3> now;
  double last = 0, time = 0, last_crossing = 0;
  int crossings = 0;
  const double dt = top.period() / 20000;
  for (int k = 0; k < 69000; ++k) {
    now = rotate_freely(now, top.momentum(), inverse, dt).end;
    time += dt;
    const Vec<3> in_body = now.matrix().transpose() * top.momentum();
    const double w2 = in_body[1] / moments[1];
    if (last * w2 < 0) {
      const double crossing = time - dt * w2 / (w2 - last);
      if (crossings++ > 0) {
        EXPECT_NEAR((crossing - last_crossing) / (top.period() / 2), 1, 1e-5);
      }
      last_crossing = crossing;
    }
    last = w2;
  }
  EXPECT_EQ(crossings, 6);
}

// Thin needles with axes oblique to the frame: the equation is stiff.
TEST(FreeRotation, IsSolvedForNeedles) {
  const auto tilt = rotation_about(Vec<3>(Vec<3>(1, 2, -1).normalized()), 0.7);
  for (const double ratio : {10.0, 1e2, 1e3, 1e4}) {
    const Vec<3> axes{1, ratio, ratio};
    const Inertia<3> needle = tilt * Inertia<3>(axes.asDiagonal()) * tilt.transpose();
    const Inertia<3> inverse_of_needle = inverse_of(needle);
    for (int k = 0; k < 200; ++k) {
      const Vec<3> w = Vec<3>(std::sin(k), std::cos(2.0 * k), std::sin(3.0 * k + 1)).normalized();
      const Vec<3> M = needle * w;
      const FreeRotation<3> step = rotate_freely(Orientation<3>{}, M, inverse_of_needle, 0.3);
      const Vec<3> before = M, after = step.end.matrix().transpose() * M;
      EXPECT_NEAR(after.dot(inverse_of_needle * after) / before.dot(inverse_of_needle * before), 1,
                  1e-9 * ratio)
          << ratio << " " << k;
    }
  }
}

}  // namespace
}  // namespace silt::test::free_rotation_test
