// SPDX-License-Identifier: MIT
// The run of the example dam_break, with any of its thirteen schemes. They take long to compile,
// therefore 2D and 3D are instantiated in source files of their own.
#pragma once

#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include "../flow_program.hpp"
#include "../resume.hpp"

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace dam_break {

using namespace silt;

inline constexpr int recommended = -1;
inline constexpr int for_wall_particles = -2;

struct Options : support::FlowOptions {
  int scheme = recommended;                 // or for_wall_particles, or a case of Table 1
  std::vector<double> column = {0.4, 0.8};  // width, height [m]
  std::vector<double> tank = {1.6, 1.6};    // length, height [m]
  double depth = 0.2;                       // [m]
};

template <class Scheme, int Dim>
auto make_tank(const Options& o) {
  return support::or_reject([&] {
    return mps::make_tank<Scheme, Dim>(
        {.column = {o.column[0], o.column[1]},
         .size = {.length = o.tank[0], .height = o.tank[1], .depth = o.depth},
         .spacing = o.spacing,
         .dummy_layers = support::dummy_layers(o),
         .on_escape = OnEscape::remove});
  });
}

// Observer that writes a row to front.csv at every step.
class FrontGauge {
 public:
  explicit FrontGauge(const Options& o)
      : spacing_(o.spacing), file_(o.out + "/front.csv", {"t", "x_front", "height"}) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) write(simulation);
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    write(simulation);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    file_.transfer(archive);
  }

 private:
  template <class Sim>
  void write(const Sim& simulation) {
    const auto kinds = simulation.particles()[mps::kind];
    // At most the search radius, which --radius may reduce.
    const double near = std::min(2.1, double(simulation.search().radius()) / spacing_);
    const Front front = find_front(simulation.particles(), simulation.search(),
                                   {.spacing = spacing_, .neighbour_radius = near},
                                   [&](Index i) { return kinds[i] == mps::Kind::fluid; });
    file_.row({simulation.time(), front.x, front.height});
  }

  double spacing_;
  CsvFile file_;
};

template <class Scheme, int Dim>
void collapse_with(const Options& o) {
  const auto tank = make_tank<Scheme, Dim>(o);
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);

  auto settings = support::flow_settings<Scheme, Dim>(o, o.column[1]);
  settings.walls = tank.walls;
  const mps::Flow<Scheme, Dim> water{settings,
                                     mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  Simulation dam{tank.particles, TimedSearch{UniformGrid<Dim>{}}, water, SemiImplicit<>{}};
  FrontGauge front(o);
  support::PressureGauges<Dim> gauges(o);
  support::EnergyFile energy(o);
  support::SolverIterations iterations;
  Stopwatch wall;
  {
    const auto span = wall.start();
    support::run_or_resume(o.resume, o.out, dam,
                           {.until = o.until, .output_every = o.output_every}, front, gauges,
                           energy, iterations, VtkSeries{o.out + "/frames"}, Progress{});
  }

  auto summary = support::summary_of(dam, tank.particles, iterations, wall.seconds());
  auto& options = summary["options"];
  options = {{"case", nullptr}, {"column", o.column}, {"tank", o.tank}, {"depth", o.depth}};
  options["case"] = o.scheme;
  if (o.scheme == recommended) options["case"] = "recommended";
  if (o.scheme == for_wall_particles) options["case"] = "wall_particles";
  support::add_flow_options(options, o);
  support::complete(o.resume, o.out, summary);
  std::printf("dam_break: %zu fluid particles, "
              "%llu steps in %.1f s of wall-clock time, %llu lost; results in %s\n",
              count(tank.particles, mps::Kind::fluid), static_cast<unsigned long long>(dam.steps()),
              wall.seconds(), static_cast<unsigned long long>(dam.particles_lost()),
              o.out.c_str());
}

// The eleven columns of Table 1, by number.
template <int Dim, class... Schemes>
void collapse_with_case(const Options& o) {
  int number = 0;
  ((number++ == o.scheme ? collapse_with<Schemes, Dim>(o) : void()), ...);
}

template <int Dim>
void collapse(const Options& o) {
  using namespace mps;
  if (o.scheme == recommended) return collapse_with<Recommended, Dim>(o);
  if (o.scheme == for_wall_particles) return collapse_with<RecommendedForWallParticles, Dim>(o);
  collapse_with_case<Dim, Case00, Case01, Case02, Case03, Case04, Case05, Case06, Case07, Case08,
                     Case09, Case10>(o);
}

extern template void collapse<2>(const Options&);
extern template void collapse<3>(const Options&);

}  // namespace dam_break
