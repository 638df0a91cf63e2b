// SPDX-License-Identifier: MIT
// The load of a flow on walls without particles.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/line_of_sight.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>
#include <vector>

namespace silt {

/// Force of a fluid on some of its walls in the last step, by what stops the fluid there, pressure or
/// collisions; viscous stresses are not included. Of fluid that sees a wall along every axis, the
/// loads of all walls are the whole change of momentum by pressure, collisions and the friction
/// between particles, to round-off.
///
/// The integral of P n over the walls that are first seen along an axis is that of ψ ∂P + P ∂ψ over
/// the fluid which sees them, with derivatives along the axis, where ψ is 1 on these walls, 0 on
/// those in the opposite direction and linear between both, or 1 if there are none. For ∂P stands
/// −ρ times the acceleration.
template <int Dim>
class WallLoad {
 public:
  /// `faces` are walls of the flow, or parts of them of several spacings, with normals into the fluid,
  /// as those of make_tank() and of faces_of(box) for fluid in the box; otherwise see reversed().
  /// Fluid on the other side does not count. Throws if there is no face, or one without size.
  explicit WallLoad(const std::vector<Face<Dim>>& faces) : faces_("WallLoad", faces) {
    if (faces.empty()) fail("WallLoad: no faces; give those of which the load is asked");
    for (const auto& element : faces_.elements()) {
      for (const auto& corner : element.face.corners) {
        lower_ = lower_.cwiseMin(corner);
        upper_ = upper_.cwiseMax(corner);
      }
    }
  }

  /// In 3D [N], in 2D per depth [N/m]; zero before the first step, and after reading a checkpoint
  /// until the next one. Of particles that processes share, all call it, and get the load of all.
  /// Throws if fluid sees a face that is not on a wall of the flow.
  template <class Sim>
  Vec<Dim> read(const Sim& simulation) const {
    static_assert(requires { simulation.interaction().walls().faces(); },
                  "silt::WallLoad: read(simulation) needs a simulation of a flow whose walls are "
                  "faces, such as those of mps::Recommended");
    static_assert(std::remove_cvref_t<decltype(simulation.particles())>::dimension == Dim,
                  "silt::WallLoad: the flow has another dimension");
    const auto& flow = simulation.interaction();
    const auto& changes = flow.momentum_changes();
    const double l0 = flow.settings().spacing;
    const double volume = std::pow(l0, Dim);
    const double momentum = flow.settings().density * volume / simulation.last_time_step();
    const auto& box = simulation.particles().box();
    const View view{.walls = flow.walls().faces(),
                    .faces = faces_,
                    .box = {.lower = box.lower.template cast<double>(),
                            .upper = box.upper.template cast<double>(),
                            .periodic = box.periodic},
                    .margin = 1e-3 * l0};
    // Off a lattice, where lines would pass through edges that parts of a wall have in common.
    Vec<Dim> aside = 1e-7 * l0 * Vec<Dim>::Ones();
    for (int k = 0; k < Dim; ++k) aside[k] /= std::sqrt(k + 2);
    std::vector<Vec<Dim>> loads(changes.size());
    const auto read_load = [&](Index i) {
      const auto& change = changes[i];
      const Vec<Dim> x = change.position + aside;
      loads[i].setZero();
      for (int axis = 0; axis < Dim; ++axis) {
        if (!may_see(x, axis)) continue;
        const auto seen = view.along(axis, x);
        const double gap = seen[0].distance + seen[1].distance;
        for (const std::size_t side : {0u, 1u}) {
          if (!seen[side].is_counted) continue;
          const double sign = side == 0 ? -1 : 1;
          const double share = is_finite(gap) ? seen[1 - side].distance / gap : 1;
          loads[i][axis] += sign * volume * change.pressure / gap -
                            share * momentum * change.velocity_change[axis];
        }
      }
    };
    const auto& particles = simulation.particles();
    detail::together(particles, [&] {
      for_each(changes.size(), read_load);
      return Largest{};
    });
    Vec<Dim> load = Vec<Dim>::Zero();
    for (const auto& part : loads) load += part;
    return detail::sum_of_all(particles, load);
  }

 private:
  struct Seen {
    double distance;  // of the first wall
    bool is_counted;  // whether it is one of the faces
  };
  struct View {
    const Faces<Dim>& walls;
    const Faces<Dim>& faces;
    Box<Dim> box;
    double margin;  // [m]

    // Backwards and forwards.
    std::array<Seen, 2> along(int axis, const Vec<Dim>& x) const {
      return {in(Direction{axis, -1}, x), in(Direction{axis, 1}, x)};
    }

   private:
    Seen in(const Direction& direction, const Vec<Dim>& x) const {
      const double wall = distance(walls, direction, x, true);
      const double face = distance(faces, direction, x, false);
      if (face < wall - margin) {
        fail({"WallLoad: a face is not on a wall of the flow, but ", face, " m from ", to_text(x),
              " m in the fluid; give faces of the walls, or parts of them"});
      }
      return {wall, is_finite(face) && face < wall + margin};
    }
    double distance(const Faces<Dim>& which, const Direction& direction, const Vec<Dim>& x,
                    bool counts_back_sides) const {
      const auto [axis, sign] = direction;
      const double first = distance_to_face(which, x, direction, counts_back_sides);
      if (!box.periodic[std::size_t(axis)]) return first;
      const double to_side = sign > 0 ? box.upper[axis] - x[axis] : x[axis] - box.lower[axis];
      if (first <= to_side) return first;
      Vec<Dim> beyond = x;
      beyond[axis] = sign > 0 ? box.lower[axis] : box.upper[axis];
      const double rest = distance_to_face(which, beyond, direction, counts_back_sides);
      const double none = std::numeric_limits<double>::infinity();
      return to_side + rest < box.length()[axis] ? to_side + rest : none;
    }
  };

  bool may_see(const Vec<Dim>& x, int axis) const {
    for (int k = 0; k < Dim; ++k) {
      if (k != axis && !(lower_[k] <= x[k] && x[k] <= upper_[k])) return false;
    }
    return true;
  }

  Faces<Dim> faces_;
  // Of their corners.
  Vec<Dim> lower_ = Vec<Dim>::Constant(std::numeric_limits<double>::infinity());
  Vec<Dim> upper_ = -lower_;
};

}  // namespace silt
