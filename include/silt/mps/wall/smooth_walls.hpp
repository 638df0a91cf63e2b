// SPDX-License-Identifier: MIT
// Walls of particles along which fluid slips.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/policy/collision.hpp>
#include <silt/mps/wall/wall_normals.hpp>

#include <algorithm>

namespace silt::mps {

/// Walls along which fluid slips, except for viscosity: only the component along the wall's normal
/// of the velocity relative to a wall or dummy particle enters the divergence, and, for wall
/// particles, collisions. Wall particles without fluid neighbours, or on the free surface, are
/// excluded from the pressure solve. A wall particle has a normal if there are dummies behind it,
/// on one side.
struct SmoothWalls {
  template <int Dim, class RealType>
  class InFlow;
};

template <int Dim, class RealType>
class SmoothWalls::InFlow {
 public:
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  explicit InFlow(const SmoothWalls&) {}

  /// Finds the normals of the walls.
  template <FluidParticles P, class Operators>
  void find(const P& particles, const Operators& operators) {
    normals_.find(particles, operators.neighbourhood(), operators.stencil());
  }

  /// ⟨∇·u⟩_i [1/s] with slip along walls: a wall or dummy particle j enters with its own velocity
  /// component along its normal, and with that of i tangentially. If i is a wall particle, its
  /// tangential velocity is the mean of the fluid around it.
  template <class View, class U>
  Real divergence(const View& at, const U& u) const {
    const auto kinds = at.kinds();
    const Vec own = at.kind() == Kind::wall ? slipping(at, u) : Vec(u[at.index()]);
    Real sum = 0;
    at.for_each([&](const auto& j) {
      const Vec u_ij = j.velocity(u) - own;
      if (j.kind(kinds) == Kind::fluid) {
        sum += j.weight_over_square * u_ij.dot(j.r_ij);
      } else {
        const Vec& normal = normals_[at.owner(j)];
        sum += j.weight_over_square * u_ij.dot(normal) * normal.dot(j.r_ij);
      }
    });
    return Dim / at.stencil().n0 * sum;
  }

  template <class View>
  bool is_dry(const View& at) const {
    if (at.kind() != Kind::wall) return false;
    const auto kinds = at.kinds();
    return !at.any([&](const auto& j) { return j.kind(kinds) == Kind::fluid; });
  }
  bool has_pressure(Kind of_kind, bool on_surface) const {
    return of_kind == Kind::fluid || (of_kind == Kind::wall && !on_surface);
  }

  template <class Pairs, class CollisionModel>
  Vec velocity_change(const Pairs& pairs, const CollisionModel& collision) const {
    Vec change = Vec::Zero();
    Vec by_walls = Vec::Zero();
    pairs.for_each([&](CollidingPair<Dim, Real> pair, Index j) {
      if (!pair.wall) {
        change += collision.velocity_change(pair);
        return;
      }
      const Vec& normal = normals_[pairs.owner(j)];
      if (pairs.kind(j) == Kind::dummy || !project_onto_normal(pair, normal)) return;
      // Several particles form one wall: only the largest change along each normal is used.
      const Vec by_wall = collision.velocity_change(pair);
      by_walls += std::max(Real(0), normal.dot(by_wall - by_walls)) * normal;
    });
    return change + by_walls;
  }

 private:
  // The velocity of a wall particle with the mean tangential velocity of the fluid around it.
  template <class View, class U>
  Vec slipping(const View& at, const U& u) const {
    const auto kinds = at.kinds();
    Vec mean = Vec::Zero();
    Real weight = 0;
    at.for_each([&](const auto& j) {
      if (j.kind(kinds) != Kind::fluid) return;
      mean += j.weight * j.velocity(u);
      weight += j.weight;
    });
    if (weight > 0) mean /= weight;
    const Vec& normal = normals_[at.index()];
    return mean + normal.dot(u[at.index()] - mean) * normal;
  }

  // Projects a pair with a wall particle onto the wall's normal. False if the fluid particle is
  // behind the wall, or laterally closer to another wall particle.
  static bool project_onto_normal(CollidingPair<Dim, Real>& pair, const Vec& normal) {
    const Vec along = normal.dot(pair.r_ij) * normal;
    const Real across2 = (pair.r_ij - along).squaredNorm();
    if (across2 > Real(0.2501) * (Dim - 1) * squared(pair.spacing)) return false;
    if (!(normal.dot(pair.r_ij) < 0)) return false;
    pair.r_ij = along;
    pair.r = along.norm();
    pair.u_ij = normal.dot(pair.u_ij) * normal;
    return true;
  }

  WallNormals<Dim, Real> normals_;
};

}  // namespace silt::mps
