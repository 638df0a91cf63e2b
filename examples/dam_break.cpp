// SPDX-License-Identifier: MIT
// A column of water collapses in a tank, computed with Silt's recommended scheme or one of the
// eleven of Table 1 in S.C. Hwang, B.H. Lee, J.C. Park, "Improvement of MPS method in simulating
// violent free-surface motion and predicting impact-loads". The front is compared with Martin and
// Moyce (1952).
//
//   dam_break --out out/dam_break
//   dam_break --case 00 --out out/dam_break/case_00
//   dam_break --dimension 3 --spacing 0.02 --depth 0.2 --out out/dam_break_3d
//   examples/plot_dam_break.py out/dam_break
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/flow_program.hpp"
#include "support/resume.hpp"

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr int recommended = -1;

struct Options : support::FlowOptions {
  int scheme = recommended;                 // or a case of Table 1
  std::vector<double> column = {0.4, 0.8};  // width, height [m]
  std::vector<double> tank = {1.6, 1.6};    // length, height [m]
  double depth = 0.2;                       // [m]
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return support::add_option(app, name, value, text, check);
  };
  using support::positive, support::between;
  // Names are converted to numbers; an integer that begins with 0 would be read as octal.
  const auto number_of = [](std::string& text) {
    if (text == "recommended") text = std::to_string(recommended);
    if (text.size() == 2 && text.front() == '0') text.erase(0, 1);
    return std::string();
  };
  app.add_option("--case", o.scheme, "recommended, or a column of Table 1: 00 the original MPS, 10 "
                 "PNU-MPS")
      ->check(support::between({recommended, 10}))
      ->transform(CLI::Validator(number_of, ""))
      ->default_str("recommended");
  add("--column", o.column, "width,height of the column of water [m]", positive())
      ->delimiter(',')->expected(2);
  add("--tank", o.tank, "length,height of the tank [m]; by default four column widths long, as in "
      "Koshizuka and Oka (1996), since the paper does not give it", positive())
      ->delimiter(',')->expected(2);
  add("--depth", o.depth, "depth of the tank in 3D [m]", positive());
  support::describe_flow(app, o, "P2 of the paper: on the right wall, 0.02 m above the floor",
                         "front.csv, pressure.csv, energy.csv, summary.json and frames.pvd");
}

template <int Dim>
auto make_tank(const Options& o) {
  return support::or_reject([&] {
    return mps::make_tank<Dim>(
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
    const Front front = find_front(simulation.particles(), simulation.search(),
                                   {.spacing = spacing_},
                                   [&](Index i) { return kinds[i] == mps::Kind::fluid; });
    file_.row({simulation.time(), front.x, front.height});
  }

  double spacing_;
  CsvFile file_;
};

template <class Scheme, int Dim>
void collapse(const Options& o) {
  const auto particles = make_tank<Dim>(o);
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);

  const mps::Flow<Scheme, Dim> water{support::flow_settings<Scheme, Dim>(o, o.column[1]),
                                     mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  Simulation dam{particles, TimedSearch{UniformGrid<Dim>{}}, water,
                 SemiImplicit<>{}};
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

  auto summary = support::summary_of(dam, particles, iterations, wall.seconds());
  auto& options = summary["options"];
  options = {{"case", nullptr}, {"column", o.column}, {"tank", o.tank}, {"depth", o.depth}};
  options["case"] = o.scheme;
  if (o.scheme == recommended) options["case"] = "recommended";
  support::add_flow_options(options, o);
  support::complete(o.out, summary);
  std::printf("dam_break: %zu fluid particles, "
              "%llu steps in %.1f s of wall-clock time, %llu lost; results in %s\n",
              count(particles, mps::Kind::fluid), static_cast<unsigned long long>(dam.steps()),
              wall.seconds(), static_cast<unsigned long long>(dam.particles_lost()),
              o.out.c_str());
}

// The eleven columns of Table 1, by number.
template <int Dim, class... Schemes>
void collapse_as(const Options& o) {
  int number = 0;
  ((number++ == o.scheme ? collapse<Schemes, Dim>(o) : void()), ...);
}

template <int Dim>
void collapse(const Options& o) {
  using namespace mps;
  if (o.scheme == recommended) return collapse<Recommended, Dim>(o);
  collapse_as<Dim, Case00, Case01, Case02, Case03, Case04, Case05, Case06, Case07, Case08, Case09,
              Case10>(o);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.out = "out/dam_break";
  CLI::App app("Collapse of a column of water in a tank", "dam_break");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    const auto& [length, height] = std::pair(options.tank[0], options.tank[1]);
    if (options.dimension == 2) {
      support::read_probes(options, {length, height}, {length, 0.02});
      collapse<2>(options);
    } else {
      support::read_probes(options, {length, options.depth, height},
                           {length, options.depth / 2, 0.02});
      collapse<3>(options);
    }
  });
}
