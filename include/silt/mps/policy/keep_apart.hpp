// SPDX-License-Identifier: MIT
// Collision models that keep a minimum distance at the end of the step: the dynamic stabilisation
// of [TsurutaKhayyerGotoh2013], and a variant limited to the impulse of a collision.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/collision.hpp>

#include <algorithm>
#include <cmath>

namespace silt::mps {

/// The increase in separation speed [m/s] that keeps a pair at least min_distance [m] apart at the
/// end of the step: the component of r_ij + Δt u_ij along r_ij grows until its length reaches
/// min_distance.
template <int Dim, class Real>
[[gnu::always_inline]] inline Real required_speed(const CollidingPair<Dim, Real>& pair,
                                                  Real min_distance) {
  const Vec<Dim, Real> after = pair.r_ij + pair.time_step * pair.u_ij;
  const Real after2 = after.squaredNorm();
  const Real after_dot = after.dot(pair.r_ij);
  // Most pairs stay clearly apart: the result below would be 0 at any rounding (of pairs further
  // apart than 10 min_distance, across2 is rounded).
  const Real min2 = squared(min_distance);
  if (after_dot > 0 && after2 > Real(1.001) * min2 && after2 < 100 * min2) return 0;
  const Real along = after_dot / pair.r;
  const Real across2 = std::max(Real(0), after2 - squared(along));
  if (across2 >= min2) return 0;
  return std::max(Real(0), std::sqrt(min2 - across2) - along) / pair.time_step;
}

/// Separates the pair by exactly the required speed [TsurutaKhayyerGotoh2013]: conserves momentum,
/// may increase the energy.
struct DynamicStabilisation {
  double distance = 0.9;  ///< minimum distance after the step, in units of l0 [-]

  /// Throws if the distance is not in [0, 1].
  void check() const { require_between("DynamicStabilisation: distance", distance, {0, 1}); }

  /// Interaction range in units of l0 [-]: at Courant numbers up to 0.25, a pair approaches by at
  /// most half a spacing in a step.
  double reach() const { return distance + 0.5; }

  template <int Dim, class Real>
  Vec<Dim, Real> velocity_change(const CollidingPair<Dim, Real>& pair) const {
    return pair.velocity_change(required_speed(pair, Real(distance) * pair.spacing));
  }
};

/// Separates the pair by the required speed, but not by more than a collision with restitution b
/// would: conserves momentum; an isolated pair never gains energy, and a pair that stays far enough
/// apart loses none.
struct KeepApart {
  double distance = 0.9;     ///< minimum distance after the step, in units of l0 [-]
  double restitution = 0.2;  ///< b [-] in [0, 1]
  /// Minimum distance of particles and images in walls, in units of l0 [-]. At a smaller one, fluid
  /// is stopped at a wall by its pressure instead; that needs a surface such as OuterSurface,
  /// without which the energy rises in impacts.
  double image_distance = 0.9;

  /// Throws if a distance or b is not in [0, 1].
  void check() const {
    require_between("KeepApart: distance", distance, {0, 1});
    require_between("KeepApart: restitution", restitution, {0, 1});
    require_between("KeepApart: image_distance", image_distance, {0, 1});
  }

  double reach() const { return std::max(distance, image_distance) + 0.5; }

  template <int Dim, class Real>
  Vec<Dim, Real> velocity_change(const CollidingPair<Dim, Real>& pair) const {
    const Real approach_speed = pair.approach_speed();
    if (!(approach_speed > 0)) return Vec<Dim, Real>::Zero();
    const Real max_speed = (1 + Real(restitution)) * approach_speed;
    const Real min_distance = Real(pair.image ? image_distance : distance) * pair.spacing;
    return pair.velocity_change(std::min(max_speed, required_speed(pair, min_distance)));
  }
};

}  // namespace silt::mps
