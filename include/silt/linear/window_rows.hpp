// SPDX-License-Identifier: MIT
// Sparse matrix whose entries are clustered within a row, as for particles sorted in space: a row
// is stored as windows of four consecutive columns, with zeros between the entries.
//
//   entries   5:a  6:b  8:c  40:d
//   windows   at 5 [a b 0 c]   at 40 [d 0 0 0]
//
// A product reads contiguous runs of x and needs no index for each entry. Entries are stored in
// single precision, which halves the memory read; the product is computed in double. Its time is
// proportional to the memory read: for fluid in 3D, with 31 entries in a row, windows of four take
// a third less memory and time than windows of eight.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

namespace silt {

/// A matrix by its entries that are not zero.
class WindowRows {
 public:
  /// Number of columns of a window.
  static constexpr Index window_size = 4;

  /// Builds a matrix of n rows and n columns: f(i, add) calls add(column, value) for the entries of row i,
  /// and values of the same column are summed. Columns may be in any order; ascending order gives
  /// the fewest windows. Memory of earlier builds is reused.
  template <class F>
  void build(Index n, F&& f) {
    build(n, n, f);
  }
  /// The same with another number of columns.
  template <class F>
  void build(Index n, Index columns, F&& f) {
    size_ = n;
    sets_.resize(row_sets(n));
    const Index last_window =
        columns > window_size ? columns - window_size : 0;  // none reaches beyond the last column
    for_each_range<rows_together>(
        n, [&](Index first, Index last) { fill(first, last, last_window, f); });
  }

  /// Number of rows.
  Index size() const noexcept { return size_; }

  /// f(i, Σ_j a_ij x_j) for the rows of one range of rows_together; x has an element for each column.
  template <class F>
  void multiply(Index first_row, Index last_row, std::span<const double> x, F&& f) const {
    const RowSet& rows = sets_[first_row / rows_together];
    const RowSet& next = last_row < size_ ? sets_[last_row / rows_together] : rows;
    if (x.size() < window_size) {
      for (Index i = first_row; i < last_row; ++i) f(i, narrow_product(i, x));
      return;
    }
    const std::uint32_t* const first = rows.first.data();
    const std::uint32_t* const columns = rows.columns.data();
    const float* const values = rows.values.data();
    const double* const factors = x.data();
    const Index windows = first[last_row - first_row];
    for (Index i = first_row; i < last_row; ++i) {
      const Index begin = first[i - first_row];
      const Index end = first[i - first_row + 1];
      // Rows are read once, in order; the hardware prefetcher detects this too late.
      const Index ahead = begin + 256;
      const bool is_here = ahead < windows;
      const std::uintptr_t soon =
          is_here ? address(values, ahead * window_size)
                  : address(next.values.data(), (ahead - windows) * window_size);
      for (Index line = 0; line < 4; ++line) prefetch(soon + 64 * line);
      prefetch(is_here ? address(columns, ahead) : address(next.columns.data(), ahead - windows));
      simd::Pack<double, 4> sum{};
      for (Index window = begin; window < end; ++window) {
        simd::add_products(values + window * window_size, factors + columns[window], sum);
      }
      f(i, (sum[0] + sum[2]) + (sum[1] + sum[3]));
    }
  }

  /// f(column, value) for every nonzero entry of a row.
  template <class F>
  void for_each_entry(Index row, F&& f) const {
    const RowSet& rows = sets_[row / rows_together];
    const Index k = row % rows_together;
    for (Index at = rows.first[k] * window_size; at < rows.first[k + 1] * window_size; ++at) {
      if (rows.values[at] != 0) f(rows.column(at), double(rows.values[at]));
    }
  }

  /// Whether a row has a nonzero entry in a marked column; searches from the last column on.
  bool has_entry_in(Index row, std::span<const std::uint8_t> marked) const {
    const RowSet& rows = sets_[row / rows_together];
    const Index k = row % rows_together;
    for (Index window = rows.first[k + 1]; window-- > rows.first[k];) {
      const Index column = rows.columns[window];
      std::array<std::uint8_t, window_size> marks{};
      std::copy_n(marked.begin() + static_cast<std::ptrdiff_t>(column),
                  std::min(window_size, marked.size() - column), marks.begin());
      for (Index offset = 0; offset < window_size; ++offset) {
        if (marks[offset] && rows.values[window * window_size + offset] != 0) return true;
      }
    }
    return false;
  }

 private:
  // Windows of the rows stored together.
  struct RowSet {
    Buffer<std::uint32_t> first;    // window of each row
    Buffer<std::uint32_t> columns;  // of each window
    Buffer<float> values;

    // Appends a window and returns its values, set to zero.
    float* open_window(Index window, Index column) {
      // `values` grows last; it is shorter only if an allocation has failed before.
      if (window * window_size == values.size()) grow(window);
      columns[window] = static_cast<std::uint32_t>(column);
      float* const zeros = &values[window * window_size];
      std::fill_n(zeros, window_size, 0.0f);
      return zeros;
    }
    [[gnu::noinline]] void grow(Index window) {
      const Index size = window + window / 8 + window_size * window_size;
      columns.reserve(size);  // resize() alone would double it
      columns.resize(size);
      values.reserve(size * window_size);
      values.resize(size * window_size);
    }
    // Column of the value at this index.
    Index column(Index at) const { return columns[at / window_size] + at % window_size; }
  };

  // Builds the rows of one set. All of f is inlined, or the window that is being filled would be kept
  // in memory instead of registers.
  template <class F>
  [[gnu::flatten]] void fill(Index first, Index last, Index last_window, F& f) {
    RowSet& rows = sets_[first / rows_together];
    rows.first.clear();
    Index windows = 0;
    for (Index i = first; i < last; ++i) {
      rows.first.push_back(static_cast<std::uint32_t>(windows));
      Index at = 0;             // first column of the window that is being filled
      float* values = nullptr;  // its values
      f(i, [&](Index column, double value) {
        if (!values || column - at >= window_size) {  // also if column < at
          at = std::min(column, last_window);
          values = rows.open_window(windows++, at);
        }
        values[column - at] += static_cast<float>(value);
      });
    }
    rows.first.push_back(static_cast<std::uint32_t>(windows));
  }

  // An integer, because what is prefetched may be beyond the end of the array.
  template <class T>
  static std::uintptr_t address(const T* array, Index at) {
    return reinterpret_cast<std::uintptr_t>(array) + at * sizeof(T);
  }
  static void prefetch(std::uintptr_t at) { __builtin_prefetch(reinterpret_cast<const void*>(at)); }

  double narrow_product(Index row, std::span<const double> x) const {
    double sum = 0;
    for_each_entry(row, [&](Index column, double value) { sum += value * x[column]; });
    return sum;
  }

  Index size_ = 0;
  Buffer<RowSet> sets_;
};

}  // namespace silt
