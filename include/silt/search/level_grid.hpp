// SPDX-License-Identifier: MIT
// Neighbour search for particles of very different sizes: finds pairs that touch or nearly touch,
// with one grid for each level of sizes (size_classes.hpp). If the sizes are similar, there is one
// level, and the search is that of UniformGrid.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/search/bin_sort.hpp>
#include <silt/search/crowd.hpp>
#include <silt/search/extent.hpp>
#include <silt/search/ghosts.hpp>
#include <silt/search/neighbour_rows.hpp>
#include <silt/search/size_classes.hpp>
#include <silt/search/sorted_cells.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

namespace silt {

/// Finds pairs closer than R_i + R_j + gap, where gap = radius() − 2 max R.
template <int Dim, class RealType = double>
class LevelGrid {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    /// Search radius of a pair of largest particles [m]; 0: the interaction range.
    Real radius = 0;
  };

  LevelGrid() = default;
  /// Throws if the radius is negative or not finite.
  explicit LevelGrid(Settings settings) : radius_(settings.radius) {
    require_not_negative("LevelGrid: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius [m] is not positive.
  void set_radius(Real radius) {
    require_positive("LevelGrid: radius", double(radius));
    radius_ = radius;
  }
  /// Margin of the candidates beyond R_i + R_j + gap [m], see margin_of() in core/concepts.hpp.
  Real margin() const noexcept { return 0; }

  /// Sorts the particles into levels and cells, and makes the ghosts of periodic sides. Throws as
  /// make_ghosts does, if there are 2³² particles or more, if radius() is smaller than the largest
  /// diameter, and if they are a crowd (crowd.hpp).
  template <class P>
    requires HasFields<P, radius_t>
  void update(P& particles) {
    require_positive("LevelGrid: radius", double(radius_));
    make_ghosts(particles, radius_);
    read(particles);
  }
  /// The same with the present ghosts, which are those within radius() or more. Throws alike.
  template <class P>
    requires HasFields<P, radius_t>
  void read(const P& particles) {
    owned_ = particles.size();
    revision_ = particles.owned_revision();
    const auto x = particles.with_ghosts(position);
    const auto R = particles.with_ghosts(silt::radius);
    radii_.assign(R.begin(), R.end());
    resize_tightly(owners_, x.size() - owned_);
    for (Index g = 0; g < owners_.size(); ++g) owners_[g] = particles.owner(owned_ + g);
    gap_ = gap_of(particles.with_halo(silt::radius));
    highest_ = highest_of(particles.with_halo(silt::radius), gap_);
    levels_.resize(std::max<Index>(highest_.size(), 1));
    for (Index l = 0; l < highest_.size(); ++l) {
      levels_[l].largest = largest_of_level(highest_[l], gap_);
    }
    const auto levels_of = [&](Chunk chunk, std::uint32_t* level) {
      for (Index i = chunk.first; i < chunk.last; ++i) {
        *level++ = static_cast<std::uint32_t>(level_of_size(radii_[i]));
      }
    };
    by_level_.sort(x.size(), levels_.size(), levels_of, [](Chunk) {});
    for (Index l = 0; l < levels_.size(); ++l) {
      Level& level = levels_[l];
      level.first = by_level_.start()[l];
      resize_tightly(level.x, by_level_.start()[l + 1] - level.first);
      for_each(level.x.size(), [&](Index k) { level.x[k] = x[item(level, k)]; });
      level.points.sort_and_copy(level.x, extent_of_points(level.x), 2 * level.largest + gap_);
    }
    if (may_be_crowd(owned_, squares())) {
      check_crowd(particles,
                  [&](Index i, FunctionRef<void(Index)> f) { for_each_candidate(i, f); });
    }
  }
  /// Whether the particles have the radii of the last update, on which the candidates depend.
  template <class P>
  bool has_radii_of(const P& particles) const {
    const auto R = particles.with_halo(silt::radius);
    return owned_ == particles.size() && R.size() <= radii_.size() &&
           first_where(R.size(), [&](Index i) { return R[i] != radii_[i]; }) == no_index;
  }
  /// Whether the rows of all particles would take too much memory, see max_row.
  bool has_long_rows() const {
    return squares() > double(max_row) * (double(owned_) + double(max_row));
  }

  /// Sorts the owned particles of all sizes by the cells of the finest level if many are out of
  /// order, so that neighbours in space are close in memory. If particles were added or removed, or
  /// radii changed, since the last update, sorts if any is out of order. Throws if there is no
  /// radius.
  template <class P>
  void sort(P& particles) {
    if (particles.size() < worth_sorting) return;
    require_positive("LevelGrid: radius", double(radius_));
    const P& unchanged = particles;
    const auto x = unchanged[position];
    const auto R = unchanged[silt::radius];
    const Real gap = gap_of(R);
    const SizeClass finest = highest_of(R, gap).front();
    const auto extent = extent_of_points(x);
    if (!extent.is_finite()) return;  // update() throws
    all_levels_.sort(x, extent, 2 * largest_of_level(finest, gap) + gap);
    const bool is_new = !is_of(particles);
    if (all_levels_.descents() <= (is_new ? 0 : particles.size() / 16)) return;
    const auto items = all_levels_.item_of();
    particles.reorder(Buffer<Index>(items.begin(), items.end()));
  }

  /// Writes or reads the positions of the last update for a checkpoint, see core/transfer.hpp.
  template <class Archive, class P>
  void transfer(Archive& archive, P& particles) {
    const bool is_known = transfer_update(
        archive, particles, is_of(particles), [&](Index i) { return position_of(i); },
        [&] { update(particles); });
    if (!is_known) revision_ = 0;  // particles were added or removed, or radii changed, since
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < R_i + R_j + gap; i is owned.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Level& own = level_of(i);
    const Vec x_i = position_of(i);
    for (const Level& level : levels_) {
      const Real distance = radii_[i] + level.largest + gap_;
      level.points.for_each_around(x_i, distance, slot_if(&level == &own, i), [&](Index slot) {
        const Index j = item_at(level, slot);
        const Vec r_ij = level.points.at(slot) - x_i;
        const Real r2 = r_ij.squaredNorm();
        if (r2 < squared(radii_[i] + radii_[j] + gap_)) f(j, r_ij, std::sqrt(r2));
      });
    }
  }

  /// f(j) for the candidates j of the owned particle i. A pair of owned particles closer than R_i +
  /// R_j + gap is reported at one of the two, a pair of an owned particle and a ghost at the owned
  /// one. Pairs farther apart may be reported as well.
  template <class F>
  void for_each_candidate(Index i, F&& f) const {
    const Level& own = level_of(i);
    const Index slot_i = slot_if(true, i);
    const Vec x_i = own.points.at(slot_i);
    const auto report_level = [&](const Level& level, const auto& is_reported_at) {
      const Real distance = radii_[i] + level.largest + gap_;
      level.points.for_each_around(x_i, distance, slot_if(&level == &own, i), [&](Index slot) {
        const Index j = item_at(level, slot);
        if (is_reported_at(slot, j)) f(j);
      });
    };
    if (owners_.empty() && !own.points.cells().shared()) {
      own.points.for_each_forward(slot_i, radii_[i] + own.largest + gap_,
                                  [&](Index slot) { f(item_at(own, slot)); });
    } else {
      report_level(own, [&](Index slot, Index j) { return j >= owned_ || slot_i < slot; });
    }
    for (const Level& level : levels_) {
      if (&level > &own) report_level(level, [](Index, Index) { return true; });
      // A pair of different levels is reported at the finer one or, if that is a ghost, at the
      // coarser.
      if (&level < &own && !owners_.empty()) {
        report_level(level, [this](Index, Index j) { return j >= owned_; });
      }
    }
  }

  /// Whether j is a ghost and the pair i, j an image of a pair that for_each_pair reports at the
  /// other particle.
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

  /// Fills row i with the neighbours of i, or with its candidates.
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

  /// Number of levels in the last update.
  Index levels() const noexcept { return levels_.size(); }

 private:
  // Fewer particles fit into the cache in any order.
  static constexpr Index worth_sorting = 1024;

  struct Level {
    Real largest = 0;  // upper bound of the radii [m]
    Index first = 0;   // of its particles in the order of the levels
    Buffer<Vec> x;
    SortedCells<Dim, Real> points;
  };

  // Whether the last update was with these particles.
  template <class P>
  bool is_of(const P& particles) const {
    return particles.owned_revision() == revision_ && has_radii_of(particles);
  }

  // Sum of m² over all cells with m particles.
  double squares() const {
    double sum = 0;
    for (const Level& level : levels_) sum += level.points.squares();
    return sum;
  }

  // Pairs are found up to this distance between their surfaces.
  template <class Radii>
  Real gap_of(const Radii& radii) const {
    const Real max_radius = silt::largest(radii.size(), Real(0), [&](Index i) { return radii[i]; });
    const Real gap = radius_ - 2 * max_radius;
    if (gap < 0) {
      fail({"LevelGrid: radius = ", double(radius_), " m is smaller than the largest diameter, ",
            2 * double(max_radius), " m; increase it, or do not set it"});
    }
    return gap;
  }

  // The highest size class of each level.
  template <class Radii>
  Buffer<SizeClass> highest_of(const Radii& radii, Real gap) {
    histogram_.assign(size_classes, 0);
    for (const Real size : radii) ++histogram_[size_class_of(double(size))];
    return choose_levels(histogram_, double(gap), Dim);
  }

  // Upper bound of the radii of the level; rounding to single precision may make it smaller.
  Real largest_of_level(SizeClass highest, Real gap) const {
    return std::min(static_cast<Real>(largest_of(highest)), (radius_ - gap) / 2);
  }

  Index level_of_size(Real size) const {
    const SizeClass size_class = size_class_of(double(size));
    return static_cast<Index>(std::lower_bound(highest_.begin(), highest_.end(), size_class) -
                              highest_.begin());
  }
  const Level& level_of(Index i) const { return levels_[level_of_size(radii_[i])]; }

  Index item(const Level& level, Index index) const {
    return by_level_.item_of()[level.first + index];
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
  Buffer<Real> radii_;          // with ghosts
  Buffer<Index> owners_;
  Buffer<Index> histogram_;
  Buffer<SizeClass> highest_;  // of each level
  Buffer<Level> levels_;       // the finest first
  BinSort by_level_;
  SortedCells<Dim, Real> all_levels_;  // for the order in memory
};

}  // namespace silt
