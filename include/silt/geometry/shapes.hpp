// SPDX-License-Identifier: MIT
// Faces of simple shapes.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace silt {

/// The segments between consecutive points, with normals on the left of their direction. Throws if
/// there are fewer than two points.
inline std::vector<Face<2>> polyline(const std::vector<Vec<2>>& points) {
  if (points.size() < 2) {
    fail({"polyline: number of points = ", points.size(), "; give at least 2"});
  }
  std::vector<Face<2>> faces;
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    faces.push_back({{points[k], points[k + 1]}});
  }
  return faces;
}

/// The triangles, such as those of an STL file.
inline std::vector<Face<3>> faces_of(const std::vector<Triangle<>>& triangles) {
  std::vector<Face<3>> faces;
  for (const Triangle<>& triangle : triangles) faces.push_back({triangle.corners});
  return faces;
}
/// The triangles of faces, for dem::MeshWall and write_stl().
inline std::vector<Triangle<>> triangles_of(const std::vector<Face<3>>& faces) {
  std::vector<Triangle<>> triangles;
  for (const Face<3>& face : faces) triangles.push_back({face.corners});
  return triangles;
}

/// Which sides of a box have faces: those across axis k, at the lower and at the upper end.
template <int Dim>
struct Sides {
  std::array<bool, std::size_t(Dim)> lower;
  std::array<bool, std::size_t(Dim)> upper;

  /// All sides but the upper one of the last axis: an open tank.
  static Sides open() {
    Sides sides = all();
    sides.upper[std::size_t(Dim) - 1] = false;
    return sides;
  }
  /// A closed box.
  static Sides all() {
    Sides sides;
    sides.lower.fill(true);
    sides.upper.fill(true);
    return sides;
  }
};

/// Faces on sides of a box, with normals into it: segments in 2D, two triangles for each side in
/// 3D. There are none across a periodic axis; along one, the others go on by a period beyond both
/// ends, twice as far as a flow sees at most.
template <int Dim>
std::vector<Face<Dim>> faces_of(const Box<Dim>& box, const Sides<Dim>& sides = Sides<Dim>::all()) {
  std::vector<Face<Dim>> faces;
  Vec<Dim> lower = box.lower, upper = box.upper;  // between which the sides reach
  for (int axis = 0; axis < Dim; ++axis) {
    if (!box.periodic[std::size_t(axis)]) continue;
    const double period = box.upper[axis] - box.lower[axis];
    lower[axis] -= period;
    upper[axis] += period;
  }
  const auto add = [&](int axis, bool is_upper, const Vec<Dim>& end) {
    // The corners of a side, in their order around it.
    const auto corner = [&](bool second, [[maybe_unused]] bool third) {
      Vec<Dim> x = end;
      x[(axis + 1) % Dim] = second ? upper[(axis + 1) % Dim] : lower[(axis + 1) % Dim];
      if constexpr (Dim == 3) {
        x[(axis + 2) % Dim] = third ? upper[(axis + 2) % Dim] : lower[(axis + 2) % Dim];
      }
      return x;
    };
    const auto first_of_side = static_cast<std::ptrdiff_t>(faces.size());
    if constexpr (Dim == 2) {
      faces.push_back({{corner(false, false), corner(true, false)}});
    } else {
      faces.push_back({{corner(false, false), corner(true, false), corner(true, true)}});
      faces.push_back({{corner(false, false), corner(true, true), corner(false, true)}});
    }
    const Vec<Dim> normal = normal_of(faces.back());
    if ((normal[axis] > 0) != is_upper) return;
    for (auto face = faces.begin() + first_of_side; face != faces.end(); ++face) {
      *face = reversed(*face);
    }
  };
  for (int axis = 0; axis < Dim; ++axis) {
    if (box.periodic[std::size_t(axis)]) continue;
    if (sides.lower[std::size_t(axis)]) add(axis, false, box.lower);
    if (sides.upper[std::size_t(axis)]) add(axis, true, box.upper);
  }
  return faces;
}

}  // namespace silt
