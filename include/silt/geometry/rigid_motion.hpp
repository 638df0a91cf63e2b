// SPDX-License-Identifier: MIT
// Prescribed motions of rigid bodies, as functions of time.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

namespace silt {

/// Position of a rigid body: a point defined at X is now at x = rotation X + shift.
template <int Dim, class Real = double>
struct Pose {
  Eigen::Matrix<Real, Dim, Dim> rotation = Eigen::Matrix<Real, Dim, Dim>::Identity();
  Vec<Dim, Real> shift = Vec<Dim, Real>::Zero();  ///< [m]

  /// Where a point defined at X is [m].
  Vec<Dim, Real> x_of(const Vec<Dim, Real>& X) const { return multiply(rotation, X) + shift; }
  /// Where a point that is at x was defined [m].
  Vec<Dim, Real> X_of(const Vec<Dim, Real>& x) const {
    return multiply<Dim, Real>(rotation.transpose(), x - shift);
  }
  /// X → this(first(X))
  Pose after(const Pose& first) const {
    Pose both{.shift = x_of(first.shift)};
    for (int k = 0; k < Dim; ++k) {
      both.rotation.col(k) = multiply<Dim, Real>(rotation, first.rotation.col(k));
    }
    return both;
  }
  /// x → X
  Pose inverse() const {
    Pose back{.rotation = rotation.transpose()};
    back.shift = -multiply<Dim, Real>(back.rotation, shift);
    return back;
  }
};

/// Velocity of a rigid body: v(x) = linear + spin × (x − about).
template <int Dim, class Real = double>
struct RigidVelocity {
  Vec<Dim, Real> linear = Vec<Dim, Real>::Zero();                 ///< [m/s]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();  ///< [1/s]
  Vec<Dim, Real> about = Vec<Dim, Real>::Zero();                  ///< [m]

  /// Velocity of its point at x [m/s].
  Vec<Dim, Real> at(const Vec<Dim, Real>& x) const {
    return linear + cross(spin, Vec<Dim, Real>(x - about));
  }
};

/// motion.pose_at(t) and its time derivative motion.velocity_at(t), functions of the time t [s]
/// only. Optional: check(), which throws if a parameter is out of range, and period() [s], if the
/// motion is periodic: time steps must be shorter. It is above 0, infinite without vibration.
template <class M, int Dim, class Real>
concept RigidMotion = requires(const M motion, double t) {
  { motion.pose_at(t) } -> std::same_as<Pose<Dim, Real>>;
  { motion.velocity_at(t) } -> std::same_as<RigidVelocity<Dim, Real>>;
};

/// At constant velocity: x = X + V t.
template <int Dim, class Real = double>
struct Translation {
  Vec<Dim, Real> velocity = Vec<Dim, Real>::Zero();  ///< V [m/s]

  void check() const { require_finite("Translation: velocity", velocity); }
  Pose<Dim, Real> pose_at(double t) const { return {.shift = velocity * Real(t)}; }
  RigidVelocity<Dim, Real> velocity_at(double) const { return {.linear = velocity}; }
};

/// About an axis (3D) or a point (2D), at constant spin.
template <int Dim, class Real = double>
struct Rotation {
  Vec<Dim, Real> about = Vec<Dim, Real>::Zero();  ///< the point, or any point of the axis [m]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();  ///< ω [1/s]; in 3D along the axis

  void check() const {
    require_finite("Rotation: about", about);
    require_finite("Rotation: spin", spin);
    if (is_finite(squared_norm(spin))) return;
    fail({"Rotation: spin = ", to_text(spin), " 1/s has an infinite square; give a lower one"});
  }
  Pose<Dim, Real> pose_at(double t) const {
    Pose<Dim, Real> pose;
    if constexpr (Dim == 2) {
      const Real turn = Real(double(spin) * t);
      pose.rotation = rotation_by(turn);
    } else {
      const Vec<3> rate = in_double(spin);
      if (rate.norm() > 0) {
        const Vec<3> axis = rate.normalized();
        pose.rotation = rotation_about(axis, rate.norm() * t).template cast<Real>();
      }
    }
    pose.shift = about - multiply(pose.rotation, about);
    return pose;
  }
  RigidVelocity<Dim, Real> velocity_at(double) const { return {.spin = spin, .about = about}; }
};

/// Harmonic: x = X + A sin(2π f t + φ).
template <int Dim, class Real = double>
struct Vibration {
  Vec<Dim, Real> amplitude = Vec<Dim, Real>::Zero();  ///< A [m]
  double frequency = 0;                               ///< f [Hz]
  double phase = 0;                                   ///< φ [rad]

  void check() const {
    require_finite("Vibration: amplitude", amplitude);
    require_not_negative("Vibration: frequency", frequency);
    require_finite("Vibration: phase", phase);
  }
  Pose<Dim, Real> pose_at(double t) const {
    return {.shift = amplitude * Real(std::sin(omega() * t + phase))};
  }
  RigidVelocity<Dim, Real> velocity_at(double t) const {
    return {.linear = amplitude * Real(omega() * std::cos(omega() * t + phase))};
  }

  double period() const {
    const bool moves = frequency > 0 && amplitude.squaredNorm() > 0;
    return moves ? 1 / frequency : std::numeric_limits<double>::infinity();
  }

 private:
  double omega() const { return 2 * std::numbers::pi * frequency; }
};

}  // namespace silt
