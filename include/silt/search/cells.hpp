// SPDX-License-Identifier: MIT
// Square cells of a lattice that is fixed in space, and the bins that store them.
//
// The edge of a cell is slightly larger than the search radius, [SahChoi2004] (1). The bins form a
// ring: cell (x, y, z) is in bin x + y s_y + z s_z, modulo the number of bins. Adjacent cells of a
// row are a contiguous range of bins, and the rows around a cell have constant offsets:
//
//     row y+1   . . [a a|b  |c c] . .      3 ranges in 2D, 9 in 3D, instead of 9 and 27 cells
//     row y     . . [d  |i  |   ] . .
//     row y-1   . . [   |e e|f  ] . .
//
// No cell needs special treatment at a boundary: the last cell of a row is followed by the first
// cell of the next, whose particles need a distance test but never form a pair. For the same reason
// the number of bins is O(N) for any extent. If the bounding box of the particles has more cells,
// distant cells share a bin; the number of bins is then prime, so that a line of particles in any
// direction uses all bins.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/search/extent.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

namespace silt {

/// The lattice and its bins for a given search radius.
template <int Dim, class Real>
class Cells {
 public:
  using Vec = silt::Vec<Dim, Real>;
  using Extent = silt::Extent<Dim, Real>;

  /// Sets up the cells for so many points in this extent, with edge `reach` [m].
  void set_up(const Extent& extent, Index points, Real reach) {
    // After rounding, the particles of a pair must not be two cells apart: cell_along() has an
    // error of 2⁻²² of an edge, and a distance in single precision one of 2⁻²¹.
    const double edge = double(reach) * (1 + 0x1p-18);
    inverse_edge_ = 1 / edge;
    // Far from the origin the lattice is anchored near the particles, at multiples of a large
    // distance, because otherwise it would move with them.
    const double interval = edge * 0x1p20;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double middle = double(extent.middle[static_cast<int>(k)]);
      const double anchor = interval * std::round(middle / interval);
      anchor_[k] = is_finite(anchor) ? anchor : middle;
    }
    lower_.fill(0);
    for (std::size_t k = 0; k < Dim; ++k) lower_[k] = cell_along(extent.lower, k);

    // At least three along each axis, so that the ranges around a cell do not overlap on the ring.
    std::array<std::int64_t, Dim> cells;
    double product = 1;
    for (std::size_t k = 0; k < Dim; ++k) {
      cells[k] = std::max<std::int64_t>(std::int64_t{cell_along(extent.upper, k)} + 1, 3);
      product *= double(cells[k]);
    }
    shared_ = !are_near_anchor(extent) || product > std::min(16.0 * double(points) + 64, 4e9);
    if (shared_) {
      bins_ = prime_from(2 * static_cast<std::int64_t>(points) + 64);
      cells.fill(static_cast<std::int64_t>(std::pow(double(bins_), 1.0 / Dim)));
    } else {
      bins_ = static_cast<std::int64_t>(product);
    }
    cells_ = cells;
    stride_[0] = 1;
    for (std::size_t k = 1; k < Dim; ++k) stride_[k] = stride_[k - 1] * cells[k - 1];
    list_rows();
  }

  /// Number of bins.
  Index bins() const noexcept { return static_cast<Index>(bins_); }
  /// Whether distant cells share bins.
  bool shared() const noexcept { return shared_; }
  /// Bin of the cell that contains x [m], for any x.
  Index bin_of(const Vec& x) const {
    std::int64_t bin = 0;
    for (std::size_t k = 0; k < Dim; ++k) bin += cell_on_ring(x, k) * stride_[k];
    if (bin < 0 || bin >= bins_) {
      bin %= bins_;
      if (bin < 0) bin += bins_;
    }
    return static_cast<Index>(bin);
  }
  /// The same for x within the extent, if no bins are shared; in 32 bits and without limits, for
  /// vectorisation.
  std::uint32_t bin_in_extent(const Vec& x) const {
    std::uint32_t bin = 0;
    for (std::size_t k = 0; k < Dim; ++k) {
      bin += static_cast<std::uint32_t>(cell_at(coordinate_of(x, k), k)) *
             static_cast<std::uint32_t>(stride_[k]);
    }
    return bin;
  }

  /// Maximum length, at most `max_length`, of a block of cells of a row that begins at x such that
  /// the ranges around it do not overlap on the ring.
  Index max_block(const Vec& x, std::int64_t max_length) const {
    return static_cast<Index>(
        std::min({max_length, stride_[1] - cell_along(x, 0), stride_[1] - 2}));
  }

  /// f(first, last) for every range [first, last) of bins in and around a block of `length` cells
  /// of a row that begins at this bin.
  template <class F>
  void for_each_range_around(Index bin, Index length, F&& f) const {
    for (const std::int64_t row : rows_) {
      for_each_range_from(static_cast<std::int64_t>(bin) + row - 1,
                          static_cast<std::int64_t>(length) + 2, f);
    }
  }

  /// f(first, last) for every range of bins that may have points closer to x than `distance` [m],
  /// which may span many cells; all bins if it spans all cells along an axis.
  template <class F>
  void for_each_range_within(const Vec& x, Real distance, F&& f) const {
    const double cells = std::ceil(double(distance) * (1 + 0x1p-18) * inverse_edge_);
    if (2 * cells + 1 > double(*std::min_element(cells_.begin(), cells_.end()))) {
      f(Index{0}, bins());
      return;
    }
    const auto n = static_cast<std::int64_t>(cells);
    const auto bin = static_cast<std::int64_t>(bin_of(x));
    for (std::int64_t z = Dim == 3 ? -n : 0; z <= (Dim == 3 ? n : 0); ++z) {
      for (std::int64_t y = -n; y <= n; ++y) {
        for_each_range_from(bin + z * stride_[Dim - 1] + y * stride_[1] - n, 2 * n + 1, f);
      }
    }
  }

  /// The same as for_each_range_around without the bins before this one; if no bins are shared.
  template <class F>
  void for_each_range_forward(Index bin, Index length, F&& f) const {
    f(bin, std::min(bin + length + 1, bins()));
    for (std::size_t r = rows_.size() / 2 + 1; r < rows_.size(); ++r) {
      const Index first = bin + static_cast<Index>(rows_[r]) - 1;
      f(std::min(first, bins()), std::min(first + length + 2, bins()));
    }
  }

 private:
  // `length` bins of the ring from `first` on, as one range or two; −bins ≤ first < 2 bins.
  template <class F>
  void for_each_range_from(std::int64_t first, std::int64_t length, F&& f) const {
    if (first < 0) first += bins_;
    if (first >= bins_) first -= bins_;
    const std::int64_t last = first + length;
    f(static_cast<Index>(first), static_cast<Index>(std::min(last, bins_)));
    if (last > bins_) f(Index{0}, static_cast<Index>(last - bins_));
  }

  // Points more than 2³⁰ cells away are in the outermost cell, except for cell_on_ring().
  static constexpr std::int32_t max_cell = (1 << 30) - 1;

  // Whether no point is more than 2²⁹ cells away.
  bool are_near_anchor(const Extent& extent) const {
    bool near = true;
    for (std::size_t k = 0; k < Dim; ++k) {
      near &= coordinate_of(extent.lower, k) >= -double(max_cell) / 2;
      near &= coordinate_of(extent.upper, k) <= double(max_cell) / 2;
    }
    return near;
  }

  // Coordinate k of the cell that contains x, counted from the lower corner.
  std::int32_t cell_along(const Vec& x, std::size_t k) const {
    const double coordinate = coordinate_of(x, k);
    // In this order, NaN becomes a number: 0 over the least edge, if the edge underflows.
    return cell_at(std::min(std::max(-double(max_cell), coordinate), double(max_cell)), k);
  }
  // The same, modulo the number of bins for points more than 2³⁰ cells away. In the outermost cell
  // all points of a very large extent would be neighbours.
  std::int64_t cell_on_ring(const Vec& x, std::size_t k) const {
    const double coordinate = coordinate_of(x, k);
    if (std::abs(coordinate) < double(max_cell)) return cell_at(coordinate, k);
    constexpr double largest = std::numeric_limits<double>::max();
    const double cell = std::floor(std::min(std::max(-largest, coordinate), largest));
    return static_cast<std::int64_t>(std::fmod(cell, double(bins_))) + max_cell - lower_[k];
  }
  // In cells, from the anchor.
  double coordinate_of(const Vec& x, std::size_t k) const {
    return (double(x[static_cast<int>(k)]) - anchor_[k]) * inverse_edge_;
  }
  std::int32_t cell_at(double coordinate, std::size_t k) const {
    // Adding `max_cell` makes it positive, because the conversion rounds towards 0.
    return static_cast<std::int32_t>(coordinate + max_cell) - lower_[k];
  }

  // Offsets of the rows around a cell from its own row, ascending.
  void list_rows() {
    std::size_t r = 0;
    for (std::int64_t z = Dim == 3 ? -1 : 0; z <= (Dim == 3 ? 1 : 0); ++z) {
      for (std::int64_t y = -1; y <= 1; ++y) rows_[r++] = z * stride_[Dim - 1] + y * stride_[1];
    }
  }

  static std::int64_t prime_from(std::int64_t n) {
    const auto is_prime = [](std::int64_t candidate) {
      for (std::int64_t d = 2; d * d <= candidate; ++d) {
        if (candidate % d == 0) return false;
      }
      return true;
    };
    while (!is_prime(n)) ++n;
    return n;
  }

  std::array<double, Dim> anchor_{};
  double inverse_edge_ = 0;
  std::array<std::int32_t, Dim> lower_{};
  std::int64_t bins_ = 0;
  bool shared_ = false;
  std::array<std::int64_t, Dim> cells_{};  // number along each axis
  std::array<std::int64_t, Dim> stride_{};
  std::array<std::int64_t, Dim == 2 ? 3 : 9> rows_{};
};

}  // namespace silt
