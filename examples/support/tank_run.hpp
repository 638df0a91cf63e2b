// SPDX-License-Identifier: MIT
// Shared by the examples with walls and bodies that move: a tank of water, and its run.
#pragma once

#include <silt/geometry/shapes.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_walls.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "flow_program.hpp"
#include "history.hpp"

#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

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

/// What is recorded after every step, and what follows from it.
template <class Measure, class Evaluate>
struct Study {
  std::string name;                // of the program, and of the file with the record
  std::vector<std::string> names;  // of the values of measure(simulation)
  Measure measure;
  Evaluate evaluate;               // the findings, from the History
  nlohmann::ordered_json options;  // of the program, in addition to those of the tank
};

/// Runs or resumes the flow of these particles, and writes NAME.csv, frames.pvd of the water,
/// walls.pvd of walls and bodies, and summary.json.
template <int Dim, class Scheme, class Measure, class Evaluate>
void run_tank(const TankOptions& o, const silt::mps::Fluid<Dim>& particles,
              const silt::mps::FlowSettings<Dim, Scheme>& settings,
              const Study<Measure, Evaluate>& study) {
  const auto water = or_reject([&] {
    return silt::mps::Flow<Scheme, Dim>{settings,
                                        silt::mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  });
  open_output_folder(o.resume, o.out);
  use_threads_of_option(o.threads);
  silt::Simulation simulation{particles, silt::TimedSearch{silt::UniformGrid<Dim>{}}, water,
                              silt::SemiImplicit<>{}};
  Recorder record(o.out + "/" + study.name + ".csv", study.names, study.measure);
  SolverIterations iterations;
  silt::Stopwatch wall;
  {
    const auto span = wall.start();
    run_or_resume(o.resume, o.out, simulation, {.until = o.until, .output_every = o.output_every},
                  record, iterations, silt::VtkSeries{o.out + "/frames"},
                  silt::VtkWalls{o.out + "/walls"}, silt::Progress{});
  }
  auto summary = summary_of(simulation, particles, iterations, wall.seconds());
  summary["findings"] = report(study.evaluate(record.history()));
  auto& options = summary["options"] = study.options;
  options["length"] = o.length;
  options["depth"] = o.depth;
  options["thickness"] = o.thickness;
  add_flow_options(options, o);
  complete(o.resume, o.out, summary);
  std::printf(
      "%s: %zu particles, %llu steps in %.1f s of wall-clock time, %llu lost; results in "
      "%s\n",
      study.name.c_str(), particles.size(), static_cast<unsigned long long>(simulation.steps()),
      wall.seconds(), static_cast<unsigned long long>(simulation.particles_lost()), o.out.c_str());
}

}  // namespace support
