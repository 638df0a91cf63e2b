// SPDX-License-Identifier: MIT
// A plane, solid on one side; in 2D a straight line.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>

#include <cmath>
#include <cstdint>

namespace silt::dem {

/// Half-space: everything behind the plane is solid. In 2D the plane is a line.
template <int Dim, class Real = double>
struct Plane {
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();          ///< any point of the plane [m]
  /// Out of the solid; any non-zero length [-].
  Vec<Dim, Real> normal = Vec<Dim, Real>::Unit(Dim - 1);
  std::uint32_t material = 0;                             ///< index in dem::Materials

  /// Normalises `normal`; throws if its length is 0.
  void check() {
    require_finite("Plane: point", point);
    require_finite("Plane: normal", normal);
    const Real largest = normal.cwiseAbs().maxCoeff();
    require_positive("Plane: length of the normal", double(largest));
    // By a power of two, so that the square of its length neither overflows nor underflows.
    const int exponent = std::ilogb(largest);
    for (Real& component : normal) component = std::ldexp(component, -exponent);
    normal.normalize();
  }

  /// Throws if the plane would break off at a periodic side of the grains' box; not if grains with
  /// centres in the box, up to this radius [m], are too far to touch it.
  void check_in(const Box<Dim, Real>& box, Real max_radius) const {
    Vec<Dim, Real> nearest_corner;
    for (int k = 0; k < Dim; ++k) {
      nearest_corner[k] = normal[k] > 0 ? box.lower[k] : normal[k] < 0 ? box.upper[k] : point[k];
    }
    if (nearest(nearest_corner).distance > max_radius) return;
    for (int k = 0; k < Dim; ++k) {
      if (!box.periodic[Index(k)] || std::abs(normal[k]) < Real(1e-6)) continue;
      fail({"Plane: the normal ", to_text(normal), " has a component along axis ", k,
            ", which is periodic in the grains' box: the plane would break off at its sides; make "
            "the axis non-periodic, or turn the plane"});
    }
  }

  NearestPoint<Dim, Real> nearest(const Vec<Dim, Real>& x) const {
    return {normal, (x - point).dot(normal)};
  }
};

}  // namespace silt::dem
