// SPDX-License-Identifier: MIT
// Faces, of which surfaces consist: segments in 2D, triangles in 3D.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace silt {

/// A segment with two ends or a triangle with three corners [m].
template <int Dim>
struct Face {
  std::array<Vec<Dim>, std::size_t(Dim)> corners;
};

namespace detail {
template <int Dim>
void require_corners(const std::string& name, const Face<Dim>& face) {
  constexpr double most = 1e100;  // its square does not overflow
  for (const Vec<Dim>& x : face.corners) {
    if (max_norm(x) < most && is_finite(x)) continue;
    fail({name, " has the corner ", to_text(x), " m; give finite coordinates of less than ", most,
          " m"});
  }
}
}  // namespace detail

/// Throws if a corner is not finite or beyond 1e100 m, or if the face has no length or area. `name`
/// identifies it in the message.
template <int Dim>
void require_size(const std::string& name, const Face<Dim>& face) {
  detail::require_corners(name, face);
  if constexpr (Dim == 2) {
    const auto& [a, b] = face.corners;
    if (!((b - a).norm() > 1e-150)) {
      fail({name, " has both ends at ", to_text(a), " m; remove it"});
    }
  } else {
    require_area(name, Triangle<>{face.corners});
  }
}

/// A unit vector normal to the face [-]: in 2D on the left of the direction from the first end to
/// the second, in 3D on the side from which the corners are anticlockwise.
template <int Dim>
Vec<Dim> normal_of(const Face<Dim>& face) {
  if constexpr (Dim == 2) {
    const Vec<2> along = face.corners[1] - face.corners[0];
    return Vec<2>(-along[1], along[0]).normalized();
  } else {
    const auto& [a, b, c] = face.corners;
    return cross(Vec<3>(b - a), Vec<3>(c - a)).normalized();
  }
}

/// The same face with its normal on the other side.
template <int Dim>
Face<Dim> reversed(Face<Dim> face) {
  std::swap(face.corners[0], face.corners[1]);
  return face;
}

/// The point of a segment that is nearest to x [m].
template <int Dim>
Vec<Dim> nearest_of_segment(const Vec<Dim>& a, const Vec<Dim>& b, const Vec<Dim>& x) {
  const Vec<Dim> along = b - a;
  const double share = (x - a).dot(along) / along.squaredNorm();
  return a + std::clamp(share, 0.0, 1.0) * along;
}

/// The point of the face that is nearest to x [m].
template <int Dim>
Vec<Dim> nearest_of(const Face<Dim>& face, const Vec<Dim>& x) {
  const auto& corners = face.corners;
  if constexpr (Dim == 2) {
    return nearest_of_segment(corners[0], corners[1], x);
  } else {
    const Vec<3> normal = normal_of(face);
    bool is_above = true;
    Vec<3> nearest = corners[0];
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3>& a = corners[k];
      const Vec<3>& b = corners[(k + 1) % 3];
      is_above = is_above && cross(normal, Vec<3>(b - a)).dot(x - a) >= 0;
      const Vec<3> candidate = nearest_of_segment(a, b, x);
      const double distance = (x - candidate).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = candidate;
      }
    }
    return is_above ? Vec<3>(x - normal.dot(x - corners[0]) * normal) : nearest;
  }
}

namespace detail {

/// Whether the line from p to q passes a and b on its left (+) or right (−) [m²]: the same number
/// with the other sign for q and p exchanged.
inline double side_of(const Vec<2>& p, const Vec<2>& q, const Vec<2>& a) {
  return cross(Vec<2>(q - p), Vec<2>(a - p));
}
/// Six times the volume of the tetrahedron p, q, a, b [m³], with the other sign for b and a
/// exchanged to the last bit, so that no line passes between two triangles with a common edge.
inline double side_of(const Vec<3>& p, const Vec<3>& q, const Vec<3>& a, const Vec<3>& b) {
  return cross(Vec<3>(a - p), Vec<3>(b - p)).dot(q - p);
}

}  // namespace detail

/// How a line passes a face.
enum class Passage : std::uint8_t {
  beside,   ///< outside of it
  through,  ///< inside of it
  at_rim,   ///< near an edge of it, in 2D an end
};

/// How the line through p and q, which does not lie in the face, passes it; at_rim: closer to the line
/// of one of its edges (in 2D, to an end) than about `margin` [m].
template <int Dim>
Passage passage_of(const Face<Dim>& face, const Vec<Dim>& p, const Vec<Dim>& q, double margin) {
  const double least = margin * (q - p).norm();
  if constexpr (Dim == 2) {
    const double first = detail::side_of(p, q, face.corners[0]);
    const double second = detail::side_of(p, q, face.corners[1]);
    if (std::abs(first) < least || std::abs(second) < least) return Passage::at_rim;
    return (first > 0) != (second > 0) ? Passage::through : Passage::beside;
  } else {
    bool is_left[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec<3>& a = face.corners[k];
      const Vec<3>& b = face.corners[(k + 1) % 3];
      const double side = detail::side_of(p, q, a, b);
      if (std::abs(side) < least * (b - a).norm()) return Passage::at_rim;
      is_left[k] = side > 0;
    }
    return is_left[0] == is_left[1] && is_left[0] == is_left[2] ? Passage::through
                                                                : Passage::beside;
  }
}

}  // namespace silt
