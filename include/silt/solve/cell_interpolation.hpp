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

#include <array>
#include <cmath>
#include <cstdint>
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

  /// Sorts n points with positions point(i) into patches: before build(). P is zero at points where
  /// takes_part(i) is false.
  template <class Where, class TakesPart>
  void sort(Index n, Where&& point, TakesPart&& takes_part) {
    // Counting sort; excluded points are last, in a patch without centres.
    low_corners_.clear();
    for (Index i = 0; i < n; ++i) {
      if (takes_part(i)) low_corners_.push_back(low_corner(point(i)));
    }
    patches_.number(low_corners_, CellOrder::plain);
    patch_of_.resize(n);
    for (Index i = 0, k = 0; i < n; ++i) {
      patch_of_[i] = takes_part(i) ? patches_.find(low_corners_[k++])
                                   : static_cast<std::uint32_t>(patches_.size());
    }
    first_.assign(patches_.size() + 3, 0);
    for (Index i = 0; i < n; ++i) ++first_[patch_of_[i] + 2];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    member_.resize(n);
    for (Index i = 0; i < n; ++i) member_[first_[patch_of_[i] + 1]++] = std::uint32_t(i);
  }

  /// After sort(): the cells from which points are interpolated, if they are among those of build().
  Buffer<Cell> corner_cells() const {
    Buffer<Cell> cells;
    for (const Cell& low : patches_.cells()) {
      for (Index c = 0; c < corners; ++c) cells.push_back(corner(low, c));
    }
    return cells;
  }

  /// P from the centres of these cells.
  template <class Where>
  void build(const Cells& cells, Where&& point) {
    find_corners(cells);
    weight_.resize(member_.size() * corners);
    const auto find_weights_in = [&](Index patch) {
      for (Index k = first_[patch]; k < first_[patch + 1]; ++k) {
        find_weights(point(member_[k]), patch, &weight_[k * corners]);
      }
    };
    for_each_cell(patches_.size(), find_weights_in, some_cells);
    std::fill(weight_.begin() + static_cast<std::ptrdiff_t>(first_[patches_.size()] * corners),
              weight_.end(), 0.0f);
  }

  /// b = Pᵀ r, with r(i) at the points.
  template <class Values>
  void restrict_to(std::span<float> b, Values&& r) {
    for_each_cell(patches_.size(), [&](Index patch) {
      std::array<float, corners> sum{};
      for (Index k = first_[patch]; k < first_[patch + 1]; ++k) {
        const float value = static_cast<float>(r(member_[k]));
        for (Index c = 0; c < corners; ++c) sum[c] += weight_[k * corners + c] * value;
      }
      sum_[patch] = sum;
    });
    for_each_cell(b.size(), [&](Index cell) {
      float sum = 0;
      for (Index c = 0; c < corners; ++c) sum += sum_[patches_of_[cell][c]][c];
      b[cell] = sum;
    });
  }

  /// f(i, (P x)_i) for every point.
  template <class F>
  void interpolate(std::span<const float> x, F&& f) const {
    for_each_cell(patches_.size() + 1, [&](Index patch) {
      std::array<float, corners> value{};
      for (Index c = 0; c < corners; ++c) value[c] = x[cells_of_[patch][c]];
      for (Index k = first_[patch]; k < first_[patch + 1]; ++k) {
        float sum = 0;
        for (Index c = 0; c < corners; ++c) sum += weight_[k * corners + c] * value[c];
        f(member_[k], sum);
      }
    });
  }

 private:
  using Corners = std::array<std::uint32_t, corners>;

  // The cell whose centre is the lowest corner of the patch.
  static Cell low_corner(const Point& x) {
    Cell low;
    for (std::size_t k = 0; k < Dim; ++k) low[k] = std::int64_t(std::floor(x[k] - 0.5));
    return low;
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
    present_.assign(patches_.size() + 1, {});
    patches_of_.resize(cells.size());
    for (Corners& around : patches_of_) around.fill(no_patch);
    sum_.assign(patches_.size() + 1, {});
    for (Index patch = 0; patch < patches_.size(); ++patch) {
      for (Index c = 0; c < corners; ++c) {
        const std::uint32_t found = cells.find(corner(patches_.cells()[patch], c));
        if (found == Cells::none) continue;
        cells_of_[patch][c] = found;
        present_[patch][c] = true;
        patches_of_[found][c] = static_cast<std::uint32_t>(patch);
      }
    }
  }

  void find_weights(const Point& x, Index patch, float* weights) const {
    const Cell low = patches_.cells()[patch];
    std::array<double, corners> weight;
    double sum = 0;
    for (Index c = 0; c < corners; ++c) {
      weight[c] = present_[patch][c] ? 1 : 0;
      for (std::size_t k = 0; k < Dim; ++k) {
        const double fraction = x[k] - 0.5 - double(low[k]);
        weight[c] *= (c >> k) & 1 ? fraction : 1 - fraction;
      }
      sum += weight[c];
    }
    for (Index c = 0; c < corners; ++c) weights[c] = sum > 0 ? float(weight[c] / sum) : 0.0f;
  }

  BackgroundCells<Dim> patches_;  // identified by their low corners
  Buffer<Cell> low_corners_;
  Buffer<std::uint32_t> patch_of_;                // by point
  Buffer<std::uint32_t> first_;                   // first entry of each patch in member_
  Buffer<std::uint32_t> member_;                  // points, sorted by patch
  Buffer<float> weight_;                          // by entry of member_ and corner
  Buffer<Corners> cells_of_;                      // by patch
  Buffer<std::array<bool, corners>> present_;     // by patch
  Buffer<Corners> patches_of_;                    // by cell
  Buffer<std::array<float, corners>> sum_;        // by patch
};

}  // namespace silt
