// SPDX-License-Identifier: MIT
// The collision model of MPS: pairs closer than a l0 that approach exchange momentum with
// restitution b, the last-but-one column of [HwangLeePark2010] Table 1.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>

namespace silt::mps {

/// A pair of close particles, as input of a collision model; vectors are those for particle i. At a
/// smooth wall, r_ij and u_ij are projected onto the wall's normal.
template <int Dim, class RealType = double>
struct CollidingPair {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  Vec r_ij = Vec::Zero();  ///< [m]
  Real r = 0;              ///< |r_ij| [m]
  Vec u_ij = Vec::Zero();  ///< u_j − u_i [m/s]
  bool wall = false;       ///< j is a wall or dummy particle, not moved by collisions
  bool image = false;      ///< j is the image of a particle in a wall, see AddsImages
  Real spacing = 0;        ///< l0 [m]
  Real time_step = 0;      ///< Δt [s]

  /// Positive while the two approach [m/s].
  Real approach_speed() const { return -u_ij.dot(r_ij) / r; }
  /// Change of the velocity of i [m/s] that increases the separation speed of the pair by `speed`
  /// [m/s]; the two have equal masses.
  Vec velocity_change(Real speed) const {
    return (-(wall ? Real(1) : Real(0.5)) * speed / r) * r_ij;
  }
};

/// Collisions with a and b of [HwangLeePark2010], Table 1; by default those that the paper adopts.
struct Collision {
  double distance = 1;       ///< a, in l0 [-]; 0: no collisions
  double restitution = 0.2;  ///< b [-] in [0, 1]

  /// Throws if a is negative or b outside [0, 1].
  void check() const {
    require_not_negative("Collision: distance", distance);
    require_between("Collision: restitution", restitution, {0, 1});
  }

  /// Interaction range in units of l0 [-].
  double reach() const { return distance; }

  template <int Dim, class Real>
  Vec<Dim, Real> velocity_change(const CollidingPair<Dim, Real>& pair) const {
    const Real speed = pair.approach_speed();
    if (!(speed > 0)) return Vec<Dim, Real>::Zero();
    return pair.velocity_change((1 + Real(restitution)) * speed);
  }
};

/// reach() is the interaction range in units of l0; velocity_change(pair) returns the change of the
/// velocity of i [m/s].
template <class C>
concept CollisionModel = requires(const C c, CollidingPair<2> in_2d, CollidingPair<3> in_3d) {
  { c.reach() } -> std::convertible_to<double>;
  { c.velocity_change(in_2d) } -> std::convertible_to<Vec<2>>;
  { c.velocity_change(in_3d) } -> std::convertible_to<Vec<3>>;
  c.check();
};

}  // namespace silt::mps
