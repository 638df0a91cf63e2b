// SPDX-License-Identifier: MIT
// The search below a neighbour list, with bounded memory. If its cells contain too many particles
// for rows, rows are not stored, and the search is used directly. Candidates of grains are then
// found by a LevelGrid, with a skin that fits the smallest grain: only pairs near contact.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_rows.hpp>

#include <algorithm>

namespace silt {

/// A UniformGrid or the like, Inner, and for grains of very different sizes a LevelGrid.
template <class Inner>
class ListGrid {
 public:
  using Real = typename Inner::Real;

  /// Search radius and skin of a list [m].
  struct Reach {
    Real radius = 0;
    Real skin = 0;
    /// Radius that the search below the list has [m].
    Real sum() const { return radius + skin; }
  };

  /// Sorts the owned particles as the search does that finds the candidates; `reach` [m] is its
  /// radius.
  template <class P>
  void sort(P& particles, Real reach) {
    if constexpr (HasFields<P, radius_t>) {
      if (has_levels_) {
        levels_.set_radius(reach);
        levels_.sort(particles);
        return;
      }
    }
    inner_.set_radius(reach);
    if constexpr (requires { inner_.sort(particles); }) inner_.sort(particles);
  }

  /// Reads the particles; returns the skin with which candidates are found [m]. Throws as the
  /// search does.
  template <class P>
  Real update(P& particles, const Reach& reach) {
    inner_.set_radius(reach.sum());
    has_levels_ = false;
    if constexpr (requires { inner_.refuse_crowd(particles); }) {
      inner_.read(particles);
      has_long_rows_ = inner_.has_long_rows();
      if (!has_long_rows_) inner_.refuse_crowd(particles);
    } else {
      inner_.update(particles);
      if constexpr (requires { inner_.has_long_rows(); }) has_long_rows_ = inner_.has_long_rows();
    }
    if constexpr (HasFields<P, radius_t>) {
      if (has_long_rows_) return update_levels(particles, reach);
    }
    return reach.skin;
  }

  /// Whether the candidates of the last update are those of these particles, as far as the radii
  /// determine them.
  template <class P>
  bool has_radii_of(const P& particles) const {
    if constexpr (requires { inner_.has_radii_of(particles); }) {
      if (!inner_.has_radii_of(particles)) return false;
    }
    if constexpr (HasFields<P, radius_t>) return !has_levels_ || levels_.has_radii_of(particles);
    return true;
  }

  /// Writes or reads, for a checkpoint (core/transfer.hpp), by which search particles are sorted
  /// until the next update.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_levels", has_levels_);
  }

  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    inner_.for_each_neighbour(i, f);
  }
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    if (has_levels_) {
      levels_.for_each_candidate(i, f);
    } else {
      inner_.for_each_candidate(i, f);
    }
  }
  /// Candidates closer than the radius plus the skin, also if for_each_candidate gives only those
  /// near contact.
  template <class F>
  void for_each_distant_candidate(Index i, F&& f) const {
    inner_.for_each_candidate(i, f);
  }
  /// Whether for_each_candidate() gives only pairs near contact.
  bool finds_only_contacts() const noexcept { return has_levels_; }
  /// See UniformGrid::is_second_image().
  bool is_second_image(Index i, Index j) const noexcept { return inner_.is_second_image(i, j); }

  /// Fills the rows and returns true, or returns false if they would take too much memory.
  bool build_rows(NeighbourRows& rows, Pairs pairs) const {
    if (has_levels_ && pairs == Pairs::once) {
      if (levels_.has_long_rows()) return false;
      levels_.build_rows(rows, pairs);
    } else {
      if (has_long_rows_) return false;
      inner_.build_rows(rows, pairs);
    }
    return true;
  }
  /// The row of particle i with every pair once, or twice.
  Index row_of(Index i) const noexcept { return has_levels_ ? i : inner_.slot_of(i); }
  /// The same for rows of for_each_distant_candidate().
  Index distant_row_of(Index i) const noexcept { return inner_.slot_of(i); }

 private:
  template <class P>
  Real update_levels(P& particles, const Reach& reach) {
    const auto R = particles.with_halo(radius);
    const Real max_radius = largest(R.size(), Real(0), [&](Index i) { return Real(R[i]); });
    // Levels require a radius that includes all contacts.
    if (reach.radius < 2 * max_radius) {
      if constexpr (requires { inner_.refuse_crowd(particles); }) inner_.refuse_crowd(particles);
      return reach.skin;
    }
    // A skin in proportion to the largest grain would make neighbours of all small ones.
    constexpr Real skin_of_smallest = Real(0.4);
    const Real min_radius = -largest(R.size(), -max_radius, [&](Index i) { return -Real(R[i]); });
    const Real skin = std::min(reach.skin, skin_of_smallest * std::max(Real(0), min_radius));
    levels_.set_radius(reach.radius + skin);
    levels_.read(particles);  // with the same ghosts, to which the indices of inner_ refer
    has_levels_ = true;
    return skin;
  }

  Inner inner_;
  LevelGrid<Inner::Vec::RowsAtCompileTime, Real> levels_;
  bool has_levels_ = false;
  bool has_long_rows_ = false;
};

}  // namespace silt
