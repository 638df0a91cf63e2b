// SPDX-License-Identifier: MIT
// The collision model of MPS: pairs closer than a l0 that approach exchange momentum with
// restitution b, the last-but-one column of [HwangLeePark2010] Table 1.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <ratio>

namespace silt::mps {

/// Two particles near each other, as the first sees it. At a smooth wall r_ij and u_ij are what
/// lies along the wall's normal.
template <int Dim, class RealType = double>
struct CollidingPair {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  Vec r_ij = Vec::Zero();  ///< [m]
  Real r = 0;              ///< |r_ij| [m]
  Vec u_ij = Vec::Zero();  ///< u_j − u_i [m/s]
  bool wall = false;       ///< j stays where it is
  Real spacing = 0;        ///< l0 [m]
  Real time_step = 0;      ///< Δt [s]

  /// Speed at which they come closer [m/s].
  Real approach() const { return -u_ij.dot(r_ij) / r; }
  /// Change of the velocity of i [m/s] if the two, of equal mass, are to part by so much faster.
  Vec parting(Real speed) const { return (-(wall ? Real(1) : Real(0.5)) * speed / r) * r_ij; }
};

/// a and b of Table 1, as ratios so that a case is a type: Collision<std::ratio<1>,
/// std::ratio<1, 5>>.
template <class A, class B>
struct Collision {
  double distance = double(A::num) / double(A::den);     ///< a, in spacings [-]; 0: no collisions
  double restitution = double(B::num) / double(B::den);  ///< b [-] in [0, 1]

  /// Throws if a is negative or b outside [0, 1].
  void check() const {
    require_not_negative("Collision: distance", distance);
    require_between("Collision: restitution", restitution, {0, 1});
  }

  double reach() const { return distance; }

  template <int Dim, class Real>
  Vec<Dim, Real> impulse(const CollidingPair<Dim, Real>& pair) const {
    const Real approach = pair.approach();
    if (!(approach > 0)) return Vec<Dim, Real>::Zero();
    return pair.parting((1 + Real(restitution)) * approach);
  }
};

/// The original's (0.5, 0.2) and the adopted (1.0, 0.2).
using OriginalCollision = Collision<std::ratio<1, 2>, std::ratio<1, 5>>;
using AdoptedCollision = Collision<std::ratio<1>, std::ratio<1, 5>>;

/// reach(): pairs farther apart [spacings] do not meet; impulse(pair): change of the velocity
/// of i [m/s].
template <class C>
concept CollisionModel = requires(const C c, CollidingPair<2> in_2d, CollidingPair<3> in_3d) {
  { c.reach() } -> std::convertible_to<double>;
  { c.impulse(in_2d) } -> std::convertible_to<Vec<2>>;
  { c.impulse(in_3d) } -> std::convertible_to<Vec<3>>;
  c.check();
};

}  // namespace silt::mps
