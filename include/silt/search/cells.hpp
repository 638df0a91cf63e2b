// SPDX-License-Identifier: MIT
// Square cells on a lattice that is fixed in space, and the bins they are kept in.
//
// A cell's edge is the search radius and a trifle, [SahChoi2004] (1). The bins are a ring: cell
// (x, y, z) lies in bin x + y s_y + z s_z, modulo their number. Cells beside one another in a row
// are one range of bins, and the rows around a cell begin at the same few distances from any:
//
//     row y+1   . . [a a|b  |c c] . .      3 ranges in 2D, 9 in 3D, instead of 9 and 27 cells
//     row y     . . [d  |i  |   ] . .
//     row y-1   . . [   |e e|f  ] . .
//
// No cell lies at an edge: behind the last cell of a row comes the first of the next, a stranger
// that costs a distance test and never a pair. For the same reason the number of bins is O(N)
// whatever the extent. Where the particles' bounding box has more cells, far ones share a bin;
// their number is then prime, so that a line of particles in any direction fills the whole ring.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace silt {

template <int Dim, class Real>
class Cells {
 public:
  using Vec = silt::Vec<Dim, Real>;
  /// Lower and upper corner of the points, and a typical one.
  struct Extent {
    Vec lower;
    Vec upper;
    Vec middle;
  };
  void lay(const Extent& extent, Index points, Real reach) {
    // Rounding must not put a pair two cells apart: along() rounds by 2⁻²² of an edge, and a
    // distance in single precision is good to 2⁻²¹.
    const double edge = double(reach) * (1 + 0x1p-18);
    per_edge_ = 1 / edge;
    // Far from the origin the lattice is anchored nearer by, in great leaps: else it would move
    // with the particles.
    const double leap = edge * 0x1p20;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double middle = double(extent.middle[static_cast<int>(k)]);
      const double anchor = leap * std::round(middle / leap);
      anchor_[k] = is_finite(anchor) ? anchor : middle;
    }
    lower_.fill(0);
    for (std::size_t k = 0; k < Dim; ++k) lower_[k] = along(extent.lower, k);

    // Three along each axis, so that what lies around a cell never meets itself around the ring.
    std::array<std::int64_t, Dim> cells;
    double product = 1;
    for (std::size_t k = 0; k < Dim; ++k) {
      cells[k] = std::max<std::int64_t>(std::int64_t{along(extent.upper, k)} + 1, 3);
      product *= double(cells[k]);
    }
    const bool beyond = *std::max_element(cells.begin(), cells.end()) > farthest;
    shared_ = beyond || product > std::min(16.0 * double(points) + 64, 4e9);
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

  Index bins() const noexcept { return static_cast<Index>(bins_); }
  /// Whether far cells share bins.
  bool shared() const noexcept { return shared_; }
  /// Bin of the cell that x lies in, wherever that is.
  Index bin_of(const Vec& x) const {
    std::int64_t bin = 0;
    for (std::size_t k = 0; k < Dim; ++k) bin += std::int64_t{along(x, k)} * stride_[k];
    if (bin < 0 || bin >= bins_) {
      bin %= bins_;
      if (bin < 0) bin += bins_;
    }
    return static_cast<Index>(bin);
  }
  /// The same for x within the extent where no bins are shared: in 32 bits, for many at a time.
  std::uint32_t bin_of_its_own(const Vec& x) const {
    std::uint32_t bin = 0;
    for (std::size_t k = 0; k < Dim; ++k) {
      bin += static_cast<std::uint32_t>(along(x, k)) * static_cast<std::uint32_t>(stride_[k]);
    }
    return bin;
  }

  /// Cells of a row, at most `most` of them and the first that of x, whose surroundings do not meet
  /// themselves around the ring.
  Index block_from(const Vec& x, std::int64_t most) const {
    return static_cast<Index>(std::min({most, stride_[1] - along(x, 0), stride_[1] - 2}));
  }

  /// f(first, last) for every range of bins, `last` not included, around `length` cells of a row
  /// that begin with this bin.
  template <class F>
  void for_each_range_around(Index bin, Index length, F&& f) const {
    for (const std::int64_t row : rows_) {
      for_each_range_from(static_cast<std::int64_t>(bin) + row - 1,
                          static_cast<std::int64_t>(length) + 2, f);
    }
  }

  /// f(first, last) for every range of bins around x that may have points closer than `distance`,
  /// which may be many cells: all bins, where they are that many.
  template <class F>
  void for_each_range_within(const Vec& x, Real distance, F&& f) const {
    const double cells = std::ceil(double(distance) * (1 + 0x1p-18) * per_edge_);
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

  /// Those of for_each_range_around without the bins in front of this one, where none are shared.
  template <class F>
  void for_each_range_onwards(Index bin, Index length, F&& f) const {
    f(bin, std::min(bin + length + 1, bins()));
    for (std::size_t r = rows_.size() / 2 + 1; r < rows_.size(); ++r) {
      const Index first = bin + static_cast<Index>(rows_[r]) - 1;
      f(std::min(first, bins()), std::min(first + length + 2, bins()));
    }
  }

 private:
  // So many bins of the ring from `first` on, which is less than a round away: one range, or two.
  template <class F>
  void for_each_range_from(std::int64_t first, std::int64_t length, F&& f) const {
    if (first < 0) first += bins_;
    if (first >= bins_) first -= bins_;
    const std::int64_t last = first + length;
    f(static_cast<Index>(first), static_cast<Index>(std::min(last, bins_)));
    if (last > bins_) f(Index{0}, static_cast<Index>(last - bins_));
  }

  // What is more than 2³⁰ cells away lies in the outermost cell.
  static constexpr std::int32_t farthest = (1 << 30) - 1;

  // Cell that x lies in along axis k, counted from the lower corner.
  std::int32_t along(const Vec& x, std::size_t k) const {
    const double at = (double(x[static_cast<int>(k)]) - anchor_[k]) * per_edge_;
    const double near = std::min(std::max(at, -double(farthest)), double(farthest));
    // From below 0 the conversion to a whole number would round upwards.
    return static_cast<std::int32_t>(near + farthest) - lower_[k];
  }

  // How far the rows around a cell are from its own, in rising order.
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
  double per_edge_ = 0;
  std::array<std::int32_t, Dim> lower_{};
  std::int64_t bins_ = 0;
  bool shared_ = false;
  std::array<std::int64_t, Dim> cells_{};  // along each axis
  std::array<std::int64_t, Dim> stride_{};
  std::array<std::int64_t, Dim == 2 ? 3 : 9> rows_{};
};

}  // namespace silt
