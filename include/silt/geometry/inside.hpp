// SPDX-License-Identifier: MIT
// Which points are inside of a closed surface.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace silt {

/// How often closed faces go around a point x [m] [-]: ±1 inside, 0 outside, and, for a surface
/// with holes, the share of all directions in which it is seen. In space the solid angle of
/// [VanOosteromStrackee1983].
template <int Dim>
double winding_number(const std::vector<Face<Dim>>& faces, const Vec<Dim>& x) {
  double sum = 0;
  for (const Face<Dim>& face : faces) {
    if constexpr (Dim == 2) {
      const Vec<2> a = face.corners[0] - x, b = face.corners[1] - x;
      sum += std::atan2(cross(a, b), a.dot(b)) / (2 * std::numbers::pi);
    } else {
      const Vec<3> a = face.corners[0] - x, b = face.corners[1] - x, c = face.corners[2] - x;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      sum += std::atan2(a.dot(cross(b, c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb) /
             (2 * std::numbers::pi);
    }
  }
  return sum;
}

/// Whether a point x [m] is inside of closed faces, whose normals are all outwards or all inwards.
template <int Dim>
bool is_inside(const std::vector<Face<Dim>>& faces, const Vec<Dim>& x) {
  return std::abs(winding_number(faces, x)) > 0.5;
}

/// The distance of a point x from the nearest of the faces [m]; infinite if there are none.
template <int Dim>
double distance_from(const std::vector<Face<Dim>>& faces, const Vec<Dim>& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Face<Dim>& face : faces) {
    least = std::min(least, (x - nearest_of(face, x)).norm());
  }
  return least;
}

}  // namespace silt
