// SPDX-License-Identifier: MIT
// Triangulated surfaces for tests.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <functional>
#include <vector>

namespace silt::test {

using Triangles = std::vector<Triangle<double>>;

/// n × n quads of two triangles each over the unit square, at place(u, v).
inline void add_patch(Triangles& all, int n, const std::function<Vec<3>(double, double)>& place) {
  const auto at = [&](int i, int j) { return place(double(i) / n, double(j) / n); };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      all.push_back({{at(i, j), at(i + 1, j), at(i + 1, j + 1)}});
      all.push_back({{at(i, j), at(i + 1, j + 1), at(i, j + 1)}});
    }
  }
}

/// The six sides of a box, each of n × n quads.
inline Triangles box_of_triangles(const Box<3>& box, int n = 1) {
  Triangles all;
  for (int k = 0; k < 3; ++k) {
    for (const double end : {0.0, 1.0}) {
      add_patch(all, n, [&](double u, double v) {
        Vec<3> share;
        share[k] = end;
        share[(k + 1) % 3] = u;
        share[(k + 2) % 3] = v;
        return Vec<3>(box.lower + share.cwiseProduct(box.length()));
      });
    }
  }
  return all;
}

/// Distance of x from a triangle: the minimum over its interior, its sides and its corners.
inline double exact_distance(const Vec<3>& x, const Triangle<double>& triangle) {
  const auto& c = triangle.corners;
  const Vec<3> n = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
  double nearest = std::min({(x - c[0]).norm(), (x - c[1]).norm(), (x - c[2]).norm()});
  bool is_above = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec<3> side = c[(k + 1) % 3] - c[k];
    const double s = (x - c[k]).dot(side) / side.squaredNorm();
    if (s > 0 && s < 1) nearest = std::min(nearest, (x - c[k] - s * side).norm());
    is_above &= n.cross(side).dot(x - c[k]) >= 0;
  }
  return is_above ? std::abs(n.dot(x - c[0])) : nearest;
}

}  // namespace silt::test
