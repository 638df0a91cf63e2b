// SPDX-License-Identifier: MIT
// What fluid feels of walls made of particles.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/operators.hpp>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <utility>
#include <vector>

namespace silt::mps {

/// Every particle of a wall as it stands, at rest: what the paper's schemes see. Fluid that slides
/// along it feels every one, and is slowed. Wall particles on the free surface have P = 0.
struct GrainyWalls {
  static constexpr bool smooth = false;
};

/// Walls along which fluid slips, but for viscosity: of its velocity against a wall particle only the
/// part along the wall's normal counts, in divergence (where dummies count, too) and collisions.
/// Wall particles that no fluid touches, or that lie on the free surface, take no part in the
/// pressure. A wall has a normal if dummies lie behind it, on one side.
struct SmoothWalls {
  static constexpr bool smooth = true;
};

template <class W>
concept WallModel = requires {
  { W::smooth } -> std::convertible_to<bool>;
};

/// Unit normals of walls, out of their particles' places.
template <int Dim, class RealType>
class WallNormals {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// A wall particle's normal points away from what is solid around it; a dummy's is the mean of
  /// the wall particles' around it. Zero where there is no side to point to. They depend on the
  /// particles alone, not on when they were found: sums run in the order of the ids, and are made
  /// anew when particles came, went, were sorted or changed their kind, and when solid ones moved.
  template <FluidParticles P, class T>
  void find(const P& particles, const Neighbourhood<Dim, Real>& around, const T& stencil) {
    if (are_of(particles)) return;
    const auto kinds = particles.with_ghosts(kind);
    normals_.assign(particles.size(), Vec::Zero());
    for_each(particles.size(), [&](Index i) {
      if (kinds[i] != Kind::wall) return;
      static thread_local std::vector<std::pair<Id, Vec>> solids;  // its memory stays
      solids.clear();
      for_each_weighted(around, i, stencil, [&](Index j, const Vec& r_ij, Real w, Real) {
        if (kinds[j] != Kind::fluid) solids.emplace_back(particles.id(j), (w / r_ij.norm()) * r_ij);
      });
      std::ranges::sort(solids, {}, &std::pair<Id, Vec>::first);
      Vec away = Vec::Zero();
      for (const auto& [id, towards] : solids) away -= towards;
      const Real size = away.norm();
      if (size > Real(least) * stencil.n0) normals_[i] = away / size;
    });
    std::vector<Vec> of_dummies(particles.size(), Vec::Zero());
    for (Index i = 0; i < particles.size(); ++i) {
      if (kinds[i] != Kind::wall) continue;
      for_each_weighted(around, i, stencil, [&](Index j, const Vec&, Real w, Real) {
        if (kinds[j] == Kind::dummy) of_dummies[particles.owner(j)] += w * normals_[i];
      });
    }
    for_each(particles.size(), [&](Index i) {
      if (kinds[i] == Kind::dummy && of_dummies[i].norm() > 0) {
        normals_[i] = of_dummies[i].normalized();
      }
    });
    note(particles);
  }

  const Vec& operator[](Index i) const noexcept { return normals_[i]; }

 private:
  static constexpr double least = 1e-3;  // of n0: what is less is rounding

  template <class P>
  bool are_of(const P& particles) const {
    const auto x = particles[position];
    const auto kinds = particles[kind];
    return particles.owned_revision() == revision_ && x.size() == positions_.size() &&
           first_where(x.size(), [&](Index i) {
             return kinds[i] != kinds_[i] || (kinds[i] != Kind::fluid && x[i] != positions_[i]);
           }) == no_index;
  }
  template <class P>
  void note(const P& particles) {
    const auto x = particles[position];
    const auto kinds = particles[kind];
    positions_.assign(x.begin(), x.end());
    kinds_.assign(kinds.begin(), kinds.end());
    revision_ = particles.owned_revision();
  }

  std::vector<Vec> normals_;  // of owned particles, zero for fluid
  std::vector<Vec> positions_;  // from which they were found; those of fluid do not matter
  std::vector<Kind> kinds_;     // then
  std::uint64_t revision_ = 0;
};

/// <∇·u>_i where fluid slips along walls: a solid particle has its own velocity along its normal, and
/// that of i along the wall. If i is of a wall itself, along it it has the mean velocity of the
/// fluid around.
template <class P, int Dim, class Real, class T, class U>
Real divergence_at_smooth_walls(const P& particles, const Neighbourhood<Dim, Real>& around,
                                const WallNormals<Dim, Real>& normals, const T& stencil, Index i,
                                const U& u) {
  using Vec = silt::Vec<Dim, Real>;
  const auto kinds = particles.with_ghosts(kind);
  Vec own = u[i];
  if (kinds[i] == Kind::wall) {
    Vec mean = Vec::Zero();
    Real weight = 0;
    for_each_weighted(around, i, stencil, [&](Index j, const Vec&, Real w, Real) {
      if (kinds[j] != Kind::fluid) return;
      mean += w * u[j];
      weight += w;
    });
    if (weight > 0) mean /= weight;
    own = mean + normals[i].dot(u[i] - mean) * normals[i];
  }
  Real sum = 0;
  for_each_weighted(around, i, stencil, [&](Index j, const Vec& r_ij, Real, Real w_r2) {
    const Vec u_ij = u[j] - own;
    if (kinds[j] == Kind::fluid) {
      sum += w_r2 * u_ij.dot(r_ij);
    } else {
      const Vec& normal = normals[particles.owner(j)];
      sum += w_r2 * u_ij.dot(normal) * normal.dot(r_ij);
    }
  });
  return Dim / stencil.n0 * sum;
}

}  // namespace silt::mps
