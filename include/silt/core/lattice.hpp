// SPDX-License-Identifier: MIT
// Points of a square (cubic) lattice.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace silt {

/// Centres of the cells of edge `spacing` [m] that fill the box from its lower corner, x fastest.
/// Along each axis as many as fit; a last cell that sticks out by less than a millionth is in.
/// Throws if the spacing is not positive or the box not finite.
template <int Dim, class Real = double>
std::vector<Vec<Dim, Real>> lattice(const Box<Dim, Real>& box, Real spacing) {
  require_positive("lattice: spacing", double(spacing));
  require_finite("lattice: lower", box.lower);
  require_finite("lattice: upper", box.upper);
  std::array<Index, 3> count{1, 1, 1};
  for (int k = 0; k < Dim; ++k) {
    const double cells = std::floor(double((box.upper[k] - box.lower[k]) / spacing) + 1e-6);
    if (!(cells < 1e9)) {
      fail("lattice: " + to_text(cells) + " cells along axis " + std::to_string(k) +
           " are more than 1e9; enlarge the spacing");
    }
    count[static_cast<std::size_t>(k)] = cells > 0 ? static_cast<Index>(cells) : 0;
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
