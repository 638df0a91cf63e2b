// SPDX-License-Identifier: MIT
// What grains do to walls.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem {

/// A contact of a grain with a wall, as the wall sees it, at the time of the contact, N. What the
/// wall does to the grain in a step is the work −(force·velocity + couple·spin) Δt [J].
template <int Dim, class Real>
struct WallContact {
  Index grain = no_index;  ///< its place, now
  Index wall = no_index;   ///< its number
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();      ///< where the force takes hold [m]
  Vec<Dim, Real> velocity = Vec<Dim, Real>::Zero();   ///< of the wall there [m/s]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();  ///< of the wall [1/s]
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();      ///< on the wall [N]
  AngularVec<Dim, Real> couple = zero_of<AngularVec<Dim, Real>>();  ///< on the wall, beside the force's [N m]
};

/// Sum over the grains that touch a wall.
template <int Dim, class Real>
struct WallLoad {
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();        ///< [N]
  AngularVec<Dim, Real> moment = zero_of<AngularVec<Dim, Real>>();  ///< about the point asked for [N m]
};

}  // namespace silt::dem
