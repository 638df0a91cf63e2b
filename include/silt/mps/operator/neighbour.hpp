// SPDX-License-Identifier: MIT
// A neighbour as the sums over the neighbours of a particle see it.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>

namespace silt::mps {

/// A neighbour j of particle i. The image of a particle in a wall, which a wall model may add to
/// the sums (see AddsImages in silt/mps/wall/walls.hpp), has the same members, but mirrored values.
/// Sums that take the velocity from velocity() are therefore right for both.
template <int Dim, class RealType>
struct Neighbour {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  static constexpr bool is_image = false;  ///< see ImageOfParticle

  Index index;              ///< of an owned or ghost particle
  const Vec& r_ij;          ///< [m]; a reference, because a copy would be made in memory
  Real weight;              ///< w [-]
  Real weight_over_square;  ///< w/r² [1/m²]

  /// Its kind, of the kinds of all particles.
  template <class Kinds>
  Kind kind(const Kinds& kinds) const {
    return kinds[index];
  }
  /// Its velocity [m/s], of the velocities u of all particles.
  template <class U>
  decltype(auto) velocity(const U& u) const {
    return u[index];
  }
};

}  // namespace silt::mps
