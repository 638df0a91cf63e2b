// SPDX-License-Identifier: MIT
// A ball of triangles for tests.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace silt::test {

/// Around the origin, of `rings` rings of triangles with `sides` corners each.
inline std::vector<Face<3>> ball(double radius, int rings, int sides) {
  const auto corner = [&](int ring, int k) -> Vec<3> {
    if (ring == 0 || ring == rings) return {0, 0, ring == 0 ? radius : -radius};
    const double polar = std::numbers::pi * ring / rings;
    const double azimuth = std::numbers::pi * (2 * (k % sides) + ring % 2) / sides;
    return radius * Vec<3>(std::sin(polar) * std::cos(azimuth), std::sin(polar) * std::sin(azimuth),
                           std::cos(polar));
  };
  std::vector<Face<3>> faces;
  for (int ring = 0; ring < rings; ++ring) {
    for (int k = 0; k < sides; ++k) {
      const Vec<3> a = corner(ring, k), b = corner(ring, k + 1);
      const Vec<3> c = corner(ring + 1, k), d = corner(ring + 1, k + 1);
      if (ring > 0) faces.push_back({{a, c, b}});
      if (ring < rings - 1) faces.push_back({{b, c, d}});
    }
  }
  return faces;
}

}  // namespace silt::test
