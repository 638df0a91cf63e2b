// SPDX-License-Identifier: MIT
// Finds overlaps with grains that are added one by one. There is one grid per size class, and the
// cell size doubles from class to class; each grain is stored in a cell of the grid of its class. A
// query visits the few cells around it in every grid.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <vector>

namespace silt::dem {

/// A grain's outline.
template <int Dim, class Real>
struct Ball {
  Vec<Dim, Real> centre;  ///< [m]
  Real radius;            ///< [m]
};

template <int Dim, class Real>
class Occupancy {
 public:
  using Vec = silt::Vec<Dim, Real>;
  using Ball = dem::Ball<Dim, Real>;

  /// Only the periodic sides of the box matter.
  explicit Occupancy(const Box<Dim, Real>& box) : box_(box) {}

  void add(Ball ball) {
    ball.centre = box_.wrap(ball.centre);
    const int level = std::ilogb(ball.radius);
    levels_[level][key_of(cell_of(ball.centre, edge_of(level)))].push_back(ball);
  }

  /// Whether the ball overlaps none of the added grains.
  bool has_room_for(const Ball& ball) const {
    bool free = true;
    for_each_image(ball, [&](const Ball& image) { free = free && !overlaps(image); });
    return free;
  }

 private:
  using Cell = std::array<std::int64_t, Dim>;
  using Grid = std::unordered_map<std::uint64_t, std::vector<Ball>>;

  // Larger than the diameters of the level, in which 2^level ≤ R < 2^(level + 1).
  static Real edge_of(int level) { return std::ldexp(Real(4), level); }

  static Cell cell_of(const Vec& x, Real edge) {
    Cell cell;
    for (std::size_t k = 0; k < Dim; ++k) {
      const double x_k = double(x[static_cast<int>(k)]);
      cell[k] = static_cast<std::int64_t>(std::floor(x_k / double(edge)));
    }
    return cell;
  }
  // Distant cells may share a key: this costs distance tests but does not change the result.
  static std::uint64_t key_of(const Cell& cell) {
    std::uint64_t key = 0;
    for (const std::int64_t part : cell) {
      key = (key ^ static_cast<std::uint64_t>(part)) * 0x9E3779B97F4A7C15u;
    }
    return key;
  }

  // The ball and its periodic images that may reach into the box.
  template <class F>
  void for_each_image(const Ball& ball, F&& f) const {
    if (levels_.empty()) return;
    const Real reach = ball.radius + edge_of(levels_.rbegin()->first) / 2;
    std::vector<Ball> images{{box_.wrap(ball.centre), ball.radius}};
    for (int k = 0; k < Dim; ++k) {
      if (!box_.periodic[static_cast<std::size_t>(k)]) continue;
      const Real side = box_.upper[k] - box_.lower[k];
      for (std::size_t known = images.size(), n = 0; n < known; ++n) {
        for (const Real shift : {-side, side}) {
          Ball image = images[n];
          image.centre[k] += shift;
          if (image.centre[k] < box_.lower[k] - reach) continue;
          if (image.centre[k] > box_.upper[k] + reach) continue;
          images.push_back(image);
        }
      }
    }
    for (const Ball& image : images) f(image);
  }

  bool overlaps(const Ball& ball) const {
    for (const auto& [level, grid] : levels_) {
      const Real edge = edge_of(level);
      const Vec reach = Vec::Constant(ball.radius + edge / 2);
      const Cell low = cell_of(ball.centre - reach, edge);
      const Cell high = cell_of(ball.centre + reach, edge);
      if (overlaps_in(grid, low, high, ball)) return true;
    }
    return false;
  }

  static bool overlaps_in(const Grid& grid, const Cell& low, const Cell& high, const Ball& ball) {
    for (Cell cell = low; cell[Dim - 1] <= high[Dim - 1];) {
      if (const auto found = grid.find(key_of(cell)); found != grid.end()) {
        for (const Ball& other : found->second) {
          const Real apart = ball.radius + other.radius;
          if ((other.centre - ball.centre).squaredNorm() < apart * apart) return true;
        }
      }
      ++cell[0];
      for (std::size_t k = 0; k + 1 < Dim && cell[k] > high[k]; ++k) {
        cell[k] = low[k];
        ++cell[k + 1];
      }
    }
    return false;
  }

  Box<Dim, Real> box_;
  std::map<int, Grid> levels_;  // key: the power of 2 of the radius
};

}  // namespace silt::dem
