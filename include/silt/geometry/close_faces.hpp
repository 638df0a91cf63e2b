// SPDX-License-Identifier: MIT
// Faces of a group that are close to faces of other groups.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace silt {

/// f(own, other) for the numbers of each face of a group that moves and each face of another group, one
/// for which is_wanted(group), that are closer to each other than a distance [m], and for some further ones.
template <int Dim, class IsWanted, class F>
void for_each_close_pair(const Faces<Dim>& faces, std::uint32_t group, IsWanted&& is_wanted,
                         double distance, F&& f) {
  if (faces.is_empty(group)) return;
  const auto all = faces.bounds_of_group(group);
  Buffer<std::uint32_t> others;
  faces.for_each_near(all, distance, [&](std::uint32_t k) {
    if (faces[k].group == group || !is_wanted(faces[k].group)) return;
    if (all.squared_distance(faces.bounds_of(k)) < squared(distance)) others.push_back(k);
  });
  for (const std::uint32_t other : others) {
    const auto bounds = faces.bounds_of(other);
    faces.for_each_near(bounds, distance, [&](std::uint32_t own) {
      if (faces[own].group != group) return;
      if (bounds.squared_distance(faces.bounds_of(own)) < squared(distance)) f(own, other);
    });
  }
}

/// The same with all other groups.
template <int Dim, class F>
void for_each_close_pair(const Faces<Dim>& faces, std::uint32_t group, double distance, F&& f) {
  for_each_close_pair(faces, group, [](std::uint32_t) { return true; }, distance, f);
}

/// f(x, y) for points x of a face and y of another one that are the closest ones to each other near
/// them: of a corner and a face and, in space, of two edges. Points in [m].
template <int Dim, class F>
void for_each_closest_points(const Face<Dim>& one, const Face<Dim>& other, F&& f) {
  for (const Vec<Dim>& x : one.corners) f(x, nearest_of(other, x));
  for (const Vec<Dim>& y : other.corners) f(nearest_of(one, y), y);
  if constexpr (Dim == 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3>& a = one.corners[k];
      const Vec<3> u = one.corners[(k + 1) % 3] - a;
      for (std::size_t m = 0; m < 3; ++m) {
        const Vec<3>& b = other.corners[m];
        const Vec<3> v = other.corners[(m + 1) % 3] - b;
        // Where both edges are normal to the line between the points; ends belong to corners.
        const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
        const double determinant = uu * vv - uv * uv;
        constexpr double parallel = 1e-9;
        if (!(determinant > parallel * uu * vv)) continue;
        const Vec<3> w = b - a;
        const double s = (w.dot(u) * vv - w.dot(v) * uv) / determinant;
        const double t = (w.dot(u) * uv - w.dot(v) * uu) / determinant;
        if (!(s > 0 && s < 1 && t > 0 && t < 1)) continue;
        f(Vec<3>(a + s * u), Vec<3>(b + t * v));
      }
    }
  }
}

}  // namespace silt
