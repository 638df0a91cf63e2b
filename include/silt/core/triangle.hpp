// SPDX-License-Identifier: MIT
// A triangle in 3D, the element of surfaces and of STL files.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace silt {

/// A triangle by its corners.
template <class Real = double>
struct Triangle {
  std::array<Vec<3, Real>, 3> corners;  ///< [m]
};

/// Throws if a corner is not finite, or if the triangle has no area, that is, if its height is less
/// than a millionth of its longest side. `name` identifies it in the message.
template <class Real>
void require_area(const std::string& name, const Triangle<Real>& triangle) {
  const auto& [a, b, c] = triangle.corners;
  require_finite(name, a);
  require_finite(name, b);
  require_finite(name, c);
  const Vec<3, double> u = (b - a).template cast<double>();
  const Vec<3, double> v = (c - a).template cast<double>();
  const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
  if (!(cross(u, v).norm() > 1e-6 * longest)) {
    fail({name, " with the corners ", to_text(a), ", ", to_text(b), " and ", to_text(c),
          " m has no area; remove it, or repair the mesh"});
  }
}

}  // namespace silt
