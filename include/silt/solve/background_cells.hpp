// SPDX-License-Identifier: MIT
// The occupied cells of a square (cubic) grid of any extent, numbered consecutively, and lookup of
// the number of a cell.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>

namespace silt {

/// Number of cells from which several threads pay off, if each cell takes a few nanoseconds; if it
/// takes tens of nanoseconds.
inline constexpr Index many_cells = 1536;
/// The same if each cell takes tens of nanoseconds.
inline constexpr Index some_cells = 192;

/// f(c) for c in [0, n), in parallel if there are at least min_parallel cells.
template <class F>
void for_each_cell(Index n, F&& f, Index min_parallel = many_cells) {
  constexpr Index task_size = 64;
  if (n < min_parallel) {
    for (Index c = 0; c < n; ++c) f(c);
  } else {
    for_each_task((n + task_size - 1) / task_size, [&](Index task) {
      for (Index c = task * task_size; c < std::min(n, (task + 1) * task_size); ++c) f(c);
    });
  }
}

/// Integer coordinates of a cell: c covers [c, c + 1) edge lengths along each axis.
template <int Dim>
using GridCell = std::array<std::int64_t, Dim>;

/// Numbering order of the cells; within a colour, x varies fastest.
enum class CellOrder {
  plain,       ///< one colour
  chessboard,  ///< red cells before black cells; cells of one colour share no face
};

/// Numbers occupied cells, and finds the number of one.
template <int Dim>
class BackgroundCells {
 public:
  using Cell = GridCell<Dim>;

  /// Result of find() for a cell that is not occupied.
  static constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();

  /// Numbers the distinct cells of `given`. Reuses the memory of earlier calls.
  void number(std::span<const Cell> given, CellOrder order) {
    order_ = order;
    find_bounding_box(given);
    double box = given.empty() ? 0 : 1;
    for (const std::int64_t along : extent_) box *= double(along);
    // If the bounding box is not much larger than the number of cells, a table over the box is
    // used.
    has_table_ = box <= 2 * double(given.size()) + 4096;
    cells_.clear();
    if (has_table_) {
      collect_by_table(given, static_cast<Index>(box));
    } else {
      cells_.assign(given);
      std::sort(cells_.begin(), cells_.end(), comes_before);
      cells_.resize(static_cast<Index>(std::unique(cells_.begin(), cells_.end()) - cells_.begin()));
    }
    sort_by_colour();
    for (Index c = 0; has_table_ && c < cells_.size(); ++c) {
      table_[table_index(cells_[c])] = static_cast<std::uint32_t>(c);
    }
  }

  /// Number of a cell.
  std::uint32_t find(const Cell& cell) const {
    if (has_table_) {
      for (std::size_t k = 0; k < Dim; ++k) {
        if (cell[k] < lower_[k] || cell[k] - lower_[k] >= extent_[k]) return none;
      }
      return table_[table_index(cell)];
    }
    const auto first_black = cells_.begin() + static_cast<std::ptrdiff_t>(reds_);
    const auto begin = is_red(cell) ? cells_.begin() : first_black;
    const auto end = is_red(cell) ? first_black : cells_.end();
    const auto found = std::lower_bound(begin, end, cell, comes_before);
    if (found == end || *found != cell) return none;
    return static_cast<std::uint32_t>(found - cells_.begin());
  }

  /// The cells in the order of their numbers.
  std::span<const Cell> cells() const noexcept { return cells_; }
  Index size() const noexcept { return cells_.size(); }
  /// Cells 0 … reds()-1 are red.
  Index reds() const noexcept { return reds_; }

 private:
  bool is_red(const Cell& cell) const {
    return order_ == CellOrder::plain ||
           (std::accumulate(cell.begin(), cell.end(), std::int64_t(0)) & 1) == 0;
  }

  static bool comes_before(const Cell& a, const Cell& b) {
    return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  }

  void find_bounding_box(std::span<const Cell> given) {
    lower_.fill(std::numeric_limits<std::int64_t>::max());
    Cell upper;
    upper.fill(std::numeric_limits<std::int64_t>::min());
    for (const Cell& cell : given) {
      for (std::size_t k = 0; k < Dim; ++k) {
        lower_[k] = std::min(lower_[k], cell[k]);
        upper[k] = std::max(upper[k], cell[k]);
      }
    }
    extent_.fill(0);
    for (std::size_t k = 0; k < Dim && !given.empty(); ++k) extent_[k] = upper[k] - lower_[k] + 1;
  }

  void collect_by_table(std::span<const Cell> given, Index size) {
    table_.assign(size, none);
    for (const Cell& cell : given) table_[table_index(cell)] = 0;
    Cell cell = lower_;
    for (Index index = 0; index < size; ++index) {
      if (table_[index] != none) cells_.push_back(cell);
      for (std::size_t k = 0; k < Dim; ++k) {  // the next cell, x fastest
        if (++cell[k] - lower_[k] < extent_[k] || k + 1 == Dim) break;
        cell[k] = lower_[k];
      }
    }
  }

  void sort_by_colour() {
    by_colour_.clear();
    for (const bool red : {true, false}) {
      for (const Cell& cell : cells_) {
        if (is_red(cell) == red) by_colour_.push_back(cell);
      }
      if (red) reds_ = by_colour_.size();
    }
    cells_.swap(by_colour_);
  }

  Index table_index(const Cell& cell) const {
    std::int64_t index = 0;
    for (std::size_t k = Dim; k-- > 0;) index = index * extent_[k] + (cell[k] - lower_[k]);
    return static_cast<Index>(index);
  }

  CellOrder order_ = CellOrder::plain;
  Buffer<Cell> cells_;
  Buffer<Cell> by_colour_;
  Buffer<std::uint32_t> table_;  // numbers of the cells of the bounding box
  Cell lower_{};
  std::array<std::int64_t, Dim> extent_{};
  Index reds_ = 0;
  bool has_table_ = true;
};

}  // namespace silt
