// SPDX-License-Identifier: MIT
// The collision model of MPS: pairs closer than a l0 that approach exchange momentum with
// restitution b, the last-but-one column of [HwangLeePark2010] Table 1.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <ratio>

namespace silt::mps {

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

  /// Change of the velocity of i [m/s] by j, for equal masses; `wall`: j stays where it is.
  template <class Vec, class Real>
  Vec impulse(const Vec& r_ij, Real r, const Vec& u_ij, bool wall) const {
    const Real approach = -u_ij.dot(r_ij) / r;  // u_ij = u_j − u_i
    if (!(approach > 0)) return Vec::Zero();
    const Real share = wall ? Real(1) : Real(0.5);
    return (-(1 + Real(restitution)) * share * approach / r) * r_ij;
  }
};

/// The original's (0.5, 0.2) and the adopted (1.0, 0.2).
using OriginalCollision = Collision<std::ratio<1, 2>, std::ratio<1, 5>>;
using AdoptedCollision = Collision<std::ratio<1>, std::ratio<1, 5>>;

template <class C>
concept CollisionModel = requires(const C c, Vec<2> v, double r, bool wall) {
  { c.distance } -> std::convertible_to<double>;
  { c.impulse(v, r, v, wall) } -> std::convertible_to<Vec<2>>;
  c.check();
};

}  // namespace silt::mps
