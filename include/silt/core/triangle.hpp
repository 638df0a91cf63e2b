// SPDX-License-Identifier: MIT
// A triangle in space: what surfaces are made of, and STL files hold.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <string>

namespace silt {

template <class Real = double>
struct Triangle {
  std::array<Vec<3, Real>, 3> corners;  ///< [m]
};

/// Throws if a corner is not finite, or if the triangle has no area: if it is less than a millionth
/// as high as it is long. `name` says which one it is.
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
    fail(name + " with the corners " + to_text(a) + ", " + to_text(b) + " and " + to_text(c) +
         " m has no area; leave it out, or repair the mesh");
  }
}

}  // namespace silt
