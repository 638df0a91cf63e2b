// SPDX-License-Identifier: MIT
// Sparse matrix whose entries are clustered within a row, as for particles sorted in space: a row
// is stored as windows of two consecutive columns, with a zero where there is one entry.
//
//   entries   5:a  6:b  8:c  40:d
//   windows   at 5 [a b]   at 8 [c 0]   at 40 [d 0]
//
// A product reads contiguous runs of x and needs no index for each entry. Entries are stored in
// single precision, which halves the memory read; the product is computed in double. Its time is
// proportional to the memory read, for fluid in 3D, with 31 entries in a row: with columns of 16
// bits, 223 bytes of a row; windows of four take 286, of eight more.
//
// Rows are stored in the order of their numbers of windows, so that the processor can predict the
// end of the loop over them, and in groups of four, of which one register holds a window each:
//
//   rows 7, 2, 0, 3   windows of row 7, row 2, row 0, row 3, row 7, …
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/window_products.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>

namespace silt {

/// A matrix by its entries that are not zero.
class WindowRows {
 public:
  /// Number of columns of a window.
  static constexpr Index window_size = 2;

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
    if (x.size() < window_size) {
      for (Index i = first_row; i < last_row; ++i) f(i, narrow_product(i, x));
      return;
    }
    const RowSet& rows = sets_[first_row / rows_together];
    const RowSet& next = last_row < size_ ? sets_[last_row / rows_together] : rows;
    std::array<double, rows_together> product;
    if (rows.has_far_columns) {
      rows.multiply(rows.far, next.far, next, x.data(), product.data());
    } else {
      rows.multiply(rows.near, next.near, next, x.data(), product.data());
    }
    for (Index i = first_row; i < last_row; ++i) f(i, product[i - first_row]);
  }

  /// f(column, value) for every nonzero entry of a row.
  template <class F>
  void for_each_entry(Index row, F&& f) const {
    const RowSet& rows = sets_[row / rows_together];
    const Place place = rows.place[row % rows_together];
    for (Index window = 0; window < place.windows; ++window) {
      const Index at = place.first + group * window;
      for (Index offset = 0; offset < window_size; ++offset) {
        const float value = rows.values[at * window_size + offset];
        if (value != 0) f(rows.column(at) + offset, double(value));
      }
    }
  }

  /// Whether a row has a nonzero entry in a marked column; searches from the last column on.
  bool has_entry_in(Index row, std::span<const std::uint8_t> marked) const {
    const RowSet& rows = sets_[row / rows_together];
    const Place place = rows.place[row % rows_together];
    for (Index window = place.windows; window-- > 0;) {
      const Index at = place.first + group * window;
      const Index column = rows.column(at);
      for (Index offset = 0; offset < window_size && column + offset < marked.size(); ++offset) {
        if (marked[column + offset] && rows.values[at * window_size + offset] != 0) return true;
      }
    }
    return false;
  }

 private:
  // Number of rows whose windows alternate.
  static constexpr Index group = 4;

  // The windows of a row: the first of its group's, and every fourth after it.
  struct Place {
    std::uint32_t first;
    std::uint32_t windows;
  };
  // Those of the rows stored together.
  struct RowSet {
    Buffer<Place> place;              // by row
    Buffer<detail::EqualRows> equal;  // from few windows to many
    Buffer<std::uint8_t> row;         // four for each group; the last row may occur several times
    Index first_column = 0;           // the lowest one
    bool has_far_columns = false;
    Buffer<std::uint16_t> near;  // columns of the windows, minus the first one
    Buffer<std::uint32_t> far;   // the same, if 16 bits are too few
    Buffer<float> values;

    Index column(Index at) const { return first_column + (has_far_columns ? far[at] : near[at]); }

    template <class Column>
    void multiply(const Buffer<Column>& columns, const Buffer<Column>& next_columns,
                  const RowSet& next, const double* x, double* product) const {
      detail::multiply_windows<Column>()(
          {equal.data(), equal.size(), row.data(), columns.data(), values.data(), first_column,
           next_columns.data(), next.values.data()},
          x, product);
    }
  };

  // The windows of some rows one row after the other, before they are stored.
  struct Windows {
    Buffer<std::uint32_t> first;  // window of each row
    Buffer<std::uint32_t> columns;
    Buffer<float> values;

    [[gnu::noinline]] void grow() {
      const Index size = 2 * columns.size() + 1024;
      values.resize(size * window_size);
      columns.resize(size);
    }
    Index of_row(Index k) const { return first[k + 1] - first[k]; }
  };

  // Builds the rows of one set. All of f is inlined, or the window that is being filled would be
  // kept in memory instead of registers.
  template <class F>
  [[gnu::flatten]] void fill(Index first, Index last, Index last_window, F& f) {
    static thread_local Windows of_thread;
    Windows& filled = of_thread;
    filled.first.clear();
    std::uint32_t* columns = filled.columns.data();
    Index capacity = filled.columns.size();
    Index windows = 0;
    Index lowest = last_window;
    Index highest = 0;
    for (Index i = first; i < last; ++i) {
      filled.first.push_back(static_cast<std::uint32_t>(windows));
      Index at = 0;             // first column of the window that is being filled
      float* values = nullptr;  // its values
      f(i, [&](Index column, double value) {
        if (!values || column - at >= window_size) {  // also if column < at
          at = std::min(column, last_window);
          lowest = std::min(lowest, at);
          highest = std::max(highest, at);
          if (windows == capacity) {
            filled.grow();
            columns = filled.columns.data();
            capacity = filled.columns.size();
          }
          columns[windows] = static_cast<std::uint32_t>(at);
          values = filled.values.data() + windows++ * window_size;
          values[0] = values[1] = 0;
        }
        values[column - at] += static_cast<float>(value);
      });
    }
    filled.first.push_back(static_cast<std::uint32_t>(windows));
    RowSet& set = sets_[first / rows_together];
    set.first_column = lowest;
    set.has_far_columns = highest > lowest + std::numeric_limits<std::uint16_t>::max();
    store_in_groups(filled, set);
  }

  [[gnu::noinline]] static void store_in_groups(const Windows& filled, RowSet& set) {
    const Index rows = filled.first.size() - 1;
    sort_by_length(filled, set.row);
    while (set.row.size() % group != 0) set.row.push_back(set.row.back());
    set.equal.clear();
    set.place.resize(rows);
    Index stored = 0;
    for (Index first = 0; first < set.row.size(); first += group) {
      const Index longest = filled.of_row(set.row[first + group - 1]);
      if (set.equal.empty() || set.equal.back().windows != longest) {
        set.equal.push_back({0, static_cast<std::uint32_t>(longest)});
      }
      ++set.equal.back().groups;
      for (Index k = 0; k < group; ++k) {
        const Index row = set.row[first + k];
        set.place[row] = {static_cast<std::uint32_t>(stored + k),
                          static_cast<std::uint32_t>(filled.of_row(row))};
      }
      stored += group * longest;
    }
    resize(set.values, stored * window_size);
    if (set.has_far_columns) {
      set.near.clear();
      store_windows(filled, set, set.far, stored);
    } else {
      set.far.clear();
      store_windows(filled, set, set.near, stored);
    }
  }

  template <class Column>
  static void store_windows(const Windows& filled, RowSet& set, Buffer<Column>& columns,
                            Index stored) {
    resize(columns, stored);
    Column* column = columns.data();
    float* value = set.values.data();
    const auto first_column = static_cast<std::uint32_t>(set.first_column);
    for (Index first = 0; first < set.row.size(); first += group) {
      const Index longest = filled.of_row(set.row[first + group - 1]);
      for (Index k = 0; k < group; ++k) {
        const Index row = set.row[first + k];
        const Index windows = filled.of_row(row);
        const std::uint32_t* const from_column = filled.columns.data() + filled.first[row];
        const float* const from_value = filled.values.data() + filled.first[row] * window_size;
        for (Index window = 0; window < windows; ++window) {
          const Index to = group * window + k;
          column[to] = static_cast<Column>(from_column[window] - first_column);
          std::memcpy(value + to * window_size, from_value + window * window_size,
                      window_size * sizeof(float));
        }
        for (Index window = windows; window < longest; ++window) {
          const Index to = group * window + k;
          column[to] = 0;
          std::fill_n(value + to * window_size, window_size, 0.0f);
        }
      }
      column += group * longest;
      value += group * longest * window_size;
    }
  }

  // The numbers of the rows, from few windows to many.
  static void sort_by_length(const Windows& filled, Buffer<std::uint8_t>& row) {
    constexpr Index lengths = 128;
    const Index rows = filled.first.size() - 1;
    row.resize(rows);
    std::array<std::uint16_t, lengths + 1> first{};
    for (Index k = 0; k < rows; ++k) {
      if (filled.of_row(k) >= lengths) {  // where particles are crowded
        std::iota(row.begin(), row.end(), std::uint8_t(0));
        std::ranges::stable_sort(row, {}, [&](Index each) { return filled.of_row(each); });
        return;
      }
      ++first[filled.of_row(k) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (Index k = 0; k < rows; ++k) row[first[filled.of_row(k)]++] = static_cast<std::uint8_t>(k);
  }

  // With a margin, so that steps with slightly more windows need no memory of their own.
  template <class T>
  static void resize(Buffer<T>& values, Index size) {
    if (size > values.capacity()) values.reserve(size + size / 8);
    values.resize(size);
  }

  double narrow_product(Index row, std::span<const double> x) const {
    double sum = 0;
    for_each_entry(row, [&](Index column, double value) { sum += value * x[column]; });
    return sum;
  }

  Index size_ = 0;
  Buffer<RowSet> sets_;
};

}  // namespace silt
