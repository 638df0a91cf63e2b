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
#include <span>
#include <utility>

namespace silt {

/// Number of cells from which several threads pay off, if each cell takes a few nanoseconds; if it
/// takes tens of nanoseconds.
inline constexpr Index many_cells = 1536;
/// The same if each cell takes tens of nanoseconds.
inline constexpr Index some_cells = 192;

/// Number of cells that one thread takes at once, at least.
inline constexpr Index cells_of_task = 64;
/// f(first, last) for ranges that together are [0, n), in parallel if there are at least
/// min_parallel cells.
template <class F>
void for_each_cell_range(Index n, F&& f, Index min_parallel = many_cells) {
  if (n < min_parallel) {
    if (n > 0) f(Index(0), n);
  } else {
    for_each_task((n + cells_of_task - 1) / cells_of_task, [&](Index task) {
      f(task * cells_of_task, std::min(n, (task + 1) * cells_of_task));
    });
  }
}
/// f(c) for c in [0, n), in parallel if there are at least min_parallel cells.
template <class F>
void for_each_cell(Index n, F&& f, Index min_parallel = many_cells) {
  for_each_cell_range(
      n,
      [&f](Index first, Index last) {
        for (Index c = first; c < last; ++c) f(c);
      },
      min_parallel);
}

/// Integer coordinates of a cell: c covers [c, c + 1) edge lengths along each axis.
template <int Dim>
using GridCell = std::array<std::int64_t, Dim>;

/// a = b, without the function call that a comparison of arrays is.
template <int Dim>
bool is_same_cell(const GridCell<Dim>& a, const GridCell<Dim>& b) {
  std::int64_t difference = 0;
  for (std::size_t k = 0; k < Dim; ++k) difference |= a[k] ^ b[k];
  return difference == 0;
}

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
    if (!has_table_) return find_sorted(cell);
    return is_in_box(cell) ? table_[table_index(cell)] : none;
  }

  /// Number of the cell beside an occupied one: behind it along the axis, or in front of it.
  std::uint32_t beside(const Cell& cell, std::size_t axis, bool behind) const {
    Cell next = cell;
    next[axis] += behind ? 1 : -1;
    return find(next);
  }

  /// The cells in the order of their numbers.
  std::span<const Cell> cells() const noexcept { return cells_; }
  Index size() const noexcept { return cells_.size(); }
  /// Cells 0 … reds()-1 are red.
  Index reds() const noexcept { return reds_; }

 private:
  // Axes written one by one, because without -O3 g++ leaves loops over them.
  using Axes = std::make_index_sequence<Dim>;

  bool is_red(const Cell& cell) const {
    return order_ == CellOrder::plain || (sum_of(cell, Axes{}) & 1) == 0;
  }
  template <std::size_t... k>
  static std::int64_t sum_of(const Cell& cell, std::index_sequence<k...>) {
    return (cell[k] + ...);
  }

  [[gnu::noinline]] std::uint32_t find_sorted(const Cell& cell) const {
    const auto first_black = cells_.begin() + static_cast<std::ptrdiff_t>(reds_);
    const auto begin = is_red(cell) ? cells_.begin() : first_black;
    const auto end = is_red(cell) ? first_black : cells_.end();
    const auto found = std::lower_bound(begin, end, cell, comes_before);
    if (found == end || *found != cell) return none;
    return static_cast<std::uint32_t>(found - cells_.begin());
  }

  static bool comes_before(const Cell& a, const Cell& b) {
    return std::lexicographical_compare(a.rbegin(), a.rend(), b.rbegin(), b.rend());
  }

  void find_bounding_box(std::span<const Cell> given) {
    lower_.fill(std::numeric_limits<std::int64_t>::max());
    Cell upper;
    upper.fill(std::numeric_limits<std::int64_t>::min());
    for (const Cell& cell : given) extend_box(cell, upper, Axes{});
    extent_.fill(0);
    for (std::size_t k = 0; k < Dim && !given.empty(); ++k) extent_[k] = upper[k] - lower_[k] + 1;
  }
  template <std::size_t... k>
  void extend_box(const Cell& cell, Cell& upper, std::index_sequence<k...>) {
    ((lower_[k] = std::min(lower_[k], cell[k])), ...);
    ((upper[k] = std::max(upper[k], cell[k])), ...);
  }

  void collect_by_table(std::span<const Cell> given, Index size) {
    stride_[0] = 1;
    for (std::size_t k = 1; k < Dim; ++k) stride_[k] = stride_[k - 1] * extent_[k - 1];
    table_.assign(size, none);
    for (const Cell& cell : given) table_[table_index(cell)] = 0;
    Cell cell = lower_;
    const auto along = static_cast<Index>(extent_[0]);
    for (Index line = 0; line < size; line += along) {
      for (Index x = 0; x < along; ++x) {
        if (table_[line + x] == none) continue;
        cell[0] = lower_[0] + static_cast<std::int64_t>(x);
        cells_.push_back(cell);
      }
      for (std::size_t k = 1; k < Dim; ++k) {  // the next line, y before z
        if (++cell[k] - lower_[k] < extent_[k]) break;
        cell[k] = lower_[k];
      }
    }
  }

  void sort_by_colour() {
    reds_ = cells_.size();
    if (order_ == CellOrder::plain) return;
    reds_ = 0;
    for (const Cell& cell : cells_) reds_ += is_red(cell) ? 1 : 0;
    by_colour_.resize(cells_.size());
    Index red = 0;
    Index black = reds_;
    for (const Cell& cell : cells_) by_colour_[is_red(cell) ? red++ : black++] = cell;
    cells_.swap(by_colour_);
  }

  bool is_in_box(const Cell& cell) const { return is_in_box(cell, Axes{}); }
  template <std::size_t... k>
  bool is_in_box(const Cell& cell, std::index_sequence<k...>) const {
    return ((static_cast<std::uint64_t>(cell[k]) - static_cast<std::uint64_t>(lower_[k]) <
             static_cast<std::uint64_t>(extent_[k])) &&
            ...);
  }
  Index table_index(const Cell& cell) const { return table_index(cell, Axes{}); }
  template <std::size_t... k>
  Index table_index(const Cell& cell, std::index_sequence<k...>) const {
    return static_cast<Index>((((cell[k] - lower_[k]) * stride_[k]) + ...));
  }

  CellOrder order_ = CellOrder::plain;
  Buffer<Cell> cells_;
  Buffer<Cell> by_colour_;
  Buffer<std::uint32_t> table_;  // numbers of the cells of the bounding box
  Cell lower_{};
  std::array<std::int64_t, Dim> extent_{};
  std::array<std::int64_t, Dim> stride_{};  // in table_
  Index reds_ = 0;
  bool has_table_ = true;
};

}  // namespace silt
