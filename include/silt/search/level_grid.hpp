// SPDX-License-Identifier: MIT
// The search for particles of very different sizes: those near touching, through one grid for each
// level of sizes (size_classes.hpp). With sizes alike there is one level, and it is UniformGrid.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/ghosts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/search/bin_sort.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/size_classes.hpp>
#include <silt/search/sorted_cells.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace silt {

/// Finds pairs closer than R_i + R_j + gap, where gap = radius() − 2 max R.
template <int Dim, class RealType = double>
class LevelGrid {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    /// How far the two largest particles see one another [m]; 0: as far as the interaction reaches
    Real radius = 0;
  };

  LevelGrid() = default;
  /// Throws if the radius is negative or not finite.
  explicit LevelGrid(Settings settings) : radius_(settings.radius) {
    require_not_negative("LevelGrid: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius is not positive.
  void set_radius(Real radius) {
    require_positive("LevelGrid: radius", double(radius));
    radius_ = radius;
  }
  /// Candidates reach no farther than R_i + R_j + gap.
  Real margin() const noexcept { return 0; }

  /// Sorts the particles into levels and cells, and makes the ghosts of periodic sides. Throws as
  /// make_ghosts does, if there are 2³² particles or more, and if radius() is less than two of the
  /// largest particle.
  template <class P>
    requires HasFields<P, radius_t>
  void update(P& particles) {
    require_positive("LevelGrid: radius", double(radius_));
    make_ghosts(particles, radius_);
    owned_ = particles.size();
    revision_ = particles.revision();
    const auto x = particles.with_ghosts(position);
    const auto R = particles.with_ghosts(silt::radius);
    radii_.assign(R.begin(), R.end());
    owners_.resize(x.size() - owned_);
    for (Index g = 0; g < owners_.size(); ++g) owners_[g] = particles.owner(owned_ + g);
    find_gap();
    choose();
    by_level_.sort(x.size(), levels_.size(), [&](Index i) { return level_of_size(radii_[i]); });
    for (Index l = 0; l < levels_.size(); ++l) {
      Level& level = levels_[l];
      level.first = by_level_.start()[l];
      level.x.resize(by_level_.start()[l + 1] - level.first);
      for_each(level.x.size(), [&](Index k) { level.x[k] = x[item(level, k)]; });
      level.points.sort(level.x, 2 * level.largest + gap_);
      level.points.take(level.x);
    }
  }

  /// Puts the owned particles in the order of the finest level's cells, whatever their sizes, if many
  /// are out of it, so that neighbours in space are neighbours in memory; particles that came or
  /// went since the last update, if any are.
  template <class P>
  void sort(P& particles) {
    if (particles.size() < worth_sorting) return;
    require_positive("LevelGrid: radius", double(radius_));
    const Real finest = levels_.empty() ? radius_ : 2 * levels_.front().largest + gap_;
    all_levels_.sort(particles[position], finest);
    const bool is_new = particles.revision() != revision_;
    if (all_levels_.descents() <= (is_new ? 0 : particles.size() / 16)) return;
    const auto items = all_levels_.item_of();
    particles.reorder(std::vector<Index>(items.begin(), items.end()));
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < R_i + R_j + gap; i is owned.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Level& own = level_of(i);
    const Vec x_i = position_of(i);
    for (const Level& level : levels_) {
      level.points.for_each_around(x_i, radii_[i] + level.largest + gap_, slot_if(&level == &own, i),
                                   [&](Index slot) {
        const Index j = item_at(level, slot);
        const Vec r_ij = level.points.at(slot) - x_i;
        const Real r2 = r_ij.squaredNorm();
        if (r2 < squared(radii_[i] + radii_[j] + gap_)) f(j, r_ij, std::sqrt(r2));
      });
    }
  }

  /// f(j) for some j of owned i: every pair of owned particles closer than R_i + R_j + gap is met
  /// from one of the two, every owned one and ghost from the owned one. Others may come as well.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    const Level& own = level_of(i);
    const Index slot_i = slot_if(true, i);
    const Vec x_i = own.points.at(slot_i);
    const auto meet_those_of = [&](const Level& level, const auto& is_met) {
      level.points.for_each_around(x_i, radii_[i] + level.largest + gap_, slot_if(&level == &own, i),
                                   [&](Index slot) {
        const Index j = item_at(level, slot);
        if (is_met(slot, j)) f(j);
      });
    };
    if (owners_.empty() && !own.points.cells().shared()) {
      own.points.for_each_onwards(slot_i, radii_[i] + own.largest + gap_,
                                  [&](Index slot) { f(item_at(own, slot)); });
    } else {
      meet_those_of(own, [&](Index slot, Index j) { return j >= owned_ || slot_i < slot; });
    }
    for (const Level& level : levels_) {
      if (&level > &own) meet_those_of(level, [](Index, Index) { return true; });
      // A ghost looks up to nobody.
      if (&level < &own && !owners_.empty()) {
        meet_those_of(level, [this](Index, Index j) { return j >= owned_; });
      }
    }
  }

  /// Whether j is a ghost, and i with it the image of a pair that counts from its other particle.
  bool is_second_image(Index i, Index j) const noexcept {
    return j >= owned_ && owners_[j - owned_] <= i;
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost.
  template <class F>
  void for_each_pair(F&& f) const {
    for (Index a = 0; a < owned_; ++a) {
      for_each_candidate(a, [&](Index b) {
        if (is_second_image(a, b)) return;
        const Index i = std::min(a, b);
        const Index j = std::max(a, b);
        const Vec r_ij = position_of(j) - position_of(i);
        const Real r2 = r_ij.squaredNorm();
        if (r2 < squared(radii_[i] + radii_[j] + gap_)) f(i, j, r_ij, std::sqrt(r2));
      });
    }
  }

  /// Makes row i the neighbours of i, or its candidates.
  void build_rows(NeighbourRows& rows, Pairs pairs) const {
    rows.build(owned_, [&](Chunk chunk, NeighbourRows::Writer& row) {
      for (Index i = chunk.first; i < chunk.last; ++i) {
        std::uint32_t* to = row.room(1);
        const auto add = [&](Index j) {
          to = row.room(1, to);
          *to++ = static_cast<std::uint32_t>(j);
        };
        if (pairs == Pairs::once) {
          for_each_candidate(i, add);
        } else {
          for_each_neighbour(i, [&](Index j, const Vec&, Real) { add(j); });
        }
        row.end_row(to);
      }
    });
  }
  /// The row of particle i.
  Index slot_of(Index i) const noexcept { return i; }

  /// Levels of the last update.
  Index levels() const noexcept { return levels_.size(); }

 private:
  // Fewer particles fit into a cache in any order.
  static constexpr Index worth_sorting = 1024;

  struct Level {
    Real largest = 0;  // no radius is larger [m]
    Index first = 0;   // where its particles begin in the order of the levels
    std::vector<Vec> x;
    SortedCells<Dim, Real> points;
  };

  void find_gap() {
    const Real most = largest(owned_, Real(0), [&](Index i) { return radii_[i]; });
    gap_ = radius_ - 2 * most;
    if (gap_ < 0) {
      fail("LevelGrid: radius = " + to_text(double(radius_)) +
           " m is less than two of the largest particle, " + to_text(2 * double(most)) +
           " m; enlarge it, or leave it to the simulation");
    }
  }

  void choose() {
    histogram_.assign(size_classes, 0);
    for (Index i = 0; i < owned_; ++i) ++histogram_[size_class_of(double(radii_[i]))];
    highest_ = choose_levels(histogram_, double(gap_), Dim);
    levels_.resize(std::max<Index>(highest_.size(), 1));
    for (Index l = 0; l < highest_.size(); ++l) {
      // Rounded to single precision it may become less.
      const auto bound = static_cast<Real>(largest_of(highest_[l]));
      levels_[l].largest = std::min(bound, (radius_ - gap_) / 2);
    }
  }

  Index level_of_size(Real size) const {
    const SizeClass size_class = size_class_of(double(size));
    return static_cast<Index>(std::lower_bound(highest_.begin(), highest_.end(), size_class) -
                              highest_.begin());
  }
  const Level& level_of(Index i) const { return levels_[level_of_size(radii_[i])]; }

  Index item(const Level& level, Index place) const {
    return by_level_.item_of()[level.first + place];
  }
  Index item_at(const Level& level, Index slot) const {
    return item(level, level.points.item_of()[slot]);
  }
  // Slot of i in its level.
  Index slot_if(bool is_own, Index i) const {
    if (!is_own) return no_index;
    const Level& level = level_of(i);
    return level.points.slot_of(by_level_.slot_of()[i] - level.first);
  }
  Vec position_of(Index i) const { return level_of(i).points.at(slot_if(true, i)); }

  Real radius_ = 0;
  Real gap_ = 0;
  Index owned_ = 0;
  std::uint64_t revision_ = 0;  // of the particles at the last update
  std::vector<Real> radii_;  // with ghosts
  std::vector<Index> owners_;
  std::vector<Index> histogram_;
  std::vector<SizeClass> highest_;  // of each level
  std::vector<Level> levels_;       // the finest first
  BinSort by_level_;
  SortedCells<Dim, Real> all_levels_;  // for their order in memory
};

}  // namespace silt
