// SPDX-License-Identifier: MIT
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall.hpp>

#include <cstdint>

namespace silt::dem {

/// Half-space: everything behind the plane is solid. A line in 2D.
template <int Dim, class Real = double>
struct Plane {
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();  ///< any point of it [m]
  Vec<Dim, Real> normal = Vec<Dim, Real>::Unit(Dim - 1);  ///< out of the solid; any length but 0
  std::uint32_t material = 0;                             ///< place in dem::Materials

  /// Makes the normal a unit vector; throws if it has no length.
  void check() {
    require_finite("Plane: point", point);
    require_finite("Plane: normal", normal);
    require_positive("Plane: length of the normal", double(normal.norm()));
    normal.normalize();
  }

  NearestPoint<Dim, Real> nearest(const Vec<Dim, Real>& x) const {
    return {normal, (x - point).dot(normal)};
  }
};

}  // namespace silt::dem
