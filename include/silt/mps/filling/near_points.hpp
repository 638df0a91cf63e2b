// SPDX-License-Identifier: MIT
// A neighbour search for the points of a pool.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt::mps::detail {

/// Finds points that are closer to each other than a radius, by cells. Those of a pool are in a
/// compact region without periodic sides.
template <int Dim>
class NearPoints {
 public:
  using Vec = silt::Vec<Dim>;

  /// The points x and the radius [m].
  template <class Points>
  void sort(const Points& x, double radius) {
    radius_ = radius;
    points_.assign(x.begin(), x.end());
    if (points_.empty()) return;
    Vec upper = points_[0];
    lower_ = points_[0];
    for (const Vec& point : points_) {
      lower_ = lower_.cwiseMin(point);
      upper = upper.cwiseMax(point);
    }
    Index cells = 1;
    for (int k = 0; k < Dim; ++k) {
      size_[k] = int((upper[k] - lower_[k]) / radius) + 1;
      cells *= Index(size_[k]);
    }
    first_.assign(cells + 1, 0);
    for (const Vec& point : points_) ++first_[index_of(cell_of(point)) + 1];
    for (Index c = 0; c < cells; ++c) first_[c + 1] += first_[c];
    Buffer<std::uint32_t> next(first_.begin(), first_.end());
    items_.resize(points_.size());
    for (Index i = 0; i < points_.size(); ++i) {
      items_[next[index_of(cell_of(points_[i]))]++] = std::uint32_t(i);
    }
  }

  /// f(j, x_j − x_i, distance) [m].
  template <class F>
  void for_each_neighbour(Index i, F&& f) const {
    const Vec& x = points_[i];
    const Cell middle = cell_of(x);
    constexpr int around = Dim == 2 ? 9 : 27;
    for (int n = 0; n < around; ++n) {
      Cell cell = middle;
      bool is_inside = true;
      for (int k = 0, rest = n; k < Dim; ++k, rest /= 3) {
        cell[k] += rest % 3 - 1;
        is_inside = is_inside && cell[k] >= 0 && cell[k] < size_[k];
      }
      if (!is_inside) continue;
      const Index c = index_of(cell);
      for (std::uint32_t k = first_[c]; k < first_[c + 1]; ++k) {
        const Index j = items_[k];
        const Vec r_ij = points_[j] - x;
        const double r2 = r_ij.squaredNorm();
        if (j != i && r2 < squared(radius_)) f(j, r_ij, std::sqrt(r2));
      }
    }
  }

 private:
  using Cell = Eigen::Matrix<int, Dim, 1>;

  Cell cell_of(const Vec& x) const {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      cell[k] = std::min(int((x[k] - lower_[k]) / radius_), size_[k] - 1);
    }
    return cell;
  }
  Index index_of(const Cell& cell) const {
    Index i = 0;
    for (int k = Dim; k-- > 0;) i = i * Index(size_[k]) + Index(cell[k]);
    return i;
  }

  double radius_ = 0;
  Vec lower_ = Vec::Zero();
  Cell size_ = Cell::Zero();
  Buffer<Vec> points_;
  Buffer<std::uint32_t> first_, items_;  // of each cell
};

}  // namespace silt::mps::detail
