// SPDX-License-Identifier: MIT
// A rigid body that moves: its state, and the load on it.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/orientation.hpp>
#include <silt/geometry/rigid_motion.hpp>

namespace silt {

/// Position and motion of a rigid body.
template <int Dim>
struct BodyState {
  Pose<Dim> pose;                                     ///< from where the body is defined
  Vec<Dim> position = Vec<Dim>::Zero();               ///< of the centre of mass [m]
  Orientation<Dim> orientation;                       ///< angle, or unit quaternion
  /// Of the centre of mass [m/s], with which the body moves next. Of one that lies on something it
  /// includes Δt g, which the contact takes away at the beginning of the next step.
  Vec<Dim> velocity = Vec<Dim>::Zero();
  AngularVec<Dim> spin = zero_of<AngularVec<Dim>>();  ///< [1/s]
};

/// Force on a body [N] and torque about its centre of mass [N m]; in 2D per metre of depth.
template <int Dim>
struct BodyLoad {
  Vec<Dim> force = Vec<Dim>::Zero();                    ///< [N]
  AngularVec<Dim> torque = zero_of<AngularVec<Dim>>();  ///< [N m]
};

}  // namespace silt
