// SPDX-License-Identifier: MIT
// The space inside of closed faces.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/bounding_volume_tree.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/inside.hpp>

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace silt {

/// The space inside of closed faces, of which it is known quickly whether a point is in it.
template <int Dim>
class Enclosure {
 public:
  using Vec = silt::Vec<Dim>;
  using Bounds = typename BoxTree<Dim, double>::Bounds;

  /// At least one face; their normals are all outwards or all inwards.
  explicit Enclosure(std::vector<Face<Dim>> faces)
      : faces_(std::move(faces)), bounds_(bounds_of(faces_[0])) {
    Buffer<Bounds> each;
    for (const Face<Dim>& face : faces_) {
      each.push_back(bounds_of(face));
      bounds_.enclose(each.back());
    }
    tree_ = BoxTree<Dim, double>(each);
  }

  const Bounds& bounds() const { return bounds_; }
  /// Whether a point x [m] is in it, as is_inside().
  bool contains(const Vec& x) const {
    for (int k = 0; k < Dim; ++k) {
      if (!(x[k] > bounds_.lower[k] && x[k] < bounds_.upper[k])) return false;
    }
    // From inside, a line along an axis goes out of the faces more often than into them.
    const double length = bounds_.upper[0] - bounds_.lower[0];
    const double margin = 1e-9 * length;
    Vec end = x;
    end[0] += 2 * length;
    int around = 0;
    bool is_sure = true;
    tree_.visit_near(Bounds{x, end}, squared(margin), [&](std::uint32_t k) {
      const Passage passage = passage_of(faces_[k], x, end, margin);
      if (passage != Passage::beside) {
        const Vec normal = normal_of(faces_[k]);
        const double height = normal.dot(x - faces_[k].corners[0]);
        const double of_end = normal.dot(end - faces_[k].corners[0]);
        if (passage == Passage::through && (height > 0) != (of_end > 0)) {
          around += height > 0 ? 1 : -1;
        }
        is_sure = is_sure && passage == Passage::through && std::abs(height) > margin;
      }
      return squared(margin);
    });
    return is_sure ? around != 0 : is_inside(faces_, x);
  }
  /// Whether the nearest of the faces is closer to a point x [m] than a distance [m], as
  /// distance_from().
  bool has_face_within(double distance, const Vec& x) const {
    constexpr double round_off = 1e-9;
    const double limit = squared((1 + round_off) * distance);
    bool is_near = false;
    tree_.visit_near(x, limit, [&](std::uint32_t k) {
      is_near = is_near || (x - nearest_of(faces_[k], x)).norm() < distance;
      return is_near ? 0.0 : limit;
    });
    return is_near;
  }

 private:
  std::vector<Face<Dim>> faces_;
  Bounds bounds_;
  BoxTree<Dim, double> tree_;
};

}  // namespace silt
