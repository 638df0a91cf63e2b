// SPDX-License-Identifier: MIT
// Pairs that would end the step too close are kept apart: the dynamic stabilisation of Tsuruta,
// Khayyer and Gotoh (2013), and the same bounded by a collision.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/collision.hpp>

#include <algorithm>
#include <cmath>

namespace silt::mps {

/// How much faster [m/s] a pair must part to end the step no closer than `least` [m]: the part of
/// r_ij + Δt u_ij along r_ij has to grow until that length is reached.
template <int Dim, class Real>
Real speed_to_part(const CollidingPair<Dim, Real>& pair, Real least) {
  const Vec<Dim, Real> after = pair.r_ij + pair.time_step * pair.u_ij;
  const Real along = after.dot(pair.r_ij) / pair.r;
  const Real across2 = std::max(Real(0), after.squaredNorm() - squared(along));
  if (across2 >= squared(least)) return 0;
  return std::max(Real(0), std::sqrt(squared(least) - across2) - along) / pair.time_step;
}

/// Parts them by as much as it takes: momentum is kept, energy may grow.
struct DynamicStabilisation {
  double distance = 0.9;  ///< least distance after the step, in spacings [-]

  /// Throws if the distance is not in [0, 1].
  void check() const { require_between("DynamicStabilisation: distance", distance, {0, 1}); }

  /// At Courant numbers up to 0.25 a step brings no two closer by more than half a spacing.
  double reach() const { return distance + 0.5; }

  template <int Dim, class Real>
  Vec<Dim, Real> impulse(const CollidingPair<Dim, Real>& pair) const {
    return pair.parting(speed_to_part(pair, Real(distance) * pair.spacing));
  }
};

/// Parts them by as much as it takes, and by no more than a collision with restitution b would:
/// momentum is kept, no pair by itself gains energy, and pairs that stay apart anyway lose none.
struct KeepApart {
  double distance = 0.9;     ///< least distance after the step, in spacings [-]
  double restitution = 0.2;  ///< b [-] in [0, 1]

  /// Throws if the distance is not in [0, 1], or b is not.
  void check() const {
    require_between("KeepApart: distance", distance, {0, 1});
    require_between("KeepApart: restitution", restitution, {0, 1});
  }

  double reach() const { return distance + 0.5; }

  template <int Dim, class Real>
  Vec<Dim, Real> impulse(const CollidingPair<Dim, Real>& pair) const {
    const Real most = (1 + Real(restitution)) * std::max(Real(0), pair.approach());
    return pair.parting(std::min(most, speed_to_part(pair, Real(distance) * pair.spacing)));
  }
};

}  // namespace silt::mps
