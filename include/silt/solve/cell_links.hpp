// SPDX-License-Identifier: MIT
// The links of background cells to their neighbours: rows of equal length, so that a loop over them
// has no branch that depends on the cell.
//
//   cell   0                     1
//   links  [1:k 4:k 5:k 0:0]     [0:k 2:k 1:0 1:0]      a row is filled up with links of no
//                                                       conductance to the cell itself
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <span>

namespace silt {

/// A link to a neighbouring `cell`, by its number.
struct CellLink {
  std::uint32_t cell;
  float conductance;  ///< above 0 [as the entries of A]
};

/// Those of all cells of a level.
template <int Dim>
class CellLinks {
 public:
  /// Most links of a cell that no wall divides.
  static constexpr Index usual = 2 * Dim;

  /// Fills row c with the links that f(c, add) passes to add(link). f may be called twice for a
  /// cell.
  template <class F>
  void build(Index n, F&& f) {
    width_ = usual;
    // A cell at the end of a wall has two neighbours at one position.
    for (Index longest = fill(n, f); longest > width_; longest = fill(n, f)) width_ = longest;
  }

  /// The links of a cell.
  std::span<const CellLink> operator[](Index cell) const {
    const CellLink* const first = &links_[cell * width_];
    const CellLink* const end = first + width_;
    return {first, std::find_if(first, end, [](const CellLink& l) { return l.conductance == 0; })};
  }

  /// f(cell, Σ_l k_l x_l) for the cells in [first, last).
  template <class F>
  void for_each_inflow(Index first, Index last, const float* x, F&& f) const {
    const CellLink* link = links_.data() + first * width_;
    for (Index c = first; c < last; ++c, link += width_) {
      float sum = 0;
      for (Index k = 0; k < usual; ++k) sum += link[k].conductance * x[link[k].cell];
      for (Index k = usual; k < width_; ++k) sum += link[k].conductance * x[link[k].cell];
      f(c, sum);
    }
  }

 private:
  // Returns the number of links of the cell that has most.
  template <class F>
  Index fill(Index n, F& f) {
    links_.resize(n * width_);
    std::atomic<Index> longest = 0;
    for_each_cell(
        n,
        [&](Index c) {
          CellLink* const row = &links_[c * width_];
          Index count = 0;
          f(c, [&](const CellLink& link) {
            if (count < width_) row[count] = link;
            ++count;
          });
          std::fill(row + std::min(count, width_), row + width_,
                    CellLink{static_cast<std::uint32_t>(c), 0});
          if (count > width_) {
            Index before = longest;
            while (before < count && !longest.compare_exchange_weak(before, count)) {
            }
          }
        },
        some_cells);
    return longest;
  }

  Index width_ = usual;
  Buffer<CellLink> links_;
};

}  // namespace silt
