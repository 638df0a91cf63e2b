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
#include <silt/linear/row_windows.hpp>
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
  /// The same with another number of columns. Columns within 2^15 of the number of their row take half
  /// the memory for it.
  template <class F>
  void build(Index n, Index columns, F&& f) {
    size_ = n;
    sets_.resize(row_sets(n));
    for_each_range<rows_together>(n,
                                  [&](Index first, Index last) { fill(first, last, columns, f); });
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
    Index first_column = 0;           // none is lower
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

  // The windows of some rows one row after the other, before they are stored; columns minus
  // first_column of the set, modulo 2^32.
  struct Windows {
    static constexpr Index margin = detail::RowEntries::margin;

    std::array<std::uint32_t, rows_together + 1> first;  // window of each row
    Index rows;
    Buffer<std::uint32_t> columns;
    Buffer<float> values;
    // Entries of one row, behind a margin.
    Buffer<std::uint32_t> entry_columns;
    Buffer<float> entry_values;

    [[gnu::noinline]] void reserve(Index windows) {
      values.resize(2 * windows * window_size);
      columns.resize(2 * windows);
    }
    [[gnu::noinline]] void grow_entries() {
      const Index size = 2 * entry_columns.size() + 128;
      entry_values.resize(size);
      entry_columns.resize(size);
    }
    Index of_row(Index k) const { return first[k + 1] - first[k]; }
  };

  // Builds the rows of one set. All of f is inlined, or there would be a call for every entry.
  template <class F>
  [[gnu::flatten]] void fill(Index first, Index last, Index columns, F& f) {
    static thread_local Windows of_thread;
    Windows& filled = of_thread;
    constexpr Index margin = Windows::margin;
    const auto find_windows = detail::find_row_windows();
    const Index last_window =
        columns > window_size ? columns - window_size : 0;  // none reaches beyond the last column
    const auto first_column = static_cast<std::uint32_t>(first_of_near_columns(first, columns));
    if (filled.entry_columns.empty()) filled.grow_entries();
    Index windows = 0;
    std::uint32_t offsets = 0;
    for (Index i = first; i < last; ++i) {
      filled.first[i - first] = static_cast<std::uint32_t>(windows);
      Index end = margin;
      Index end_of_memory = filled.entry_columns.size() - margin;
      std::uint32_t* column_of = filled.entry_columns.data();
      float* value_of = filled.entry_values.data();
      f(i, [&](Index column, double value) {
        column_of[end] = static_cast<std::uint32_t>(column);
        value_of[end] = static_cast<float>(value);
        if (++end == end_of_memory) [[unlikely]] {
          filled.grow_entries();
          end_of_memory = filled.entry_columns.size() - margin;
          column_of = filled.entry_columns.data();
          value_of = filled.entry_values.data();
        }
      });
      const Index count = end - margin;
      const Index most_windows = windows + count + margin;
      if (most_windows > filled.columns.size()) filled.reserve(most_windows);
      windows += find_windows({.column = column_of + margin,
                               .value = value_of + margin,
                               .count = count,
                               .last_window = last_window,
                               .first_column = first_column},
                              {.column = filled.columns.data() + windows,
                               .value = filled.values.data() + windows * window_size},
                              offsets);
    }
    filled.rows = last - first;
    filled.first[filled.rows] = static_cast<std::uint32_t>(windows);
    RowSet& set = sets_[first / rows_together];
    set.has_far_columns = offsets >= near_columns;
    set.first_column = first_column;
    store_in_groups(filled, set);
  }

  // Number of columns that 16 bits distinguish.
  static constexpr Index near_columns = Index(std::numeric_limits<std::uint16_t>::max()) + 1;
  // From here on, they are about as many in front of a row as behind it.
  static Index first_of_near_columns(Index row, Index columns) {
    const Index in_front = row > near_columns / 2 ? row - near_columns / 2 : 0;
    return std::min(in_front, columns > near_columns ? columns - near_columns : 0);
  }

  [[gnu::noinline]] static void store_in_groups(const Windows& filled, RowSet& set) {
    const Index rows = filled.rows;
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
      const auto first_column = static_cast<std::uint32_t>(set.first_column);
      set.first_column = 0;
      store_windows(filled, set, set.far, stored, first_column);
    } else {
      set.far.clear();
      store_windows(filled, set, set.near, stored, 0);
    }
  }

  template <class Column>
  static void store_windows(const Windows& filled, RowSet& set, Buffer<Column>& columns,
                            Index stored, std::uint32_t first_column) {
    resize(columns, stored);
    Column* column = columns.data();
    float* value = set.values.data();
    const auto store = [&](Index window) {
      *column++ = static_cast<Column>(filled.columns[window] + first_column);
      std::memcpy(value, filled.values.data() + window * window_size, window_size * sizeof(float));
      value += window_size;
    };
    for (const std::uint8_t* row = set.row.begin(); row != set.row.end(); row += group) {
      std::array<Index, group> window;
      std::array<Index, group> end;
      for (Index k = 0; k < group; ++k) {
        window[k] = filled.first[row[k]];
        end[k] = filled.first[Index(row[k]) + 1];
      }
      while (window[0] != end[0]) {  // the shortest row
        for (Index& of_row : window) store(of_row++);
      }
      while (window[group - 1] != end[group - 1]) {
        for (Index k = 0; k < group; ++k) {
          if (window[k] != end[k]) {
            store(window[k]++);
          } else {
            // A column of the row: one that is not finite elsewhere must not reach it.
            const bool is_empty = end[k] == filled.first[row[k]];
            *column++ = is_empty ? Column(0)
                                 : static_cast<Column>(filled.columns[end[k] - 1] + first_column);
            value = std::fill_n(value, window_size, 0.0f);
          }
        }
      }
    }
  }

  // The numbers of the rows, from few windows to many.
  static void sort_by_length(const Windows& filled, Buffer<std::uint8_t>& row) {
    constexpr Index lengths = 128;
    const Index rows = filled.rows;
    row.resize(rows);
    std::array<std::uint16_t, lengths + 1> first{};
    for (Index k = 0; k < rows; ++k) {
      if (filled.of_row(k) >= lengths) return insert_by_length(filled, row);
      ++first[filled.of_row(k) + 1];
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (Index k = 0; k < rows; ++k) row[first[filled.of_row(k)]++] = static_cast<std::uint8_t>(k);
  }

  // The same where particles are crowded. std::stable_sort takes longer to compile than it saves.
  static void insert_by_length(const Windows& filled, Buffer<std::uint8_t>& row) {
    for (Index k = 0; k < row.size(); ++k) {
      Index at = k;
      for (; at > 0 && filled.of_row(row[at - 1]) > filled.of_row(k); --at) row[at] = row[at - 1];
      row[at] = static_cast<std::uint8_t>(k);
    }
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
