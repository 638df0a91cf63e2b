// SPDX-License-Identifier: MIT
// Square cells with the search radius as edge, [SahChoi2004] (1). Particles are sorted by cell, x
// fastest, so that the cells beside one another in a row are one range of memory:
//
//     row y+1   . . [a a|b  |c c] . .      3 ranges in 2D, 9 in 3D, instead of 9 and 27 cells
//     row y     . . [d  |i  |   ] . .
//     row y-1   . . [   |e e|f  ] . .
//
// The number of cells is O(N) whatever the extent: where the particles' bounding box has more, the
// grid is folded (cell c lies in bin c mod n along each axis). Far cells then share a bin, which
// costs a few distance tests and never a pair. Fold lengths are pairwise coprime, so that a line of
// particles along a diagonal does not fall into one bin in n.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/ghosts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace silt {

template <int Dim, class RealType = double>
class UniformGrid {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  struct Settings {
    Real radius = 0;  ///< pairs closer than this are found [m]; 0: as far as the interaction reaches
  };

  UniformGrid() = default;
  /// Throws if the radius is negative or not finite.
  explicit UniformGrid(Settings settings) : radius_(settings.radius) {
    require_not_negative("UniformGrid: radius", double(radius_));
  }

  Real radius() const noexcept { return radius_; }
  /// Throws if the radius is not positive.
  void set_radius(Real radius) {
    require_positive("UniformGrid: radius", double(radius));
    radius_ = radius;
  }

  /// Sorts the particles into cells, and makes the ghosts of periodic sides. Throws as make_ghosts
  /// does.
  template <class P>
  void update(P& particles) {
    require_positive("UniformGrid: radius", double(radius_));
    make_ghosts(particles, radius_);
    const auto x = particles.with_ghosts(position);
    lay_grid(x);
    sort(x);
    owned_ = particles.size();
    ghost_owners_.resize(x.size() - owned_);
    for (Index g = 0; g < ghost_owners_.size(); ++g) {
      ghost_owners_[g] = particles.owner(owned_ + g);
    }
  }

  /// f(j, r_ij, r) for every j, owned or ghost, with r < radius(); i is owned, r_ij = x_j − x_i.
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    for_each_near(slot_of_[i], 0, [&](Index slot, const Vec& r_ij, Real r) {
      f(particle_of_[slot], r_ij, r);
    });
  }

  /// f(i, j, r_ij, r) for every pair once; i is owned, j owned or ghost. Pairs come in the order of
  /// the cells.
  template <class F>
  void for_each_pair(F&& f) const {
    for (Index slot = 0; slot < sorted_.size(); ++slot) {
      const Index a = particle_of_[slot];
      for_each_near(slot, slot + 1, [&](Index other, const Vec& r_ab, Real r) {
        const Index b = particle_of_[other];
        const Index i = std::min(a, b);
        const Index j = std::max(a, b);
        // Ghosts stand behind the owned; of a pair and its image one is met.
        if (j >= owned_ && (i >= owned_ || ghost_owners_[j - owned_] <= i)) return;
        f(i, j, Vec((a < b ? Real(1) : Real(-1)) * r_ab), r);
      });
    }
  }

  /// Bins of the grid: at most a small multiple of the number of particles.
  Index bins() const noexcept { return start_.empty() ? 0 : start_.size() - 1; }

  /// Owned particles in cell order: what Particles::reorder takes so that neighbours in space become
  /// neighbours in memory.
  std::vector<Index> order() const {
    std::vector<Index> order;
    order.reserve(owned_);
    for (const Index i : particle_of_) {
      if (i < owned_) order.push_back(i);
    }
    return order;
  }

 private:
  using Cell = std::array<std::int64_t, Dim>;

  void lay_grid(std::span<const Vec> x) {
    Vec lower = x.empty() ? Vec(Vec::Zero()) : x[0];
    Vec upper = lower;
    for (const Vec& at : x) {
      lower = lower.cwiseMin(at);
      upper = upper.cwiseMax(at);
    }
    origin_ = lower;
    // A little wider than the radius, so that rounding cannot put a pair two cells apart.
    const Real rounding = 4 * std::numeric_limits<Real>::epsilon();
    const Real edge = radius_ + rounding * (radius_ + (upper - lower).maxCoeff());
    per_edge_ = 1 / edge;

    // Doubles, because the product may exceed every integer; but each factor rounded as in cell_of,
    // so that the last particle lies in the last cell.
    std::array<double, Dim> cells;
    for (int k = 0; k < Dim; ++k) {
      const double along = double(std::floor((upper[k] - lower[k]) * per_edge_)) + 1;
      if (!(along < 4e18)) {
        fail("UniformGrid: the particles extend over " + to_text(double(upper[k] - lower[k])) +
             " m, more than 4e18 search radii of " + to_text(double(radius_)) +
             " m; remove the stray ones or enlarge the radius");
      }
      cells[static_cast<std::size_t>(k)] = along;
    }
    const double limit = 2.0 * double(x.size()) + 64;
    const auto product = [&] {
      return std::accumulate(cells.begin(), cells.end(), 1.0, [](double a, double b) { return a * b; });
    };
    folded_.fill(false);
    while (product() > limit) {
      const auto longest = static_cast<std::size_t>(
          std::max_element(cells.begin(), cells.end()) - cells.begin());
      cells[longest] = std::max(3.0, std::min(std::floor(cells[longest] / 2), limit));
      folded_[longest] = true;
    }
    for (std::size_t k = 0; k < Dim; ++k) {
      bins_[k] = static_cast<std::int64_t>(cells[k]);
      const auto shares_a_factor = [&] {
        for (std::size_t other = 0; other < k; ++other) {
          if (folded_[other] && std::gcd(bins_[k], bins_[other]) != 1) return true;
        }
        return false;
      };
      while (folded_[k] && bins_[k] > 3 && shares_a_factor()) --bins_[k];
    }
  }

  Cell cell_of(const Vec& x) const {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      cell[static_cast<std::size_t>(k)] =
          static_cast<std::int64_t>((x[k] - origin_[k]) * per_edge_);  // never below 0
    }
    return cell;
  }

  // Bin of a cell along axis k.
  std::int64_t fold(std::int64_t c, std::size_t k) const {
    if (!folded_[k]) return c;
    const std::int64_t bin = c % bins_[k];
    return bin < 0 ? bin + bins_[k] : bin;
  }

  Index bin_of(const Cell& cell) const {
    std::int64_t bin = 0;
    for (std::size_t k = Dim; k-- > 0;) bin = bin * bins_[k] + fold(cell[k], k);
    return static_cast<Index>(bin);
  }

  // Counting sort by bin; particles of one bin stay in the order of their indices.
  void sort(std::span<const Vec> x) {
    const Index n = x.size();
    bin_.resize(n);
    for_each(n, [&](Index i) { bin_[i] = bin_of(cell_of(x[i])); });
    Index bins = 1;
    for (const std::int64_t along : bins_) bins *= static_cast<Index>(along);
    start_.assign(bins + 1, 0);
    for (Index i = 0; i < n; ++i) ++start_[bin_[i] + 1];
    std::partial_sum(start_.begin(), start_.end(), start_.begin());
    slot_of_.resize(n);
    sorted_.resize(n);
    particle_of_.resize(n);
    next_.assign(start_.begin(), start_.end() - 1);
    for (Index i = 0; i < n; ++i) {
      const Index slot = next_[bin_[i]]++;
      slot_of_[i] = slot;
      sorted_[slot] = x[i];
      particle_of_[slot] = i;
    }
  }

  // Bins beside bin c along axis k as at most two runs of consecutive bins.
  struct Runs {
    std::array<std::array<std::int64_t, 2>, 2> run;  // first and last bin
    int count;
  };
  Runs around(std::int64_t c, std::size_t k) const {
    const std::int64_t n = bins_[k];
    if (!folded_[k]) {
      return {{{{std::max<std::int64_t>(c - 1, 0), std::min(c + 1, n - 1)}, {}}}, 1};
    }
    const std::int64_t from = fold(c - 1, k);
    if (from + 2 < n) return {{{{from, from + 2}, {}}}, 1};
    return {{{{from, n - 1}, {0, from + 2 - n}}}, 2};
  }

  // Ranges of slots that may hold neighbours of something in the cell: one or, where the grid is
  // folded within it, two for each of the 3 (9) rows of cells. `onwards`: slots behind the cell's
  // own only, so that what lies before it may be left out.
  struct Ranges {
    std::array<std::array<Index, 2>, Dim == 2 ? 6 : 18> range;  // first slot, and one behind the last
    int count;
  };
  Ranges ranges_around(const Cell& cell, bool onwards) const {
    Ranges ranges;
    ranges.count = 0;
    const Runs along_x = around(cell[0], 0);
    Runs along_last = around(cell[Dim - 1], Dim - 1);
    // In 3D g++ 12 makes slower code of the shorter loop than it saves.
    if (Dim == 2 && onwards && !folded_[Dim - 1]) along_last.run[0][0] = cell[Dim - 1];
    const auto for_each_bin = [](const Runs& runs, auto&& f) {
      for (int r = 0; r < runs.count; ++r) {
        const auto [from, to] = runs.run[static_cast<std::size_t>(r)];
        for (std::int64_t bin = from; bin <= to; ++bin) f(bin);
      }
    };
    const auto add_row = [&](std::int64_t rows_before) {
      const std::int64_t base = rows_before * bins_[0];
      for (int r = 0; r < along_x.count; ++r) {
        const auto [from, to] = along_x.run[static_cast<std::size_t>(r)];
        ranges.range[static_cast<std::size_t>(ranges.count++)] = {
            start_[static_cast<Index>(base + from)], start_[static_cast<Index>(base + to) + 1]};
      }
    };
    if constexpr (Dim == 2) {
      for_each_bin(along_last, add_row);
    } else {
      const Runs along_y = around(cell[1], 1);
      for_each_bin(along_last, [&](std::int64_t z) {
        for_each_bin(along_y, [&](std::int64_t y) { add_row(z * bins_[1] + y); });
      });
    }
    return ranges;
  }

  // f(slot, r_ij, r) for every slot from `first` on whose position is within the radius of that in
  // slot `own`. Whether a distance is below the radius cannot be predicted, so that a branch would
  // cost more than the distance: hits are noted without one, and handed over together.
  template <class F>
  void for_each_near(Index own, Index first, F&& f) const {
    const Real reach = radius_ * radius_;
    const Vec x_i = sorted_[own];
    const Vec* const x = sorted_.data();
    std::array<Index, 32> hits;
    Index count = 0;
    const auto hand_over = [&](Index noted) {
      for (Index k = 0; k < noted; ++k) {
        const Vec r_ij = x[hits[k]] - x_i;
        f(hits[k], r_ij, std::sqrt(r_ij.squaredNorm()));
      }
    };
    const Ranges ranges = ranges_around(cell_of(x_i), first > 0);
    for (int row = 0; row < ranges.count; ++row) {
      const auto [begin, end] = ranges.range[static_cast<std::size_t>(row)];
      for (Index slot = std::max(begin, first); slot < end; ++slot) {
        const Vec r_ij = x[slot] - x_i;
        hits[count] = slot;
        count += static_cast<Index>(r_ij.squaredNorm() < reach) & static_cast<Index>(slot != own);
        if (count == hits.size()) {
          hand_over(count);
          count = 0;
        }
      }
    }
    hand_over(count);
  }

  Real radius_ = 0;
  Index owned_ = 0;
  Vec origin_ = Vec::Zero();
  Real per_edge_ = 0;
  std::array<std::int64_t, Dim> bins_{};
  std::array<bool, Dim> folded_{};
  std::vector<Index> start_;        // first slot of each bin
  std::vector<Vec> sorted_;         // positions by slot
  std::vector<Index> particle_of_;  // by slot
  std::vector<Index> slot_of_;      // by particle
  std::vector<Index> bin_;          // by particle
  std::vector<Index> next_;
  std::vector<Index> ghost_owners_;
};

}  // namespace silt
