// SPDX-License-Identifier: MIT
// Points of a square (cubic) lattice.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace silt {

/// Centres of the cells of edge `spacing` [m] that fit into the box, from its lower corner; x
/// varies fastest. What is left at the upper sides, less than a cell, stays empty. A last cell that
/// exceeds the box by less than a millionth of its edge, or by a rounding error, is included.
/// Throws if the spacing is not positive, if the box is not finite, if no cell fits, or if there
/// are more than 1e8 points.
template <int Dim, class Real = double>
std::vector<Vec<Dim, Real>> lattice(const Box<Dim, Real>& box, Real spacing) {
  require_positive("lattice: spacing", double(spacing));
  require_finite("lattice: lower", box.lower);
  require_finite("lattice: upper", box.upper);
  box.check();
  std::array<Index, 3> count{1, 1, 1};
  double points_in_all = 1;
  for (int k = 0; k < Dim; ++k) {
    const double length = double(box.upper[k]) - double(box.lower[k]);
    const double rounding = 4 * double(std::numeric_limits<Real>::epsilon());
    const double cells = std::floor(length / double(spacing) * (1 + rounding) + 1e-6);
    if (cells < 1) {
      fail({"lattice: spacing = ", spacing, " m is longer than the box along axis ", k,
            ", from lower = ", box.lower, " to upper = ", box.upper,
            " m; decrease the spacing, or enlarge the box"});
    }
    points_in_all *= cells;
    if (!(cells <= 1e8) || !(points_in_all <= 1e8)) {
      fail({"lattice: spacing = ", spacing, " m gives more than 1e8 points from lower = ",
            box.lower, " to upper = ", box.upper, " m; increase the spacing"});
    }
    count[static_cast<std::size_t>(k)] = static_cast<Index>(cells);
  }
  std::vector<Vec<Dim, Real>> points;
  points.reserve(count[0] * count[1] * count[2]);
  for (Index z = 0; z < count[2]; ++z) {
    for (Index y = 0; y < count[1]; ++y) {
      for (Index x = 0; x < count[0]; ++x) {
        const std::array<Index, 3> cell{x, y, z};
        Vec<Dim, Real> point;
        for (int k = 0; k < Dim; ++k) {
          point[k] = box.lower[k] + (Real(cell[static_cast<std::size_t>(k)]) + Real(0.5)) * spacing;
        }
        points.push_back(point);
      }
    }
  }
  return points;
}

}  // namespace silt
