// SPDX-License-Identifier: MIT
// Linear interpolation P from the centres of background cells to points, and its transpose.
//
//     +---+---+---+     c  centres of cells
//     | c | c | c |     Points within one square of four (in 3D, one cube of eight) centres form a
//     +--[+---+]--+     patch: they are interpolated from the same centres. Both operators work
//     | c | c | c |     patch by patch, and thus read and write each centre and each point once.
//     +--[+---+]--+
//
// Centres of unoccupied cells are omitted, and the weights of the others scaled to sum to 1.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/patch_sums.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <numeric>
#include <span>

namespace silt {

/// The interpolation P between given points and cells, and Pᵀ.
template <int Dim>
class CellInterpolation {
 public:
  using Cells = BackgroundCells<Dim>;
  using Cell = GridCell<Dim>;
  using Point = std::array<double, Dim>;             ///< in edge lengths of a cell
  static constexpr Index corners = Index(1) << Dim;  ///< cells from which a point is interpolated

  /// Locates n points with positions point(i): before sort() and occupied_cells(). P is zero at
  /// points where takes_part(i) is false.
  template <class Where, class TakesPart>
  void locate(Index n, Where&& point, TakesPart&& takes_part) {
    low_.resize(n);
    fraction_.resize(n);
    takes_part_.resize(n);
    in_next_.resize(n);
    for_each(n, [&](Index i) {
      takes_part_[i] = takes_part(i);
      if (!takes_part_[i]) return;
      const Point x = point(i);
      for (std::size_t k = 0; k < Dim; ++k) {
        const double from_centre = x[k] - 0.5;
        low_[i][k] = floor_of(from_centre);
        const double fraction = from_centre - double(low_[i][k]);
        fraction_[i][k] = static_cast<float>(fraction);
        in_next_[i][k] = fraction >= 0.5;
      }
    });
  }

  /// The cells of the points that take part; some more than once.
  void occupied_cells(Buffer<Cell>& cells) const {
    cells.clear();
    for (Index i = 0; i < low_.size(); ++i) {
      if (!takes_part_[i]) continue;
      Cell cell = low_[i];
      for (std::size_t k = 0; k < Dim; ++k) cell[k] += in_next_[i][k] ? 1 : 0;
      if (cells.empty() || !is_same_cell<Dim>(cells.back(), cell)) cells.push_back(cell);
    }
  }

  /// Sorts the points into patches: before build().
  void sort() {
    const Index n = low_.size();
    // Mostly, the point before has the same; otherwise, that has another number of run.
    corners_of_runs_.clear();
    patch_of_.resize(n);
    for (Index i = 0; i < n; ++i) {
      if (!takes_part_[i]) continue;
      if (corners_of_runs_.empty() || !is_same_cell<Dim>(corners_of_runs_.back(), low_[i])) {
        corners_of_runs_.push_back(low_[i]);
      }
      patch_of_[i] = static_cast<std::uint32_t>(corners_of_runs_.size() - 1);
    }
    patches_.number(corners_of_runs_, CellOrder::plain);
    patch_of_run_.resize(corners_of_runs_.size());
    for (Index run = 0; run < patch_of_run_.size(); ++run) {
      patch_of_run_[run] = patches_.find(corners_of_runs_[run]);
    }
    // Counting sort; excluded points are last, in a patch without centres.
    const auto excluded = static_cast<std::uint32_t>(patches_.size());
    first_.assign(patches_.size() + 3, 0);
    for (Index i = 0; i < n; ++i) {
      patch_of_[i] = takes_part_[i] ? patch_of_run_[patch_of_[i]] : excluded;
      ++first_[patch_of_[i] + 2];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    member_.resize(n);
    for (Index i = 0; i < n; ++i) member_[first_[patch_of_[i] + 1]++] = std::uint32_t(i);
  }

  /// After sort(): the cells from which points are interpolated, if they are among those of
  /// build().
  Buffer<Cell> corner_cells() const {
    Buffer<Cell> cells;
    for (const Cell& low : patches_.cells()) {
      for (Index c = 0; c < corners; ++c) cells.push_back(corner(low, c));
    }
    return cells;
  }

  /// P from the centres of these cells.
  void build(const Cells& cells) {
    find_corners(cells);
    weight_.resize(member_.size() * corners);
    const auto find_weights = detail::weights_of_corners<Dim>();
    for_each_cell_range(
        patches_.size(),
        [&](Index first, Index last) {
          find_weights(first_[first], first_[last], member_.data(), fraction_.data(),
                       weight_.data());
          for (Index patch = first; patch < last; ++patch) {
            if (std::ranges::all_of(present_[patch], std::identity{})) continue;
            for (Index k = first_[patch]; k < first_[patch + 1]; ++k) {
              leave_out_absent(patch, &weight_[k * corners]);
            }
          }
        },
        some_cells);
    std::fill(weight_.begin() + static_cast<std::ptrdiff_t>(first_[patches_.size()] * corners),
              weight_.end(), 0.0f);
  }

  /// b = Pᵀ r, with r at the points.
  template <class T>
  void restrict_to(std::span<float> b, const T* r) {
    const auto sum_in = detail::sum_to_corners<corners, T>();
    for_each_cell_range(patches_.size(), [&](Index first, Index last) {
      sum_in(points(), first, last, r, sum_.data());
    });
    for_each_cell(b.size(), [&](Index cell) {
      float sum = 0;
      for (Index c = 0; c < corners; ++c) sum += sum_[patches_of_[cell][c]][c];
      b[cell] = sum;
    });
  }

  /// z = inverse r + P x at the points; returns r·z [-].
  double interpolate(std::span<const float> x, const double* inverse, const double* r, double* z) {
    const auto add_in = detail::add_from_corners<corners>();
    const Index n = patches_.size() + 1;
    products_.assign(n / cells_of_task + 1, 0);
    for_each_cell_range(n, [&](Index first, Index last) {
      products_[first / cells_of_task] =
          add_in(points(), first, last, cells_of_.data(), x.data(), inverse, r, z);
    });
    return std::accumulate(products_.begin(), products_.end(), 0.0);
  }

 private:
  using Corners = std::array<std::uint32_t, corners>;
  // Without a function call on processors whose instruction for it the compiler may not use.
  static std::int64_t floor_of(double x) {
    const auto integer = static_cast<std::int64_t>(x);
    return integer - (double(integer) > x ? 1 : 0);
  }

  detail::PatchPoints<corners> points() const {
    return {first_.data(), member_.data(), weight_.data()};
  }

  static Cell corner(Cell low, Index c) {
    for (std::size_t k = 0; k < Dim; ++k) low[k] += std::int64_t((c >> k) & 1);
    return low;
  }

  // Cells at the corners of each patch, and patches around each cell. A missing cell is replaced by
  // cell 0 with zero weight, a missing patch by one after the last patch, whose sum is zero.
  void find_corners(const Cells& cells) {
    const auto no_patch = static_cast<std::uint32_t>(patches_.size());
    cells_of_.assign(patches_.size() + 1, Corners{});
    present_.assign(patches_.size(), {});
    sum_.resize(patches_.size() + 1);
    sum_[no_patch] = {};
    patches_of_.resize(cells.size());
    for_each_cell(
        cells.size(),
        [&](Index cell) {
          for (Index c = 0; c < corners; ++c) {
            Cell low = cells.cells()[cell];
            for (std::size_t k = 0; k < Dim; ++k) low[k] -= std::int64_t((c >> k) & 1);
            const std::uint32_t patch = patches_.find(low);
            patches_of_[cell][c] = patch != Cells::none ? patch : no_patch;
            if (patch == Cells::none) continue;
            cells_of_[patch][c] = static_cast<std::uint32_t>(cell);  // by no other cell
            present_[patch][c] = true;
          }
        },
        some_cells);
  }

  void leave_out_absent(Index patch, float* weights) const {
    float sum = 0;
    for (Index c = 0; c < corners; ++c) {
      if (!present_[patch][c]) weights[c] = 0;
      sum += weights[c];
    }
    for (Index c = 0; c < corners; ++c) weights[c] = sum > 0 ? weights[c] / sum : 0.0f;
  }

  BackgroundCells<Dim> patches_;  // identified by their low corners: cells with their centres there
  Buffer<Cell> low_;              // corner of the patch, by point
  Buffer<std::array<float, Dim>> fraction_;  // of the edge, from there, by point
  Buffer<std::array<bool, Dim>> in_next_;    // whether the point is in the next cell, by point
  Buffer<bool> takes_part_;                  // by point
  Buffer<Cell> corners_of_runs_;             // of consecutive points with the same patch
  Buffer<std::uint32_t> patch_of_run_;
  Buffer<std::uint32_t> patch_of_;             // by point
  Buffer<std::uint32_t> first_;                // first entry of each patch in member_
  Buffer<std::uint32_t> member_;               // points, sorted by patch
  Buffer<float> weight_;                       // by entry of member_ and corner
  Buffer<Corners> cells_of_;                   // by patch
  Buffer<std::array<bool, corners>> present_;  // by patch
  Buffer<Corners> patches_of_;                 // by cell
  Buffer<std::array<float, corners>> sum_;     // by patch
  Buffer<double> products_;                    // of interpolate(), by task
};

}  // namespace silt
