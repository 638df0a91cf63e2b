// SPDX-License-Identifier: MIT
// Faces of simple shapes.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/triangle.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
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

namespace detail {

// Throws unless a disc or a sphere can have faces with such edges.
template <int Dim>
void require_ball(const std::string& name, const Vec<Dim>& centre, double R, double edge) {
  require_finite((name + ": centre").c_str(), centre);
  require_positive(name + ": radius", R);
  require_positive(name + ": edge", edge);
  constexpr double least = Dim == 2 ? 1e-3 : 1e-2;
  if (edge >= least * R) return;
  fail({name, ": edge = ", edge, " m is less than ", least, " of the radius = ", R,
        " m; give a longer one"});
}

// The corners of an icosahedron with edges of 2 m, around the origin.
inline std::vector<Vec<3>> corners_of_icosahedron() {
  std::vector<Vec<3>> corners;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double one : {-1.0, 1.0}) {
      for (const double golden : {-std::numbers::phi, std::numbers::phi}) {
        Vec<3> x = Vec<3>::Zero();
        x[(axis + 1) % 3] = one;
        x[(axis + 2) % 3] = golden;
        corners.push_back(x);
      }
    }
  }
  return corners;
}

}  // namespace detail

/// A regular polygon, of 8 sides or more, with the area of a disc of a radius R [m] around a centre
/// [m], and normals outwards. The edges are at most about as long as `edge` [m]. Throws if R or the
/// edge is not positive, or the edge below a thousandth of R.
inline std::vector<Face<2>> faces_of_disc(const Vec<2>& centre, double R, double edge) {
  detail::require_ball("faces_of_disc", centre, R, edge);
  const int sides = std::max(8, static_cast<int>(std::ceil(2 * std::numbers::pi * R / edge)));
  const double step = 2 * std::numbers::pi / sides;
  const double of_corners = R * std::sqrt(step / std::sin(step));
  std::vector<Vec<2>> corners;
  for (int k = 0; k <= sides; ++k) {
    const double turn = -step * (k % sides);  // clockwise
    corners.push_back(centre + of_corners * Vec<2>(std::cos(turn), std::sin(turn)));
  }
  return polyline(corners);
}

/// Triangles, 80 or more, with the volume of a sphere of a radius R [m] around a centre [m], and
/// normals outwards: an icosahedron, divided. The edges are at most about as long as `edge` [m].
/// Throws if R or the edge is not positive, or the edge below a hundredth of R.
inline std::vector<Face<3>> faces_of_sphere(const Vec<3>& centre, double R, double edge) {
  detail::require_ball("faces_of_sphere", centre, R, edge);
  // The angle of an icosahedron's edge is 1.107; projected parts of it are up to 1.2 times as long
  // as their mean.
  const int parts = std::max(2, static_cast<int>(std::ceil(1.2 * 1.107 * R / edge)));
  const std::vector<Vec<3>> corners = detail::corners_of_icosahedron();
  std::vector<Face<3>> faces;
  faces.reserve(20 * std::size_t(parts) * std::size_t(parts));
  double volume = 0;
  std::vector<Vec<3>> points;
  const auto add = [&](std::size_t i, std::size_t j, std::size_t k) {
    Face<3> face{{points[i], points[j], points[k]}};
    const double sixfold = points[i].dot(cross(points[j], points[k]));
    volume += std::abs(sixfold) / 6;
    faces.push_back(sixfold < 0 ? reversed(face) : face);
  };
  const auto divide = [&](const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) {
    // Points of a common edge have the same bits in both triangles, as the corners are always in
    // the same order.
    points.clear();
    for (int i = 0; i <= parts; ++i) {
      for (int j = 0; i + j <= parts; ++j) {
        Vec<3> x;
        for (int k = 0; k < 3; ++k) x[k] = (parts - i - j) * a[k] + i * b[k] + j * c[k];
        points.push_back(x / x.norm());
      }
    }
    std::size_t first = 0;  // of row i
    for (int i = 0; i < parts; ++i) {
      const auto size = static_cast<std::size_t>(parts - i + 1);
      for (std::size_t j = 0; j + 1 < size; ++j) {
        add(first + j, first + j + 1, first + size + j);
        if (j + 2 < size) add(first + j + 1, first + size + j, first + size + j + 1);
      }
      first += size;
    }
  };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (std::size_t j = i + 1; j < corners.size(); ++j) {
      for (std::size_t k = j + 1; k < corners.size(); ++k) {
        const double longest =
            std::max({(corners[i] - corners[j]).norm(), (corners[j] - corners[k]).norm(),
                      (corners[k] - corners[i]).norm()});
        if (longest < 2.1) divide(corners[i], corners[j], corners[k]);
      }
    }
  }
  const double of_corners = R * std::cbrt(4 * std::numbers::pi / (3 * volume));
  for (Face<3>& face : faces) {
    for (Vec<3>& x : face.corners) x = centre + of_corners * x;
  }
  return faces;
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
