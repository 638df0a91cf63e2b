// SPDX-License-Identifier: MIT
// Moving walls: a wall in its initial position and a prescribed rigid-body motion.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>
#include <silt/geometry/combined_motion.hpp>
#include <silt/geometry/rigid_motion.hpp>

namespace silt::dem {

using silt::CombinedMotion;
using silt::Pose;
using silt::RigidMotion;
using silt::RigidVelocity;
using silt::Rotation;
using silt::Translation;
using silt::Vibration;

/// A moving wall: Moving{Plane<3>{}, Vibration<3>{.amplitude = {0, 0, 1e-3}, .frequency = 50}}. Its
/// `motion`, a RigidMotion, takes the `wall`, a WallAtRest, from its initial position: pose_at(t)
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
    WallAtRest<W, Dim, Real> && RigidMotion<M, Dim, Real>;
}  // namespace detail

/// A wall at rest or a moving wall.
template <class W, int Dim, class Real>
concept Wall = WallAtRest<W, Dim, Real> || detail::moves_as_wall<W, Dim, Real>;

}  // namespace silt::dem
