// SPDX-License-Identifier: MIT
// Which walls of a flow a measure belongs to, and where they are now.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace silt {

/// The walls at rest of a flow whose walls are faces, one of its groups of moving faces, or a body.
class WallGroup {
 public:
  /// Those at rest.
  constexpr WallGroup() = default;
  /// Number k of the moving faces of the walls, from 0 on: MovingWalls::faces.
  static constexpr WallGroup moving_faces(Index k) { return {Kind::moving_faces, k}; }
  /// Number k of the bodies of the walls, from 0 on.
  static constexpr WallGroup body(Index k) { return {Kind::body, k}; }

  bool operator==(const WallGroup&) const = default;
  /// Whether it is that of the walls at rest.
  bool is_at_rest() const { return kind_ == Kind::at_rest; }

  /// Its number among the groups of the faces of the flow; 0 at rest. Throws if the walls have no
  /// such group; `name` is that of the measure.
  template <int Dim, class Sim>
  std::uint32_t number_in(const Sim& simulation, const char* name) const {
    if (is_at_rest()) return 0;
    const auto& walls = simulation.interaction().walls();
    const std::size_t bodies = walls.number_of_bodies();
    const std::size_t moving = walls.faces().groups() - bodies;
    const bool is_body = kind_ == Kind::body;
    const std::size_t count = is_body ? bodies : moving;
    if (number_ >= count) {
      const std::string kind = is_body ? "body" : "moving_faces";
      fail({name, ": WallGroup::", kind, "(", number_, "), but the walls of the flow have ", count,
            is_body ? " bodies" : " groups of moving faces",
            "; give a number from 0 on below that"});
    }
    return static_cast<std::uint32_t>(1 + number_ + (is_body ? moving : 0));
  }

 private:
  enum class Kind : std::uint8_t { at_rest, moving_faces, body };
  constexpr WallGroup(Kind kind, Index number) : kind_(kind), number_(number) {}

  Kind kind_ = Kind::at_rest;
  Index number_ = 0;
};

namespace detail {

/// Whether the walls of the flow of a simulation are faces.
template <class Sim>
inline constexpr bool has_walls_of_faces =
    requires(const Sim& simulation) { simulation.interaction().walls().faces(); };

/// The walls of a flow at the time of a simulation, where Faces of the flow are where they were at
/// the beginning of its last step. Refers to the simulation.
template <int Dim>
class WallsNow {
 public:
  template <class Sim>
  explicit WallsNow(const Sim& simulation) : faces_(&simulation.interaction().walls().faces()) {
    for (std::uint32_t group = 1; group <= faces_->groups(); ++group) {
      const StepOfFaces<Dim>& step = faces_->step_of(group);
      poses_.push_back(step.move.after(step.before));
    }
  }

  /// Where a group of walls is, from where it was defined.
  Pose<Dim> pose_of(std::uint32_t group) const {
    return group == 0 ? Pose<Dim>{} : poses_[group - 1];
  }

  /// f(face) for the faces closer to x than `distance` [m], where they are now.
  template <class F>
  void for_each_near(const Vec<Dim>& x, double distance, F&& f) const {
    for (std::uint32_t group = 0; group <= poses_.size(); ++group) {
      // x as the group sees it, where its faces are in the tree.
      const bool moves = group > 0;
      const Pose<Dim> from_faces =
          moves ? pose_of(group).after(faces_->step_of(group).before.inverse()) : Pose<Dim>{};
      const Vec<Dim> seen = moves ? from_faces.X_of(x) : x;
      faces_->for_each_near(seen, distance, [&](std::uint32_t k) {
        const auto& element = (*faces_)[k];
        if (element.group != group) return;
        if (!((nearest_of(element.face, seen) - seen).norm() < distance)) return;
        Face<Dim> face = element.face;
        if (moves) {
          for (Vec<Dim>& corner : face.corners) corner = from_faces.x_of(corner);
        }
        f(face);
      });
    }
  }

 private:
  const Faces<Dim>* faces_;
  std::vector<Pose<Dim>> poses_;
};

}  // namespace detail

}  // namespace silt
