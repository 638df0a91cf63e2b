// SPDX-License-Identifier: MIT
// Flows in 2D with a known solution: Taylor–Green vortices, a standing wave, an oscillating drop, a
// rotating square, a falling block. Each is defined in a header in support/fluid_cases/, with the
// quantities that are compared with the solution.
//
//   fluid_cases --case taylor_green --out out/taylor_green
//   fluid_cases --case oscillating_drop --swing 0.4 --scheme case10 --out out/drop
//   examples/plot_fluid_cases.py out/taylor_green
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"
#include "support/findings.hpp"
#include "support/flow_program.hpp"
#include "support/fluid_cases/all.hpp"
#include "support/resume.hpp"

#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace silt;

struct Options {
  fluid_cases::Choice choice{.name = "taylor_green"};
  fluid_cases::Numerics numerics;
  std::string scheme = "recommended";
  double until = 0;  // [s]; 0: that of the case
  int frames = 24;
  int threads = 0;
  std::string out = "out/fluid_cases";
  support::Resume resume = {};
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return support::add_option(app, name, value, text, check);
  };
  using support::positive, support::not_negative, support::between;
  add("--case", o.choice.name, "which flow", CLI::IsMember(fluid_cases::names()));
  add("--scheme", o.scheme, "recommended; wall_particles, that for walls of particles; or case10, "
      "PNU-MPS of the paper", CLI::IsMember({"recommended", "wall_particles", "case10"}));
  add("--spacing", o.choice.spacing, "particle spacing [m]: 1/spacing particles along the side, "
      "radius or wavelength of 1 m", positive());
  add("--swing", o.choice.swing, "amplitude A0/B0 of the oscillating drop", positive());
  add("--until", o.until, "end of the run [s]; 0: that of the comparison", not_negative());
  add("--radius", o.numerics.radius,
      "effective radius of number density, surface, gradient and divergence [spacings]",
      between({1.5, 6}));
  add("--laplacian-radius", o.numerics.laplacian_radius,
      "effective radius of the Laplacian [spacings]", between({1.5, 6}));
  add("--courant", o.numerics.courant, "Courant number: displacement of the fastest particle per "
      "step [spacings]", between({1e-3, 0.5}));
  add("--frames", o.frames, "number of frames after the initial one", between({1, 100000}));
  add("--threads", o.threads, support::threads_help, between({0, 1024}));
  app.add_option("--out", o.out, "folder for history.csv, summary.json and frames.pvd")
      ->capture_default_str();
  support::describe_resume(app, o.resume);
}

template <class Scheme>
void flow_as(const Options& o) {
  fluid_cases::FluidCase flow = support::or_reject([&] { return fluid_cases::make(o.choice); });
  const bool is_whole = !(o.until > 0) || o.until >= flow.until;
  if (o.until > 0) flow.until = o.until;
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);

  auto simulation = fluid_cases::simulation_of<Scheme>(flow, o.numerics);
  CsvFile file(o.out + "/history.csv", flow.names);
  fluid_cases::Notes notes(flow, [&](const std::vector<double>& row) { file.row(row); });
  support::SolverIterations iterations;
  Stopwatch wall;
  {
    const auto span = wall.start();
    VtkSeries frames{o.out + "/frames"};
    support::ResumableRun run(o.resume, o.out + "/checkpoint.silt", simulation, file, notes,
                              iterations, frames);
    run.run({.until = flow.until, .output_every = flow.until / o.frames}, notes, iterations, frames,
            Progress{});
  }

  auto summary = support::summary_of(simulation, flow.start, iterations, wall.seconds());
  // The comparison is defined for a complete run only.
  summary["findings"] = support::report(is_whole ? flow.findings(notes.history())
                                                 : std::vector<support::Finding>{});
  summary["options"] = {{"case", flow.name},
                        {"scheme", o.scheme},
                        {"spacing", o.choice.spacing},
                        {"swing", o.choice.swing},
                        {"until", flow.until},
                        {"radius", o.numerics.radius},
                        {"laplacian_radius", o.numerics.laplacian_radius},
                        {"courant", o.numerics.courant},
                        {"frames", o.frames},
                        {"threads", o.threads}};
  support::complete(o.resume, o.out, summary);
  std::printf("fluid_cases: %s, %zu particles, "
              "%llu steps in %.1f s of wall-clock time; results in %s\n",
              flow.name.c_str(), flow.start.size(),
              static_cast<unsigned long long>(simulation.steps()),
              wall.seconds(), o.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Flows with a known solution", "fluid_cases");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    if (options.scheme == "case10") return flow_as<mps::Case10>(options);
    if (options.scheme == "wall_particles") {
      return flow_as<mps::RecommendedForWallParticles>(options);
    }
    flow_as<mps::Recommended>(options);
  });
}
