// SPDX-License-Identifier: MIT
// Where bodies without holes are, at the beginning: neither fluid nor other walls may be there.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/close_faces.hpp>
#include <silt/geometry/enclosure.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/face_crossing.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace silt::mps {

/// Bodies that are solid, where they are defined. A body of given mass properties need not be: it may
/// be a hull with a cargo.
template <int Dim>
class SolidBodies {
 public:
  using Vec = silt::Vec<Dim>;

  /// A body with the number of its group.
  void add(std::uint32_t group, const std::vector<Face<Dim>>& faces) {
    bodies_.push_back({group, Enclosure<Dim>(faces)});
  }
  /// See WallMover::find_in_solids().
  PointInBody find(Index number, FunctionRef<Vec(Index)> x_of) const {
    const auto body_around = [&](const Vec& x) {
      return std::find_if(bodies_.begin(), bodies_.end(),
                          [&](const Body& body) { return body.space.contains(x); });
    };
    const Index k = first_where(number, [&](Index n) { return body_around(x_of(n)) != bodies_.end(); });
    if (k == no_index) return {number, 0};
    return {k, body_around(x_of(k))->group};
  }
  /// Where faces of another group are in a body; or two bodies in each other, which begin side by side.
  /// Faces that touch, to a tolerance [m], do not count.
  std::optional<FaceCrossing<Dim>> find_faces(const Faces<Dim>& faces, double tolerance) const {
    for (const Body& body : bodies_) {
      for (const auto& element : faces.elements()) {
        if (element.group == body.group) continue;
        const Vec& x = element.face.corners[0];
        if (!body.space.contains(x) || touches(faces, body.group, x, tolerance)) continue;
        return FaceCrossing<Dim>{element.group, body.group, x};
      }
    }
    std::optional<FaceCrossing<Dim>> found;
    for (const Body& body : bodies_) {
      for_each_close_pair(faces, body.group, tolerance, [&](std::uint32_t own, std::uint32_t m) {
        const Body* const other = body_of(faces[m].group);
        if (found || !other || other->group < body.group) return;
        Vec middle = Vec::Zero();
        for (const Vec& corner : faces[own].face.corners) middle += corner / Dim;
        for (const double sign : {-1.0, 1.0}) {
          const Vec x = middle + 10 * sign * tolerance * faces[own].normal;
          if (!body.space.contains(x) || !other->space.contains(x)) continue;
          if (touches(faces, other->group, x, tolerance)) continue;
          found = {body.group, other->group, x};
        }
      });
    }
    return found;
  }

 private:
  struct Body {
    std::uint32_t group;
    Enclosure<Dim> space;
  };

  const Body* body_of(std::uint32_t group) const {
    const auto body = std::find_if(bodies_.begin(), bodies_.end(),
                                   [&](const Body& each) { return each.group == group; });
    return body == bodies_.end() ? nullptr : &*body;
  }
  static bool touches(const Faces<Dim>& faces, std::uint32_t group, const Vec& x, double tolerance) {
    bool is_close = false;
    faces.for_each_near(x, tolerance, [&](std::uint32_t k) {
      is_close = is_close || (faces[k].group == group &&
                              (x - nearest_of(faces[k].face, x)).norm() <= tolerance);
    });
    return is_close;
  }

  std::vector<Body> bodies_;
};

}  // namespace silt::mps
