// SPDX-License-Identifier: MIT
// A wall whose surface moves along itself, while the wall stays: a conveyor belt, a turning roll.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/rigid_motion.hpp>

namespace silt::dem {

/// For Moving{wall, SurfaceVelocity<3>{.linear = {1, 0, 0}}}: the surface has this velocity, which
/// should be along it, but no point of the wall moves. The only motion whose velocity is not the
/// derivative of its pose; not for walls of a flow.
template <int Dim, class Real = double>
struct SurfaceVelocity {
  Vec<Dim, Real> linear = Vec<Dim, Real>::Zero();                 ///< [m/s]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();  ///< [1/s]; of a round wall
  Vec<Dim, Real> about = Vec<Dim, Real>::Zero();                  ///< a point of its axis [m]

  /// Throws if a velocity is not finite.
  void check() const {
    require_finite("SurfaceVelocity: linear", linear);
    require_finite("SurfaceVelocity: spin", spin);
    require_finite("SurfaceVelocity: about", about);
  }
  /// See RigidMotion.
  Pose<Dim, Real> pose_at(double) const { return {}; }
  /// See RigidMotion.
  RigidVelocity<Dim, Real> velocity_at(double) const {
    return {.linear = linear, .spin = spin, .about = about};
  }
};

}  // namespace silt::dem
