// SPDX-License-Identifier: MIT
// A surface of faces, of which those near a point are found.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/bounding_volume_tree.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/facets.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace silt {

/// Faces that may form closed or open surfaces, with normals; a face that is given twice counts
/// once. Those that continue each other form facets, see facets.hpp.
template <int Dim>
class Faces {
 public:
  using Vec = silt::Vec<Dim>;
  /// Orthogonal unit vectors.
  using Axes = std::array<Vec, std::size_t(Dim)>;

  /// A face of the surface, with what is asked of it often.
  using Element = FaceOfSurface<Dim>;

  Faces() = default;
  /// Throws if a face is invalid, see require_size(); `name` identifies the surface.
  Faces(const std::string& name, const std::vector<Face<Dim>>& faces) {
    elements_.reserve(faces.size());
    std::set<detail::Corners<Dim, std::size_t(Dim)>> known;
    for (std::size_t k = 0; k < faces.size(); ++k) {
      require_size(name + ": face " + std::to_string(k), faces[k]);
      if (!known.insert(detail::sorted_corners<Dim>(faces[k].corners)).second) continue;
      const Vec normal = normal_of(faces[k]);
      Element element{faces[k], normal, normal.dot(faces[k].corners[0]),
                      std::uint32_t(elements_.size()), {}, false, {}, {}};
      element.is_rim.fill(true);
      element.inwards.fill(Vec::Zero());  // by detail::Facets; g++ 12 warns of a copy without
      elements_.push_back(element);
    }
    detail::Facets<Dim>::join(elements_);
    make_tree();
    find_axes();
  }

  /// All faces, each once; their numbers are those of this array.
  std::span<const Element> elements() const { return elements_; }
  /// Orthogonal unit vectors, columns, along the normals of the first faces that have different ones.
  const Axes& axes() const { return axes_; }
  const Element& operator[](std::uint32_t element) const { return elements_[element]; }

  using Tree = BoxTree<Dim, double>;
  using Bounds = typename Tree::Bounds;

  /// f(k) for the numbers k of all faces closer to x, a point or bounds [m], than `distance` [m], and of
  /// some further ones.
  template <class Shape = Vec, class F>
  void for_each_near(const Shape& x, double distance, F&& f) const {
    const double limit = squared(distance);
    tree_.visit_near(x, limit, [&](std::uint32_t k) {
      f(k);
      return limit;
    });
  }

 private:
  void make_tree() {
    Buffer<typename Tree::Bounds> bounds;
    bounds.reserve(elements_.size());
    for (const Element& element : elements_) {
      const Vec& first = element.face.corners[0];
      typename Tree::Bounds own{first, first};
      for (const Vec& x : element.face.corners) own.enclose({x, x});
      bounds.push_back(own);
    }
    tree_ = Tree(bounds);
  }

  void find_axes() {
    std::size_t found = 0;
    const auto add = [&](Vec direction) {
      constexpr double least = 0.1;  // of the sine of its angle with the others
      for (std::size_t k = 0; k < found; ++k) direction -= direction.dot(axes_[k]) * axes_[k];
      if (found < axes_.size() && direction.norm() > least) axes_[found++] = direction.normalized();
    };
    for (const Element& element : elements_) add(element.normal);
    for (int axis = 0; axis < Dim; ++axis) add(Vec::Unit(axis));
  }

  Buffer<Element> elements_;
  Axes axes_;
  Tree tree_;
};

}  // namespace silt
