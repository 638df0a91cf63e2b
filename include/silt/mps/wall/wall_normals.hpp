// SPDX-License-Identifier: MIT
// Normals of walls made of particles.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/neighbourhood.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace silt::mps {

/// Unit normals of walls, computed from the positions of their particles.
template <int Dim, class RealType>
class WallNormals {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// The normal of a wall particle points away from the wall and dummy particles around it; that of
  /// a dummy is the mean of those of the neighbouring wall particles. Zero where no direction is
  /// defined. Sums run in the order of the ids, so that the result does not depend on the time of
  /// the last update; updated if particles were added, removed or sorted or changed their kind, or
  /// if walls or dummies moved.
  template <FluidParticles P, class T>
  void find(const P& particles, const Neighbourhood<Dim, Real>& around, const T& stencil) {
    if (!silt::detail::any_of_all(particles, !are_current(particles))) return;
    const auto kinds = particles.with_ghosts(kind);
    revision_ = 0;  // until all normals are found
    normals_.assign(particles.local(), Vec::Zero());
    for_each(particles.size(), [&](Index i) {
      if (kinds[i] != Kind::wall) return;
      static thread_local Buffer<std::pair<Id, Vec>> solids;  // keeps its capacity
      solids.clear();
      for_each_weighted(around, i, stencil, [&](Index j, const Vec& r_ij, Real w, Real) {
        if (kinds[j] != Kind::fluid) solids.push_back({particles.id(j), (w / r_ij.norm()) * r_ij});
      });
      std::ranges::sort(solids, {}, &std::pair<Id, Vec>::first);
      Vec away = Vec::Zero();
      for (const auto& [id, contribution] : solids) away -= contribution;
      const Real size = away.norm();
      if (size > Real(min_size) * stencil.n0) normals_[i] = away / size;
    });
    Buffer<Vec> of_dummies(particles.local(), Vec::Zero());
    for (Index i = 0; i < particles.size(); ++i) {
      if (kinds[i] != Kind::wall) continue;
      for_each_weighted(around, i, stencil, [&](Index j, const Vec&, Real w, Real) {
        if (kinds[j] == Kind::dummy) of_dummies[particles.owner(j)] += w * normals_[i];
      });
    }
    silt::detail::add_to_owners(particles, of_dummies);
    for_each(particles.size(), [&](Index i) {
      if (kinds[i] == Kind::dummy && of_dummies[i].norm() > 0) {
        normals_[i] = of_dummies[i].normalized();
      }
    });
    silt::detail::share(particles, normals_);
    store_state(particles);
  }

  const Vec& operator[](Index i) const noexcept { return normals_[i]; }

 private:
  static constexpr double min_size = 1e-3;  // in n0; anything below is round-off

  template <class P>
  bool are_current(const P& particles) const {
    const auto x = particles[position];
    const auto kinds = particles[kind];
    return particles.owned_revision() == revision_ && x.size() == positions_.size() &&
           first_where(x.size(), [&](Index i) {
             return kinds[i] != kinds_[i] || (kinds[i] != Kind::fluid && x[i] != positions_[i]);
           }) == no_index;
  }
  template <class P>
  void store_state(const P& particles) {
    const auto x = particles[position];
    const auto kinds = particles[kind];
    positions_.assign(x.begin(), x.end());
    kinds_.assign(kinds.begin(), kinds.end());
    revision_ = particles.owned_revision();
  }

  Buffer<Vec> normals_;    // of particles, also of the halo; zero for fluid
  Buffer<Vec> positions_;  // at the last update; those of fluid are not used
  Buffer<Kind> kinds_;     // at the last update
  std::uint64_t revision_ = 0;
};

}  // namespace silt::mps
