// SPDX-License-Identifier: MIT
// An opening through which fluid flows with a given velocity, and the piston in it, which is a wall
// of the flow. It moves with the fluid; whenever it has moved by a layer of particles, it goes back
// by it:
//
//   |·  ·  ·        piston in the opening
//      |·  ·  ·     a layer later
//   |·  ·  ·  ·     back in the opening, with a new layer before it
//
// or the same in the opposite direction, with a layer removed. To the fluid it is a wall that moves
// with the velocity for ever: ∂P/∂n is that of the velocity, and the volume that enters or leaves
// that of its way.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/rigid_motion.hpp>
#include <silt/mps/setup/plane_of_opening.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace silt::mps {

/// An opening, and the flow through it.
template <int Dim>
struct VelocityOpening {
  /// In one plane, and not among the other walls of the flow. Walls at rest extend from their rims
  /// by a spacing and a quarter in the direction of the velocity, as a guide of the piston.
  std::vector<Face<Dim>> faces = {};
  Vec<Dim> velocity = Vec<Dim>::Zero();  ///< normal to the faces [m/s]
  double spacing = 0;                    ///< l0 [m], that of the flow
  /// Of an inflow: fluid enters below this height, the last coordinate [m].
  double level = std::numeric_limits<double>::infinity();
  double from = 0;  ///< time at which it begins [s]
  double ramp = 0;  ///< in this time, the speed rises linearly from 0 [s]; at least 0
};

namespace detail {

/// What a piston among the walls of a flow and its observer know of each other.
struct PistonAndObserver {
  std::atomic<double> time_of_layers = -std::numeric_limits<double>::infinity();  // [s]
  std::atomic<bool> is_wall = false;  // whether a flow has asked where the piston is
};

/// How a piston moves, as functions of time.
template <int Dim>
struct MotionOfPiston {
  double speed = 0;  // in the end [m/s]
  Vec<Dim> direction = Vec<Dim>::Zero();
  double thickness = 1;       // of a layer [m]
  double from = 0, ramp = 0;  // [s]
  const char* name = "";      // of the observer
  std::shared_ptr<PistonAndObserver> both;

  /// How far it would have moved without going back [m].
  double way(double t) const {
    const double since = std::max(0.0, t - from);
    return since < ramp ? speed * since * since / (2 * ramp) : speed * (since - ramp / 2);
  }
  double speed_at(double t) const {
    const double since = t - from;
    return since < 0 ? 0 : since < ramp ? speed * since / ramp : speed;
  }
  /// How often it has gone back.
  double layers(double t) const { return std::floor(way(t) / thickness); }
  /// Where it is, from the opening on [m].
  double place(double t) const { return way(t) - layers(t) * thickness; }

  Pose<Dim> pose_at(double t) const {
    both->is_wall = true;
    return {.shift = place(t) * direction};
  }
  RigidVelocity<Dim> velocity_at(double t) const { return {.linear = speed_at(t) * direction}; }
  /// It goes back between steps only. Throws if the observer has not made the layers that are due.
  Pose<Dim> move_in(double t, double time_step) const {
    if (layers(t) > 0 && both->time_of_layers != t) {
      fail({name, ": no particles are added or removed in the step at ", t,
            " s; pass it to run(), or call its before_step(simulation) before each step, and "
            "give each simulation its own"});
    }
    return {.shift = (way(t + time_step) - way(t)) * direction};
  }
};

/// The opening, its piston, and the layers that it has passed; for an observer with a name.
template <int Dim>
class PistonInOpening {
 public:
  using Vec = silt::Vec<Dim>;

  /// Throws if a parameter of the opening is out of range.
  PistonInOpening(const char* name, const VelocityOpening<Dim>& opening)
      : opening_(checked(opening)),
        plane_("VelocityOpening", opening.faces, opening.velocity, opening.spacing, opening.level) {
    motion_ = {.speed = opening.velocity.norm(),
               .direction = plane_.normal(),
               .thickness =
                   double(plane_.points().size()) * std::pow(opening.spacing, Dim) / plane_.area(),
               .from = opening.from,
               .ramp = opening.ramp,
               .name = name,
               .both = std::make_shared<PistonAndObserver>()};
  }

  const VelocityOpening<Dim>& opening() const noexcept { return opening_; }
  const PlaneOfOpening<Dim>& plane() const noexcept { return plane_; }
  const MotionOfPiston<Dim>& motion() const noexcept { return motion_; }
  MovingFaces<Dim> faces() const { return {opening_.faces, motion_}; }

  /// Calls make_layer() if one is due at a time [s]. Throws if the spacing is not that of the flow
  /// [m], if no flow has the piston, or if more than one is due.
  template <class F>
  void make_layers(double time, double spacing_of_flow, F&& make_layer) {
    if (spacing_of_flow != opening_.spacing) {
      fail({"VelocityOpening: spacing = ", opening_.spacing, " m is not that of the flow, ",
            spacing_of_flow, " m; give the same"});
    }
    const auto due = static_cast<std::uint64_t>(motion_.layers(time));
    if (due < layers_ || due > layers_ + 1) {
      fail({motion_.name, ": ", double(due), " layers are due at ", time, " s, but ",
            double(layers_),
            " were made; pass it to each run() of one simulation, from its beginning on"});
    }
    if (!motion_.both->is_wall) {
      fail({motion_.name,
            ": its piston() is none of the walls of the flow, so that fluid would pass the opening "
            "as it likes; add it to the faces of ImageWalls::moving_2d or moving_3d"});
    }
    if (due > layers_) {
      make_layer();
      layers_ = due;
    }
    motion_.both->time_of_layers = time;
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("layers", layers_);
  }

 private:
  static const VelocityOpening<Dim>& checked(const VelocityOpening<Dim>& opening) {
    require_positive("VelocityOpening: spacing", opening.spacing);
    require_finite("VelocityOpening: velocity", opening.velocity);
    require_finite("VelocityOpening: from", opening.from);
    require_not_negative("VelocityOpening: ramp", opening.ramp);
    if (std::isnan(opening.level)) fail("VelocityOpening: level is not a number; give a height");
    const double square = opening.velocity.squaredNorm();
    if (!(square > 0) || !is_finite(square)) {
      fail({"VelocityOpening: velocity = ", to_text(opening.velocity),
            " m/s has no direction, or a square that underflows or overflows; give that of the "
            "fluid in the opening"});
    }
    return opening;
  }

  VelocityOpening<Dim> opening_;
  PlaneOfOpening<Dim> plane_;
  MotionOfPiston<Dim> motion_;
  std::uint64_t layers_ = 0;
};

}  // namespace detail

}  // namespace silt::mps
