// SPDX-License-Identifier: MIT
// Tests every particle against every other, O(N²): the reference for tests and benchmarks.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/search/ghosts.hpp>

#include <cmath>
#include <cstdint>
#include <vector>

namespace silt {

/// A NeighbourSearch for tests.
template <int Dim, class RealType = double>
class BruteForce {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< pairs closer than this are found [m]; 0: the interaction range
  };

  BruteForce() = default;
  /// Throws if the radius is negative or not finite.
  explicit BruteForce(Settings settings) : radius_(settings.radius) {
    require_not_negative("BruteForce: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius [m] is not positive.
  void set_radius(Real radius) {
    require_positive("BruteForce: radius", double(radius));
    radius_ = radius;
  }

  /// Copies the positions, and makes the ghosts of periodic sides. Throws as make_ghosts() does,
  /// and if there is no radius.
  template <class P>
  void update(P& particles) {
    require_positive("BruteForce: radius", double(radius_));
    make_ghosts(particles, radius_);
    const auto x = particles.with_ghosts(position);
    positions_.assign(x.begin(), x.end());
    owned_ = particles.size();
    revision_ = particles.owned_revision();
    owners_.resize(positions_.size());
    for (Index i = 0; i < owners_.size(); ++i) owners_[i] = particles.owner(i);
  }

  /// Writes or reads the positions of the last update for a checkpoint, see core/transfer.hpp.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    const bool is_known = transfer_update(
        archive, particles, particles.owned_revision() == revision_,
        [&](Index i) { return positions_[i]; }, [&] { update(particles); });
    if (!is_known) revision_ = 0;  // particles were added or removed since
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Real reach = radius_ * radius_;
    const Vec x_i = positions_[i];
    for (Index j = 0; j < positions_.size(); ++j) {
      const Vec r_ij = positions_[j] - x_i;
      const Real r2 = r_ij.squaredNorm();
      if (r2 < reach && j != i) f(j, r_ij, std::sqrt(r2));
    }
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    const Real reach = radius_ * radius_;
    for (Index i = 0; i < owned_; ++i) {
      const Vec x_i = positions_[i];
      for (Index j = i + 1; j < positions_.size(); ++j) {
        if (owners_[j] <= i) continue;
        const Vec r_ij = positions_[j] - x_i;
        const Real r2 = r_ij.squaredNorm();
        if (r2 < reach) f(i, j, r_ij, std::sqrt(r2));
      }
    }
  }

 private:
  Real radius_ = 0;
  Index owned_ = 0;
  std::uint64_t revision_ = 0;  // of the particles at the last update
  std::vector<Vec> positions_;
  std::vector<Index> owners_;
};

}  // namespace silt
