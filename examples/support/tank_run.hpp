// SPDX-License-Identifier: MIT
// Shared by the examples with walls and bodies that move: a tank of water, and its run.
#pragma once

#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "flow_program.hpp"
#include "flow_study.hpp"

#include <cmath>
#include <string>
#include <utility>

namespace support {

struct TankOptions : FlowOptions {
  double length = 0;       // [m], along x
  double depth = 0;        // [m], of the water
  double thickness = 0.2;  // [m], of the tank in 3D, along y

  /// Of the walls [m].
  double wall_height() const { return 2 * depth; }
};

/// Adds the options of a tank and of a flow. `files` describes the content of --out.
inline void describe_tank(CLI::App& app, TankOptions& o, const std::string& files) {
  add_option(app, "--length", o.length,
             "length of the tank [m], a whole number of spacings, like the next two", positive());
  add_option(app, "--depth", o.depth, "depth of the water [m]", positive());
  add_option(app, "--thickness", o.thickness, "thickness of the tank in 3D, along y [m]",
             positive());
  describe_numerics(app, o, files);
}

/// The tank filled with water at rest, with walls of the flow for it; particles that are
/// more than `margin` [m] beside it are lost.
template <class Scheme, int Dim>
auto make_tank(const TankOptions& o, double margin = 0) {
  return or_reject([&] {
    return silt::mps::make_tank<Scheme, Dim>(
        {.column = {o.length, o.depth},
         .size = {.length = o.length, .height = o.wall_height(), .depth = o.thickness},
         .spacing = o.spacing,
         .dummy_layers = 4 + static_cast<int>(std::ceil(margin / o.spacing)),
         .on_escape = silt::OnEscape::remove});
  });
}

/// Sets the walls that move.
template <int Dim>
void set_moving(silt::mps::ImageWalls& walls, silt::mps::MovingWalls<Dim> moving) {
  if constexpr (Dim == 2) {
    walls.moving_2d = std::move(moving);
  } else {
    walls.moving_3d = std::move(moving);
  }
}

/// See run_study().
template <int Dim, class Scheme, class Measure, class Evaluate>
void run_tank(const TankOptions& o, const silt::mps::Fluid<Dim>& particles,
              const silt::mps::FlowSettings<Dim, Scheme>& settings,
              Study<Measure, Evaluate> study) {
  study.options["length"] = o.length;
  study.options["depth"] = o.depth;
  study.options["thickness"] = o.thickness;
  run_study(o, particles, settings, study);
}

}  // namespace support
