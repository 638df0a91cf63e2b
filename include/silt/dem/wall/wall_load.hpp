// SPDX-License-Identifier: MIT
// Forces of grains on walls.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem {

/// The load of one contact on a wall, at the time N of the contact. The work of the wall on the
/// grain in a step is −(force·velocity + couple·spin) Δt [J].
template <int Dim, class Real>
struct WallContact {
  Index grain = no_index;                                           ///< current index of the grain
  Index wall = no_index;                                            ///< number of the wall
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();                    ///< contact point [m]
  Vec<Dim, Real> velocity = Vec<Dim, Real>::Zero();                 ///< of the wall there [m/s]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();    ///< of the wall [1/s]
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();                    ///< on the wall [N]
  AngularVec<Dim, Real> couple = zero_of<AngularVec<Dim, Real>>();  ///< on the wall [N m], in
                                                                    ///< addition to the moment of
                                                                    ///< the force
};

/// Sum over all contacts of a wall.
template <int Dim, class Real>
struct WallLoad {
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();                    ///< [N]
  AngularVec<Dim, Real> torque = zero_of<AngularVec<Dim, Real>>();  ///< about the given point [N m]
};

}  // namespace silt::dem
