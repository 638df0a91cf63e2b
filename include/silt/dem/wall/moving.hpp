// SPDX-License-Identifier: MIT
// Moving walls: a wall in its initial position and a prescribed rigid-body motion.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <numbers>

namespace silt::dem {

/// Position of a rigid body: a point defined at X is now at x = rotation X + shift.
template <int Dim, class Real>
struct Pose {
  Eigen::Matrix<Real, Dim, Dim> rotation = Eigen::Matrix<Real, Dim, Dim>::Identity();
  Vec<Dim, Real> shift = Vec<Dim, Real>::Zero();  ///< [m]

  /// Where a point defined at X is [m].
  Vec<Dim, Real> x_of(const Vec<Dim, Real>& X) const { return multiply(rotation, X) + shift; }
  /// Where a point that is at x was defined [m].
  Vec<Dim, Real> X_of(const Vec<Dim, Real>& x) const {
    return multiply<Dim, Real>(rotation.transpose(), x - shift);
  }
};

/// Velocity of a rigid body: v(x) = linear + spin × (x − about).
template <int Dim, class Real>
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
concept WallMotion = requires(const M motion, double t) {
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
      const Real angle = Real(double(spin) * t);
      pose.rotation = rotation_by(angle);
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

/// A moving wall: Moving{Plane<3>{}, Vibration<3>{.amplitude = {0, 0, 1e-3}, .frequency = 50}}. Its
/// `motion`, a WallMotion, takes the `wall`, a WallAtRest, from its initial position: pose_at(t)
/// gives the position at time t. The velocity of its surface at a contact enters the contact's
/// relative velocity, its spin the relative spin. A law is evaluated with grain positions x^N and
/// velocities v^{N−½}; therefore the pose of the wall is that of t^N and its velocity that of t^N −
/// Δt/2, and springs follow the actual relative displacement.
template <class W, class M>
struct Moving {
  W wall;
  M motion;

  void check() {
    wall.check();
    if constexpr (requires { motion.check(); }) motion.check();
    if constexpr (requires { motion.period(); }) {
      const double period = motion.period();
      if (period > 0) return;  // false for NaN
      fail({"Moving: period = ", period,
            " s of the motion must be positive; give one, or infinity without vibration"});
    }
  }
};
template <class W, class M>
Moving(W, M) -> Moving<W, M>;

/// Whether W is a Moving wall.
template <class W>
inline constexpr bool is_moving = false;
template <class W, class M>
inline constexpr bool is_moving<Moving<W, M>> = true;

namespace detail {
template <class W, int Dim, class Real>
inline constexpr bool moves_as_wall = false;
template <class W, class M, int Dim, class Real>
inline constexpr bool moves_as_wall<Moving<W, M>, Dim, Real> =
    WallAtRest<W, Dim, Real> && WallMotion<M, Dim, Real>;
}  // namespace detail

/// A wall at rest or a moving wall.
template <class W, int Dim, class Real>
concept Wall = WallAtRest<W, Dim, Real> || detail::moves_as_wall<W, Dim, Real>;

}  // namespace silt::dem
