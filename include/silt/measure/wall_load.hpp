// SPDX-License-Identifier: MIT
// The load of a flow on walls without particles.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/fluid_load.hpp>
#include <silt/geometry/line_of_sight.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/measure/wall_group.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

/// Force of a fluid on some of its walls in the last step, by what stops the fluid there, pressure
/// or collisions, and by the stress of walls with friction, such as those of NoSlip. Of fluid that
/// sees a wall along every axis, the loads of all walls are the whole change of momentum by
/// pressure, collisions and the friction between particles, to round-off. See FluidLoad.
template <int Dim>
class WallLoad {
 public:
  /// `faces` are walls of the flow, or parts of them of several spacings, with normals into the
  /// fluid, as those of make_tank() and of faces_of(box) for fluid in the box; otherwise see
  /// reversed(). Fluid on the other side does not count. Those of walls that move are given where
  /// these are defined, and move with them. Throws if there is no face, or one without size.
  explicit WallLoad(const std::vector<Face<Dim>>& faces, WallGroup moves_with = {})
      : counts_(Counts::faces),
        group_(moves_with),
        faces_(moves_with.is_at_rest() ? Faces<Dim>("WallLoad", faces)
                                       : Faces<Dim>("WallLoad", {}, {faces})) {
    if (faces.empty()) fail("WallLoad: no faces; give those of which the load is asked");
  }
  /// Of all faces of a group of walls, from both sides.
  explicit WallLoad(WallGroup group) : counts_(Counts::group), group_(group) {}
  /// Of all walls of the flow, from both sides.
  static WallLoad of_all_walls() { return WallLoad(); }

  /// The same with the point [m] about which torques are written to a file; where a group is
  /// defined, if the faces are of one, and moving with it. Otherwise they are about the origin.
  /// Throws if it is not finite.
  WallLoad about(const Vec<Dim>& point) const {
    require_finite("WallLoad: about", point);
    WallLoad other = *this;
    other.about_ = point;
    return other;
  }

  /// The force, in 3D [N], in 2D per depth [N/m]; zero before the first step, and after reading a
  /// checkpoint until the next one. Of particles that processes share, all call it, and get the
  /// load of all. Throws if fluid sees a face that is not on a wall of the flow, or if the walls
  /// have no such group.
  template <class Sim>
  Vec<Dim> read(const Sim& simulation) const {
    return read(simulation, Vec<Dim>::Zero()).force;
  }
  /// The same with the torque about a point [m], in 3D [N m], in 2D per depth [N]: of the lines
  /// along the axes in which the fluid pushes. Throws also if the point is not finite.
  template <class Sim>
  BodyLoad<Dim> read(const Sim& simulation, const Vec<Dim>& about) const {
    static_assert(detail::has_walls_of_faces<Sim>,
                  "silt::WallLoad: read(simulation) needs a simulation of a flow whose walls are "
                  "faces, such as those of mps::Recommended");
    static_assert(std::remove_cvref_t<decltype(simulation.particles())>::dimension == Dim,
                  "silt::WallLoad: the flow has another dimension");
    const auto& flow = simulation.interaction();
    const auto& particles = simulation.particles();
    BodyLoad<Dim> load;
    detail::together(particles, [&] {
      require_finite("WallLoad: about", about);
      const FluidLoad<Dim> by_fluid(flow.walls().faces(), particles.box(),
                                    {.density = flow.settings().density,
                                     .spacing = flow.settings().spacing,
                                     .time_step = simulation.last_time_step()});
      load = counts_ == Counts::faces ? on_faces(simulation, by_fluid, about)
                                      : on_group(simulation, by_fluid, about);
      return Largest{};
    });
    return FluidLoad<Dim>::sum_of_all(particles, load);
  }

  /// For a file: see CsvSeries.
  std::vector<std::string> columns() const {
    if constexpr (Dim == 2) return {"force_x", "force_y", "torque"};
    return {"force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"};
  }
  /// What the numbers of a row are.
  std::string filter() const {
    const std::string kind = counts_ == Counts::all     ? "all walls"
                             : counts_ == Counts::group ? "a group of walls"
                                                        : "chosen faces of walls";
    return message_of({"force and torque about ", to_text(about_),
                       group_.is_at_rest() ? " m" : " m, which moves with the group",
                       " of the fluid on ", kind, Dim == 2 ? " [N/m], [N]" : " [N], [N m]",
                       ": the change of momentum by pressure, collisions and friction in the last "
                       "step; no average in time"});
  }
  /// The force [N] and the torque [N m], in 2D per metre of depth. Throws as read().
  template <class Sim>
  std::vector<double> row(const Sim& simulation) const {
    Vec<Dim> point = about_;
    if (const auto group = group_.template number_in<Dim>(simulation, "WallLoad"); group > 0) {
      point = simulation.interaction().walls().faces().step_of(group).before.x_of(point);
    }
    const BodyLoad<Dim> load = read(simulation, point);
    std::vector<double> numbers(load.force.begin(), load.force.end());
    for (int k = 0; k < angular_size<Dim>; ++k) numbers.push_back(component(load.torque, k));
    return numbers;
  }

 private:
  enum class Counts : std::uint8_t { faces, group, all };
  using SeenWall = typename FluidLoad<Dim>::SeenWall;
  using NearestWall = typename FluidLoad<Dim>::NearestWall;

  WallLoad() : counts_(Counts::all) {}

  template <class Sim>
  BodyLoad<Dim> on_faces(const Sim& simulation, const FluidLoad<Dim>& by_fluid,
                         const Vec<Dim>& about) const {
    const auto& flow = simulation.interaction();
    const double margin = 1e-3 * flow.settings().spacing;
    Faces<Dim> moved;
    const std::uint32_t group = group_.template number_in<Dim>(simulation, "WallLoad");
    if (group > 0) {
      moved = faces_;
      moved.begin_step({flow.walls().faces().step_of(group)});
    }
    const Faces<Dim>& faces = group > 0 ? moved : faces_;
    BoundsOfFaces<Dim> bounds;
    for (const auto& element : faces.elements()) bounds.enclose(element.face);
    return by_fluid.sum(
        flow.momentum_changes(), bounds, about,
        [&](const Vec<Dim>& x, const SeenWall& seen) {
          const double wall = seen.face.distance;
          const double face =
              first_face_in(by_fluid.box(), faces, x, seen.direction, false).distance;
          if (face < wall - margin) {
            fail({"WallLoad: a face is not on a wall of the flow, but ", face, " m from ",
                  to_text(x), " m in the fluid; give faces of the walls, or parts of them"});
          }
          return is_finite(face) && face < wall + margin ? 1.0 : 0.0;
        },
        [&](const NearestWall& wall) {
          return std::ranges::any_of(faces.elements(), [&](const auto& element) {
            return element.height(wall.particle) > 0 &&
                   (nearest_of(element.face, wall.foot) - wall.foot).norm() < margin;
          });
        });
  }
  template <class Sim>
  BodyLoad<Dim> on_group(const Sim& simulation, const FluidLoad<Dim>& by_fluid,
                         const Vec<Dim>& about) const {
    const std::uint32_t group = group_.template number_in<Dim>(simulation, "WallLoad");
    const bool all_count = counts_ == Counts::all;
    const Faces<Dim>& walls = by_fluid.walls();
    BoundsOfFaces<Dim> bounds;
    for (const auto& element : walls.elements()) {
      if (all_count || element.group == group) bounds.enclose(element.face);
    }
    const auto counts = [&](std::uint32_t k) { return all_count || walls[k].group == group; };
    return by_fluid.sum(
        simulation.interaction().momentum_changes(), bounds, about,
        [&](const Vec<Dim>&, const SeenWall& seen) {
          return is_finite(seen.face.distance) && counts(seen.face.element) ? 1.0 : 0.0;
        },
        [&](const NearestWall& wall) { return counts(wall.element); });
  }

  Counts counts_;
  WallGroup group_;
  Vec<Dim> about_ = Vec<Dim>::Zero();  // [m]
  Faces<Dim> faces_;                   // where they are defined, if they move
};

}  // namespace silt
