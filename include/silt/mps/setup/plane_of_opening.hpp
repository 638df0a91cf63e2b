// SPDX-License-Identifier: MIT
// Openings in walls, through which fluid flows with a given velocity or pressure.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/geometry/face.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace silt::mps::detail {

/// The faces of an opening, which are in one plane, below a height, and the points of a layer of
/// particles in them.
template <int Dim>
class PlaneOfOpening {
 public:
  using Vec = silt::Vec<Dim>;
  using Parts = std::vector<Buffer<Vec>>;

  PlaneOfOpening() = default;
  /// `normal` is a unit vector, for directions; only what is below the level, the last coordinate
  /// [m], counts. Throws if the faces are none, invalid, not in one plane or not below the level;
  /// `name` identifies the opening in the message.
  PlaneOfOpening(const std::string& name, const std::vector<Face<Dim>>& faces, const Vec& direction,
                 double spacing, double level = std::numeric_limits<double>::infinity())
      : normal_(direction.normalized()), spacing_(spacing) {
    if (faces.empty()) fail({name, ": there are no faces; give those of the opening"});
    for (std::size_t k = 0; k < faces.size(); ++k) {
      require_size(name + ": face " + std::to_string(k), faces[k]);
    }
    require_plane(name, faces, direction);
    double lowest = std::numeric_limits<double>::infinity();
    for (const Face<Dim>& face : faces) {
      parts_.push_back(part_below(face, level));
      area_ += size_of(parts_.back());
      for (const Vec& x : face.corners) lowest = std::min(lowest, x[Dim - 1]);
    }
    if (!(area_ > 0)) {
      fail({name, ": level = ", level, " m is not above the lowest corner of the faces, ", lowest,
            " m; raise it"});
    }
    origin_ = first_corner();
    find_points(name);
  }

  const Vec& normal() const noexcept { return normal_; }
  double area() const noexcept { return area_; }  ///< [m²], in 2D the length [m]
  /// Of a lattice that fits the faces, on them [m].
  const std::vector<Vec>& points() const noexcept { return points_; }
  /// How far a point is from the plane along the normal [m].
  double distance(const Vec& x) const { return normal_.dot(x - origin_); }
  /// Whether a point is before or behind the faces, also if it is beyond their rims by the
  /// tolerance [m].
  bool faces_it(const Vec& x, double tolerance) const {
    const Vec foot = x - distance(x) * normal_;
    return std::any_of(parts_.begin(), parts_.end(),
                       [&](const auto& part) { return contains(part, foot, tolerance); });
  }

 private:
  void require_plane(const std::string& name, const std::vector<Face<Dim>>& faces,
                     const Vec& direction) const {
    constexpr double round_off = 1e-9;
    for (std::size_t k = 0; k < faces.size(); ++k) {
      if (!(std::abs(normal_of(faces[k]).dot(normal_)) > 1 - round_off)) {
        fail({name, ": the direction ", to_text(direction), " is not normal to face ", k,
              ", whose normal is ", to_text(normal_of(faces[k])), "; turn one of them"});
      }
      const double off = normal_.dot(faces[k].corners[0] - faces[0].corners[0]);
      if (std::abs(off) > 1e-6 * spacing_) {
        fail({name, ": face ", k, " is ", off,
              " m off the plane of face 0; give each plane its own opening"});
      }
    }
  }
  // A convex polygon, in 2D a segment.
  static Buffer<Vec> part_below(const Face<Dim>& face, double level) {
    Buffer<Vec> part;
    const std::size_t corners = std::size_t(Dim);
    for (std::size_t k = 0; k < corners; ++k) {
      const Vec& a = face.corners[k];
      const Vec& b = face.corners[(k + 1) % corners];
      if (a[Dim - 1] <= level) part.push_back(a);
      if (Dim == 2 && k + 1 == corners) break;  // a segment has one edge
      const double above_a = a[Dim - 1] - level, above_b = b[Dim - 1] - level;
      if ((above_a < 0 && above_b > 0) || (above_a > 0 && above_b < 0)) {
        part.push_back(a + above_a / (above_a - above_b) * (b - a));
      }
    }
    return part;
  }
  static double size_of(const Buffer<Vec>& part) {
    double size = 0;
    if constexpr (Dim == 2) {
      if (part.size() == 2) size = (part[1] - part[0]).norm();
    } else {
      for (Index k = 2; k < part.size(); ++k) {
        size += cross(Vec(part[k - 1] - part[0]), Vec(part[k] - part[0])).norm() / 2;
      }
    }
    return size;
  }
  Vec first_corner() const {
    for (const auto& part : parts_) {
      if (!part.empty()) return part[0];
    }
    return Vec::Zero();
  }
  // Orthogonal unit vectors in the plane; the first one is as steep as possible.
  std::array<Vec, std::size_t(Dim) - 1> axes() const {
    Vec first = Vec::Zero();
    for (int axis = Dim - 1; axis >= 0 && !(first.norm() > 0.1); --axis) {
      first = Vec::Unit(axis) - normal_[axis] * normal_;
    }
    first.normalize();
    if constexpr (Dim == 2) {
      return {first};
    } else {
      return {first, cross(normal_, first)};
    }
  }
  bool contains(const Buffer<Vec>& part, const Vec& x, double tolerance) const {
    if (part.size() < std::size_t(Dim)) return false;
    if constexpr (Dim == 2) {
      const Vec along = (part[1] - part[0]).normalized();
      const double s = along.dot(x - part[0]);
      return s >= -tolerance && s <= (part[1] - part[0]).norm() + tolerance;
    } else {
      // On the same side of all edges, whatever their order.
      bool is_left = true, is_right = true;
      for (Index k = 0; k < part.size(); ++k) {
        const Vec edge = part[(k + 1) % part.size()] - part[k];
        const double side = normal_.dot(cross(edge, Vec(x - part[k])));
        is_left = is_left && side >= -tolerance * edge.norm();
        is_right = is_right && side <= tolerance * edge.norm();
      }
      return is_left || is_right;
    }
  }
  void find_points(const std::string& name) {
    const auto along = axes();
    std::array<double, std::size_t(Dim) - 1> lower, step;
    std::array<Index, 2> number{1, 1};
    for (std::size_t a = 0; a < along.size(); ++a) {
      double least = std::numeric_limits<double>::infinity(), most = -least;
      for (const auto& part : parts_) {
        for (const Vec& x : part) {
          least = std::min(least, along[a].dot(x - origin_));
          most = std::max(most, along[a].dot(x - origin_));
        }
      }
      const double cells = std::max(1.0, std::round((most - least) / spacing_));
      if (!(cells < 1e6)) {
        fail({name, ": the opening is ", most - least,
              " m wide, more than 1e6 times spacing = ", spacing_, " m; increase the spacing"});
      }
      lower[a] = least;
      number[a] = Index(cells);
      step[a] = (most - least) / cells;
    }
    for (Index row = 0; row < number[1]; ++row) {
      for (Index k = 0; k < number[0]; ++k) {
        Vec x = origin_ + (lower[0] + (double(k) + 0.5) * step[0]) * along[0];
        if constexpr (Dim == 3) x += (lower[1] + (double(row) + 0.5) * step[1]) * along[1];
        if (faces_it(x, 1e-9 * spacing_)) points_.push_back(x);
      }
    }
    // Otherwise layers of particles would be much thicker or thinner than a spacing.
    const double thickness = double(points_.size()) * std::pow(spacing_, Dim) / area_ / spacing_;
    constexpr double most = 0.25;
    if (std::abs(thickness - 1) <= most) return;
    fail({name, ": the opening has ", area_, Dim == 2 ? " m" : " m²",
          " below the level, and room for ", double(points_.size()),
          " particles of spacing = ", spacing_,
          " m, which differs by more than a "
          "quarter; make it wider, or a whole number of spacings wide"});
  }

  Vec normal_ = Vec::Zero();
  double spacing_ = 0;
  double area_ = 0;
  Parts parts_;               // of the faces
  Vec origin_ = Vec::Zero();  // in the plane [m]
  std::vector<Vec> points_;
};

}  // namespace silt::mps::detail
