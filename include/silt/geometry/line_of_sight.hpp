// SPDX-License-Identifier: MIT
// The first face that is seen from a point along an axis.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace silt {

/// A direction along an `axis` (0: x, 1: y, 2: z): its `sign` is +1, forwards, or −1, backwards.
struct Direction {
  int axis;
  int sign;
};

namespace detail {

inline bool is_crossed(const Face<2>& face, const Vec<2>& p, const Vec<2>& q) {
  const double first = side_of(p, q, face.corners[0]), second = side_of(p, q, face.corners[1]);
  return std::min(first, second) <= 0 && std::max(first, second) >= 0;
}
// Of two triangles with a common edge, both if the line passes through it, and otherwise one.
inline bool is_crossed(const Face<3>& face, const Vec<3>& p, const Vec<3>& q) {
  bool is_left = true, is_right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const double side = side_of(p, q, face.corners[k], face.corners[(k + 1) % 3]);
    is_left = is_left && side >= 0;
    is_right = is_right && side <= 0;
  }
  return is_left || is_right;
}

}  // namespace detail

/// The first face that is seen from a point.
struct SeenFace {
  double distance = std::numeric_limits<double>::infinity();  ///< [m]
  std::uint32_t element = 0;                                  ///< its number, if there is one
};

/// Without those of dry groups, the first face in a direction from x, of all faces or of those
/// whose normals are against it.
template <int Dim>
SeenFace first_face(const Faces<Dim>& faces, const Vec<Dim>& x, const Direction& direction,
                    bool counts_back_sides = true) {
  Vec<Dim> along = Vec<Dim>::Zero();
  along[direction.axis] = direction.sign;
  typename Faces<Dim>::Bounds line{x, x};
  (direction.sign > 0 ? line.upper : line.lower)[direction.axis] =
      direction.sign * std::numeric_limits<double>::infinity();
  SeenFace first;
  constexpr double margin = 1e-12;  // [m]: bounds of faces may have no width
  faces.for_each_near(line, margin, [&](std::uint32_t k) {
    if (faces.is_dry(faces[k].group)) return;
    const Face<Dim>& face = faces[k].face;
    if (!detail::is_crossed(face, x, Vec<Dim>(x + along))) return;
    // Its own: that of a facet differs by round-off of single precision.
    const Vec<Dim> normal = normal_of(face);
    constexpr double parallel = 1e-9;
    const double slope = normal.dot(along);
    if (std::abs(slope) < parallel || (slope > 0 && !counts_back_sides)) return;
    const double distance = normal.dot(face.corners[0] - x) / slope;
    if (distance > 0 && distance < first.distance) first = {distance, k};
  });
  return first;
}
/// The same in a box with periodic sides: beyond one, x is seen on from the opposite side, up to
/// one period.
template <int Dim>
SeenFace first_face_in(const Box<Dim>& box, const Faces<Dim>& faces, const Vec<Dim>& x,
                       const Direction& direction, bool counts_back_sides = true) {
  const auto [axis, sign] = direction;
  const SeenFace first = first_face(faces, x, direction, counts_back_sides);
  if (!box.periodic[std::size_t(axis)]) return first;
  const double to_side = sign > 0 ? box.upper[axis] - x[axis] : x[axis] - box.lower[axis];
  if (first.distance <= to_side) return first;
  Vec<Dim> beyond = x;
  beyond[axis] = sign > 0 ? box.lower[axis] : box.upper[axis];
  SeenFace rest = first_face(faces, beyond, direction, counts_back_sides);
  rest.distance += to_side;
  return rest.distance < box.length()[axis] ? rest : SeenFace{};
}

}  // namespace silt
