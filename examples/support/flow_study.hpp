// SPDX-License-Identifier: MIT
// Shared by the examples of water with walls that move, bodies or openings: a run, with a record of
// every step, frames of water and walls, and findings.
#pragma once

#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_walls.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <nlohmann/json.hpp>

#include "flow_program.hpp"
#include "history.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace support {

/// What is recorded after every step, and what follows from it.
template <class Measure, class Evaluate>
struct Study {
  std::string name;                // of the program, and of the file with the record
  std::vector<std::string> names;  // of the values of measure(simulation)
  Measure measure;
  Evaluate evaluate;               // the findings, from the History
  nlohmann::ordered_json options;  // of the program, in addition to those of the flow
};

// clang before 17 deduces none for an aggregate.
template <class Measure, class Evaluate>
Study(std::string, std::vector<std::string>, Measure, Evaluate, nlohmann::ordered_json)
    -> Study<Measure, Evaluate>;

/// Runs or resumes the flow of these particles, and writes NAME.csv, frames.pvd of the water,
/// walls.pvd of walls and bodies, and summary.json. Further observers, such as openings, are called
/// before the record.
template <int Dim, class Scheme, class Measure, class Evaluate, class... Observers>
void run_study(const FlowOptions& o, const silt::mps::Fluid<Dim>& particles,
               const silt::mps::FlowSettings<Dim, Scheme>& settings,
               const Study<Measure, Evaluate>& study, Observers&... observers) {
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
                  observers..., record, iterations, silt::VtkSeries{o.out + "/frames"},
                  silt::VtkWalls{o.out + "/walls"}, silt::Progress{});
  }
  auto summary = summary_of(simulation, particles, iterations, wall.seconds());
  summary["findings"] = report(study.evaluate(record.history()));
  auto& options = summary["options"] = study.options;
  add_flow_options(options, o);
  complete(o.resume, o.out, summary);
  std::printf(
      "%s: %zu particles, %llu steps in %.1f s of wall-clock time, %llu lost; results in "
      "%s\n",
      study.name.c_str(), particles.size(), static_cast<unsigned long long>(simulation.steps()),
      wall.seconds(), static_cast<unsigned long long>(simulation.particles_lost()), o.out.c_str());
}

}  // namespace support
