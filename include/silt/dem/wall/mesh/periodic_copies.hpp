// SPDX-License-Identifier: MIT
// Surfaces that continue across the sides of a periodic box.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <vector>

namespace silt::dem {

/// The triangles and, shifted by one period of the box, copies of those that are then closer than
/// `distance` [m] to the box, for a MeshWall that grains touch across periodic sides: 1.2 times the
/// largest radius is far enough. Throws if distance or a period is not positive and finite.
template <class Real>
std::vector<Triangle<Real>> with_periodic_copies(std::vector<Triangle<Real>> triangles,
                                                 const Box<3, Real>& box, Real distance) {
  box.check();
  require_positive("with_periodic_copies: distance", double(distance));
  for (int k = 0; k < 3; ++k) {
    if (!box.periodic[Index(k)]) continue;
    const Index originals = triangles.size();
    for (const Real shift : {box.lower[k] - box.upper[k], box.upper[k] - box.lower[k]}) {
      for (Index t = 0; t < originals; ++t) {
        Triangle<Real> copy = triangles[t];
        for (auto& corner : copy.corners) corner[k] += shift;
        const auto& [a, b, c] = copy.corners;
        const bool is_above_lower = std::max({a[k], b[k], c[k]}) > box.lower[k] - distance;
        const bool is_below_upper = std::min({a[k], b[k], c[k]}) < box.upper[k] + distance;
        if (is_above_lower && is_below_upper) triangles.push_back(copy);
      }
    }
  }
  return triangles;
}

}  // namespace silt::dem
