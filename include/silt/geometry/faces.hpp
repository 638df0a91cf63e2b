// SPDX-License-Identifier: MIT
// A surface of faces, of which those near a point are found.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/bounding_volume_tree.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/facets.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace silt {

/// The bounding box of a face [m].
template <int Dim>
typename BoxTree<Dim, double>::Bounds bounds_of(const Face<Dim>& face) {
  typename BoxTree<Dim, double>::Bounds bounds{face.corners[0], face.corners[0]};
  for (const Vec<Dim>& corner : face.corners) bounds.enclose({corner, corner});
  return bounds;
}

/// How a group of faces moves in a step.
template <int Dim>
struct StepOfFaces {
  Pose<Dim> before;             ///< at the beginning of the step, from where the faces were defined
  Pose<Dim> move;               ///< from there to the end of the step
  RigidVelocity<Dim> velocity;  ///< the mean one [m/s]
};

/// Faces that may form closed or open surfaces, with normals; a face that is given twice in a group
/// counts once. Those of a group that continue each other form facets, see facets.hpp. Groups may
/// move, as rigid bodies.
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
    add_group(name, faces, 0);
    detail::Facets<Dim>::join(elements_);
    make_tree();
    find_axes();
  }
  /// The same, with groups of faces that move: group 1 and the following ones.
  Faces(const std::string& name, const std::vector<Face<Dim>>& at_rest,
        const std::vector<std::vector<Face<Dim>>>& moving) {
    add_group(name, at_rest, 0);
    for (std::size_t g = 0; g < moving.size(); ++g) {
      firsts_.push_back(static_cast<std::uint32_t>(elements_.size()));
      add_group(name + ": moving group " + std::to_string(g), moving[g], std::uint32_t(g + 1));
    }
    firsts_.push_back(static_cast<std::uint32_t>(elements_.size()));
    detail::Facets<Dim>::join(elements_);
    if (!moving.empty()) defined_ = elements_;
    steps_.resize(moving.size());
    is_dry_.resize(moving.size());
    make_tree();
    find_axes();
  }

  /// Whether there are groups that move.
  bool move() const { return !steps_.empty(); }
  /// The number of these groups.
  std::uint32_t groups() const { return static_cast<std::uint32_t>(steps_.size()); }
  /// Whether a group that moves has no fluid near it: no load on walls is its then.
  bool is_dry(std::uint32_t group) const { return group > 0 && is_dry_[group - 1] != 0; }
  /// Tells it.
  void set_dry(std::uint32_t group, bool is_dry) { is_dry_[group - 1] = is_dry ? 1 : 0; }
  /// The step of a group that moves, from 1 on.
  const StepOfFaces<Dim>& step_of(std::uint32_t group) const { return steps_[group - 1]; }
  /// Places the groups where they are at the beginning of a step. One for each, group 1 first. Does not
  /// throw.
  void begin_step(const Buffer<StepOfFaces<Dim>>& steps) {
    steps_ = steps;
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      if (elements_[k].group > 0)
        place(defined_[k], step_of(elements_[k].group).before, elements_[k]);
    }
    find_bounds();
    tree_.refit(bounds_);
    find_axes();
  }
  /// The steps change, but not where they begin.
  void set_moves(const Buffer<StepOfFaces<Dim>>& steps) { steps_ = steps; }

  /// All faces, each once; their numbers are those of this array.
  std::span<const Element> elements() const { return elements_; }
  /// Orthogonal unit vectors, columns, along the normals of the first faces that have different ones.
  const Axes& axes() const { return axes_; }
  const Element& operator[](std::uint32_t element) const { return elements_[element]; }

  using Tree = BoxTree<Dim, double>;
  using Bounds = typename Tree::Bounds;

  /// Those of a face where it is now [m].
  Bounds bounds_of(std::uint32_t element) const {
    return bounds_.empty() ? silt::bounds_of(elements_[element].face) : bounds_[element];
  }
  /// Whether a group that moves, from 1 on, has no faces.
  bool is_empty(std::uint32_t group) const { return firsts_[group - 1] == firsts_[group]; }
  /// The bounding box of a group that moves and is not empty [m].
  Bounds bounds_of_group(std::uint32_t group) const {
    Bounds all = bounds_of(firsts_[group - 1]);
    for (std::uint32_t k = firsts_[group - 1]; k < firsts_[group]; ++k) all.enclose(bounds_of(k));
    return all;
  }

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
  void add_group(const std::string& name, const std::vector<Face<Dim>>& faces,
                 std::uint32_t group) {
    elements_.reserve(elements_.size() + faces.size());
    std::set<detail::Corners<Dim, std::size_t(Dim)>> known;
    for (std::size_t k = 0; k < faces.size(); ++k) {
      require_size(name + ": face " + std::to_string(k), faces[k]);
      if (!known.insert(detail::sorted_corners<Dim>(faces[k].corners)).second) continue;
      const Vec normal = normal_of(faces[k]);
      Element element{faces[k],
                      normal,
                      normal.dot(faces[k].corners[0]),
                      std::uint32_t(elements_.size()),
                      {},
                      false,
                      {},
                      {},
                      group};
      element.is_rim.fill(true);
      element.inwards.fill(Vec::Zero());  // by detail::Facets; g++ 12 warns of a copy without
      elements_.push_back(element);
    }
  }
  // A face where it was defined, moved to a pose.
  static void place(const Element& defined, const Pose<Dim>& pose, Element& element) {
    const auto turned = [&](const Vec& v) { return multiply<Dim, double>(pose.rotation, v); };
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      element.face.corners[k] = pose.x_of(defined.face.corners[k]);
      element.inwards[k] = turned(defined.inwards[k]);
      element.inner_offset[k] = defined.inner_offset[k] + element.inwards[k].dot(pose.shift);
    }
    element.normal = turned(defined.normal);
    element.offset = defined.offset + element.normal.dot(pose.shift);
  }

  void find_bounds() {
    bounds_.resize(elements_.size());
    for (std::size_t k = 0; k < elements_.size(); ++k) {
      bounds_[k] = silt::bounds_of(elements_[k].face);
    }
  }
  void make_tree() {
    find_bounds();
    tree_ = Tree(bounds_);
    if (steps_.empty()) bounds_ = {};
  }

  void find_axes() {
    std::size_t found = 0;
    const auto add = [&](Vec direction) {
      constexpr double least = 0.1;  // of the sine of its angle with the others
      for (std::size_t k = 0; k < found; ++k) direction -= direction.dot(axes_[k]) * axes_[k];
      if (found < axes_.size() && direction.norm() > least) axes_[found++] = direction.normalized();
    };
    for (std::size_t k = 0; k < elements_.size() && found < axes_.size(); ++k) {
      add(elements_[k].normal);
    }
    for (int axis = 0; axis < Dim; ++axis) add(Vec::Unit(axis));
  }

  Buffer<Element> elements_;
  Buffer<Element> defined_;  // as they were defined, if there are groups that move
  Buffer<StepOfFaces<Dim>> steps_;
  Buffer<std::uint32_t> firsts_;          // faces of groups that move, and the number of all
  Buffer<std::uint8_t> is_dry_;           // each group that moves
  Buffer<typename Tree::Bounds> bounds_;  // of each face, if there are groups that move
  Axes axes_;
  Tree tree_;
};

}  // namespace silt
