// SPDX-License-Identifier: MIT
// Shared by the examples of grains in water that does not resolve them: options, and a run with a
// record of every step, frames of both, and findings.
#pragma once

#include <silt/coupled.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/timed.hpp>

#include <nlohmann/json.hpp>

#include "disc_drag.hpp"
#include "flow_program.hpp"
#include "flow_study.hpp"
#include "history.hpp"

#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>

namespace support {

struct CoupledOptions : FlowOptions {
  double diameter = 0.01;      // d of the grains [m]
  double density = 2500;       // of the grains [kg/m³]
  double stiffness = 2e4;      // of contacts, in 3D [N/m]
  double friction_angle = 25;  // [degrees]
  double restitution = 0.5;    // [-]
  double viscosity = 1e-6;     // ν of the water [m²/s]
};

/// Adds the options of grains and of a flow. `files` describes the content of --out.
inline void describe_coupled(CLI::App& app, CoupledOptions& o, const std::string& files) {
  add_option(app, "--diameter", o.diameter, "of the grains [m], at most the spacing", positive());
  add_option(app, "--density", o.density, "of the grains [kg/m3]", positive());
  add_option(app, "--stiffness", o.stiffness,
             "of contacts between grains [N/m]; in 2D, over the diameter, per metre of depth",
             positive());
  add_option(app, "--friction-angle", o.friction_angle, "of grains and walls [degrees]",
             between({0, 80}));
  add_option(app, "--restitution", o.restitution, "of grains", between({0.01, 1}));
  add_option(app, "--viscosity", o.viscosity, "kinematic one of the water [m2/s]", positive());
  describe_numerics(app, o, files);
}

/// Throws if grains are larger than the spacing: the flow would have to resolve them.
inline void require_small_grains(const CoupledOptions& o) {
  if (o.diameter > o.spacing) {
    throw OptionError("--diameter " + silt::to_text(o.diameter) + " is above --spacing " +
                      silt::to_text(o.spacing));
  }
}
/// Throws in 2D.
inline void require_spheres(const CoupledOptions& o) {
  if (o.dimension == 2) {
    throw OptionError("--dimension 2: the drag is one of spheres; leave it out");
  }
}

/// The law of contacts.
template <int Dim>
silt::dem::CundallStrack law_of(const CoupledOptions& o) {
  const double stiffness = Dim == 3 ? o.stiffness : o.stiffness / o.diameter;
  return {.normal_stiffness = stiffness,
          .tangential_stiffness = stiffness * 2 / 7,
          .restitution = o.restitution,
          .friction_angle = o.friction_angle * std::numbers::pi / 180};
}

/// Contacts in a square tank of this width, with a floor at a height [m].
inline auto contacts_in_tank(const CoupledOptions& o, double width, double floor = 0) {
  const silt::Box<3> tank{.lower = {0, 0, floor},
                          .upper = {width, width, std::numeric_limits<double>::infinity()}};
  return silt::dem::Contacts{law_of<3>(o), silt::dem::BoxWall<3>{.box = tank}};
}

/// Settings of the flow with the initial depth `depth` [m].
template <int Dim, class Scheme = silt::mps::InMixture<>>
silt::mps::FlowSettings<Dim, Scheme> mixture_settings(const CoupledOptions& o, double depth) {
  auto settings = flow_settings<Scheme, Dim>(o, depth);
  settings.viscosity = o.viscosity;
  return settings;
}

/// A drag law from a single sphere to a packed bed; in 2D of discs.
template <int Dim>
using DragOfGrains = std::conditional_t<Dim == 2, DiscDrag, silt::coupled::DiFelice>;

/// Both simulations in one.
template <int Dim, class Scheme, class Contacts, class Drag>
auto couple(const CoupledOptions& o, silt::coupled::GrainsInFluid<Dim> grains,
            silt::mps::FluidInMixture<Dim> water,
            const silt::mps::FlowSettings<Dim, Scheme>& settings, const Contacts& contacts,
            const Drag& drag) {
  using namespace silt;
  return or_reject([&] {
    const mps::Flow<Scheme, Dim> flow{settings,
                                      mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
    return coupled::Coupled{
        Simulation{std::move(grains), NeighbourList<Dim>{},
                   Forces{contacts, Gravity<Dim>{-g * Vec<Dim>::Unit(Dim - 1)},
                          coupled::FluidForces{drag}},
                   Leapfrog{}},
        Simulation{std::move(water), TimedSearch{UniformGrid<Dim>{}}, flow, SemiImplicit<>{}}};
  });
}

/// Runs or resumes both, and writes NAME.csv, frames.pvd of both, and summary.json. Further
/// observers are called before the record.
template <class Both, class Measure, class Evaluate, class... Observers>
void run_coupled(const CoupledOptions& o, Both& both, const Study<Measure, Evaluate>& study,
                 Observers&... observers) {
  open_output_folder(o.resume, o.out);
  use_threads_of_option(o.threads);
  const auto particles = both.fluid().particles();
  const silt::Index grains = both.grains().particles().size();
  Recorder record(o.out + "/" + study.name + ".csv", study.names, study.measure);
  SolverIterations iterations;
  silt::Stopwatch wall;
  {
    const auto span = wall.start();
    run_or_resume(o.resume, o.out, both, {.until = o.until, .output_every = o.output_every},
                  observers..., record, iterations, silt::VtkSeries{o.out + "/frames"},
                  silt::Progress{});
  }
  auto summary = summary_of(both.fluid(), particles, iterations, wall.seconds());
  summary["grains"] = grains;
  summary["grain_steps"] = both.grains().steps();
  summary["findings"] = report(study.evaluate(record.history()));
  auto& options = summary["options"] = study.options;
  options["diameter"] = o.diameter;
  options["density"] = o.density;
  options["stiffness"] = o.stiffness;
  options["friction_angle"] = o.friction_angle;
  options["restitution"] = o.restitution;
  options["viscosity"] = o.viscosity;
  add_flow_options(options, o);
  complete(o.resume, o.out, summary);
  std::printf(
      "%s: %zu grains and %zu particles, %llu steps in %.1f s of wall-clock time; results "
      "in %s\n",
      study.name.c_str(), grains, particles.size(), static_cast<unsigned long long>(both.steps()),
      wall.seconds(), o.out.c_str());
}

}  // namespace support
