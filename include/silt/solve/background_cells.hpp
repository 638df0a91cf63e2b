// SPDX-License-Identifier: MIT
// The occupied cells of a square (cubic) grid of any extent, numbered, and found again by their place.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace silt {

/// Cell c along each axis covers [c, c + 1) edges.
template <int Dim>
using GridCell = std::array<std::int64_t, Dim>;

/// Numbers the distinct ones of the given cells: red before black, as on a chessboard, and sorted
/// within a colour.
template <int Dim>
class BackgroundCells {
 public:
  using Cell = GridCell<Dim>;

  explicit BackgroundCells(std::vector<Cell> cells) {
    std::sort(cells.begin(), cells.end());
    cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
    lower_.fill(std::numeric_limits<std::int64_t>::max());
    Cell upper;
    upper.fill(std::numeric_limits<std::int64_t>::min());
    for (const Cell& cell : cells) {
      for (std::size_t k = 0; k < Dim; ++k) {
        lower_[k] = std::min(lower_[k], cell[k]);
        upper[k] = std::max(upper[k], cell[k]);
      }
    }
    double box = cells.empty() ? 0 : 1;
    for (std::size_t k = 0; k < Dim && !cells.empty(); ++k) {
      box *= double(upper[k]) - double(lower_[k]) + 1;
    }
    sorted_ = cells;
    reds_ = static_cast<Index>(std::stable_partition(cells.begin(), cells.end(), is_red) -
                               cells.begin());
    number_.resize(cells.size());
    // Where the box is not much larger than its content, a table answers at once.
    is_dense_ = box <= 8 * double(cells.size()) + 4096;
    if (is_dense_) {
      for (std::size_t k = 0; k < Dim && !cells.empty(); ++k) extent_[k] = upper[k] - lower_[k] + 1;
      table_.assign(static_cast<Index>(box), none);
      for (Index c = 0; c < cells.size(); ++c) table_[place(cells[c])] = std::uint32_t(c);
    } else {
      for (Index c = 0; c < cells.size(); ++c) {
        number_[static_cast<Index>(std::lower_bound(sorted_.begin(), sorted_.end(), cells[c]) -
                                   sorted_.begin())] = std::uint32_t(c);
      }
    }
    cells_ = std::move(cells);
  }

  /// What find() gives for a cell that is not there.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  /// No two cells of one colour share a face.
  static bool is_red(const Cell& cell) {
    return (std::accumulate(cell.begin(), cell.end(), std::int64_t(0)) & 1) == 0;
  }

  /// Number of the cell.
  std::uint32_t find(const Cell& cell) const {
    if (is_dense_) {
      for (std::size_t k = 0; k < Dim; ++k) {
        if (cell[k] < lower_[k] || cell[k] - lower_[k] >= extent_[k]) return none;
      }
      return table_[place(cell)];
    }
    const auto at = std::lower_bound(sorted_.begin(), sorted_.end(), cell);
    if (at == sorted_.end() || *at != cell) return none;
    return number_[static_cast<Index>(at - sorted_.begin())];
  }
  /// The cells by number.
  const std::vector<Cell>& cells() const { return cells_; }
  /// Cells 0 … reds()-1 are red.
  Index reds() const { return reds_; }

 private:
  Index place(const Cell& cell) const {
    std::int64_t at = 0;
    for (std::size_t k = Dim; k-- > 0;) at = at * extent_[k] + (cell[k] - lower_[k]);
    return static_cast<Index>(at);
  }

  std::vector<Cell> cells_;
  std::vector<Cell> sorted_;
  std::vector<std::uint32_t> number_;  // by place in sorted_
  std::vector<std::uint32_t> table_;
  Cell lower_{};
  std::array<std::int64_t, Dim> extent_{};
  Index reds_ = 0;
  bool is_dense_ = true;
};

}  // namespace silt
