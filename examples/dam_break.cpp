// SPDX-License-Identifier: MIT
// A column of water collapses in a tank, under each of the eleven schemes of Table 1 in S.C. Hwang,
// B.H. Lee, J.C. Park, "Improvement of MPS method in simulating violent free-surface motion and
// predicting impact-loads". The front is compared with Martin and Moyce (1952).
//
//   dam_break --out out/dam_break
//   dam_break --case 00 --out out/dam_break/case_00
//   dam_break --dimension 3 --spacing 0.02 --depth 0.2 --out out/dam_break_3d
//   examples/plot_dam_break.py out/dam_break
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace silt;

constexpr double g = 9.81;  // [m/s²]

struct Options {
  int scheme = 10;
  double spacing = 0.01;               // [m]
  std::vector<double> column = {0.4, 0.8};  // width, height [m]
  std::vector<double> tank = {1.6, 1.6};    // length, height [m]
  int dimension = 2;
  double depth = 0.2;                       // [m]
  double until = 1;                         // [s]
  std::vector<std::vector<double>> probes;  // [m]
  double radius = 3.1;                      // [spacings]
  double laplacian_radius = 3.1;            // [spacings]
  double courant = 0.2;
  double tolerance = 1e-6;
  double output_every = 0.02;               // [s]
  int threads = 1;
  std::string out = "out/dam_break";
};

void describe(CLI::App& app, Options& o, std::vector<std::string>& probes) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return app.add_option(name, value, text)->check(check)->capture_default_str();
  };
  using support::positive, support::between;
  add("--case", o.scheme, "column of Table 1: 00 the original MPS, 10 PNU-MPS", between({0, 10}));
  add("--spacing", o.spacing, "of the particles [m]", positive());
  add("--column", o.column, "width,height of the water [m]", positive())
      ->delimiter(',')->expected(2);
  add("--tank", o.tank, "length,height of the walls [m]; four column widths, as in Koshizuka and Oka "
      "(1996), since the paper does not say", positive())->delimiter(',')->expected(2);
  add("--dimension", o.dimension, "2 or 3", between({2, 3}));
  add("--depth", o.depth, "of the tank in 3D [m]", positive());
  add("--until", o.until, "end of the run [s]", positive());
  app.add_option("--probe", probes, "X,Y or in 3D X,Y,Z of a pressure gauge [m], repeatable; without "
                 "one P2 of the paper: on the right wall, 0.02 m above the floor");
  add("--radius", o.radius, "of number density, surface, gradient and divergence [spacings]",
      between({1.5, 6}));
  add("--laplacian-radius", o.laplacian_radius, "of the Laplacian [spacings]", between({1.5, 6}));
  add("--courant", o.courant, "spacings that the fastest particle goes in a step",
      between({1e-3, 0.5}));
  add("--tolerance", o.tolerance, "of the pressure solve: residual over right side",
      between({1e-12, 1e-1}));
  add("--output-every", o.output_every, "time between frames [s]", positive());
  add("--threads", o.threads, "threads; the result is the same bits for any number",
      between({1, 1024}));
  app.add_option("--out", o.out, "folder for front.csv, pressure.csv, summary.json and frames.pvd")
      ->capture_default_str();
}

// The numbers of every --probe X,Y[,Z].
void read_probes(Options& o, const std::vector<std::string>& texts) {
  for (const std::string& text : texts) {
    std::vector<double> point;
    for (const std::string& part : CLI::detail::split(text, ',')) {
      double value = 0;
      if (!CLI::detail::lexical_cast(part, value) || !is_finite(value)) {
        throw support::Refusal("--probe " + text + ": " + part + " is not a finite number");
      }
      point.push_back(value);
    }
    if (static_cast<int>(point.size()) != o.dimension) {
      throw support::Refusal("--probe " + text + " has " + std::to_string(point.size()) +
                             " coordinates and must have " + std::to_string(o.dimension));
    }
    const bool inside = point.front() >= 0 && point.front() <= o.tank[0] && point.back() >= 0 &&
                        point.back() <= o.tank[1] &&
                        (o.dimension == 2 || (point[1] >= 0 && point[1] <= o.depth));
    if (!inside) throw support::Refusal("--probe " + text + " must lie in the tank or on its walls");
    o.probes.push_back(point);
  }
  if (!o.probes.empty()) return;
  o.probes.push_back(o.dimension == 2 ? std::vector{o.tank[0], 0.02}
                                      : std::vector{o.tank[0], o.depth / 2, 0.02});
}

template <int Dim>
auto make_tank(const Options& o) {
  try {
    return mps::make_tank<Dim>(
        {.column = {o.column[0], o.column[1]},
         .size = {.length = o.tank[0], .height = o.tank[1], .depth = o.depth},
         .spacing = o.spacing,
         .dummy_layers = static_cast<int>(std::ceil(std::max(o.radius, o.laplacian_radius))),
         .leavers = Leavers::remove});
  } catch (const Error& error) {
    throw support::Refusal(error.what());
  }
}

// Writes front.csv and pressure.csv at every step, and counts what the solver did.
template <int Dim>
class Gauges {
 public:
  explicit Gauges(const Options& o)
      : spacing_(o.spacing),
        front_(o.out + "/front.csv", {"t", "x_front", "height"}),
        pressure_(o.out + "/pressure.csv", names(o)) {
    for (const auto& point : o.probes) {
      probes_.push_back({.point = Eigen::Map<const Vec<Dim>>(point.data()), .spacing = o.spacing});
    }
  }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) write(simulation);
  }

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    const int iterations = simulation.interaction().last_solve().iterations;
    iterations_ += iterations;
    most_iterations_ = std::max(most_iterations_, iterations);
    write(simulation);
  }

  double iterations() const { return iterations_; }  // added up over all steps
  int most_iterations() const { return most_iterations_; }

 private:
  static std::vector<std::string> names(const Options& o) {
    std::vector<std::string> names{"t"};
    for (std::size_t k = 1; k <= o.probes.size(); ++k) names.push_back("p_" + std::to_string(k));
    return names;
  }

  template <class Sim>
  void write(const Sim& simulation) {
    const auto& particles = simulation.particles();
    const auto kinds = particles[mps::kind];
    const auto is = [&](mps::Kind wanted) {
      return [&kinds, wanted](Index i) { return kinds[i] == wanted; };
    };
    const Front front = find_front(particles, simulation.search(), {.spacing = spacing_},
                                   is(mps::Kind::fluid));
    front_.row({simulation.time(), front.x, front.height});
    std::vector<double> row{simulation.time()};
    for (const Probe<Dim>& probe : probes_) {
      // A gauge on a wall reads the wall; one that no wall is near reads the fluid.
      const auto of_wall = probe.read(particles, mps::pressure, is(mps::Kind::wall));
      const auto of_fluid = probe.read(particles, mps::pressure, is(mps::Kind::fluid));
      row.push_back(of_wall ? *of_wall : of_fluid.value_or(0));
    }
    pressure_.row(row);
  }

  double spacing_;
  CsvFile front_;
  CsvFile pressure_;
  std::vector<Probe<Dim>> probes_;
  double iterations_ = 0;
  int most_iterations_ = 0;
};

template <class Scheme, int Dim>
void collapse(const Options& o) {
  auto particles = make_tank<Dim>(o);
  support::make_output_folder(o.out);
  use_threads(o.threads);
  const Index fluid_particles = count(particles, mps::Kind::fluid);
  const Index wall_particles = count(particles, mps::Kind::wall);

  mps::Flow<Scheme, Dim> water{{.spacing = o.spacing,
                                .radius = o.radius,
                                .laplacian_radius = o.laplacian_radius,
                                .courant = o.courant,
                                .speed_scale = std::sqrt(g * o.column[1])},
                               mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  Simulation dam{std::move(particles), TimedSearch{NeighbourList<Dim>{{.skin_fraction = 0}}}, water,
                 SemiImplicit<>{}};
  Gauges<Dim> gauges(o);
  Stopwatch wall;
  {
    const auto span = wall.start();
    dam.run({.until = o.until, .output_every = o.output_every}, gauges,
            VtkSeries{o.out + "/frames"}, Progress{});
  }

  const auto steps = double(std::max<std::uint64_t>(dam.steps(), 1));
  support::write_summary(o.out, {{"steps", dam.steps()},
                                 {"wall_seconds", wall.seconds()},
                                 {"fluid_particles", fluid_particles},
                                 {"wall_particles", wall_particles},
                                 {"dummy_particles", count(dam.particles(), mps::Kind::dummy)},
                                 {"time_simulated", dam.time()},
                                 {"solver_iterations_mean", gauges.iterations() / steps},
                                 {"solver_iterations_max", gauges.most_iterations()},
                                 {"seconds_search", dam.search().seconds()},
                                 {"seconds_pressure", dam.interaction().seconds_in_pressure()},
                                 {"seconds_total", wall.seconds()},
                                 {"particles_lost", dam.particles_lost()},
                                 {"options",
                                  {{"case", o.scheme},
                                   {"spacing", o.spacing},
                                   {"column", o.column},
                                   {"tank", o.tank},
                                   {"dimension", o.dimension},
                                   {"depth", o.depth},
                                   {"until", o.until},
                                   {"probes", o.probes},
                                   {"radius", o.radius},
                                   {"laplacian_radius", o.laplacian_radius},
                                   {"courant", o.courant},
                                   {"tolerance", o.tolerance},
                                   {"threads", o.threads}}}});
  std::printf("dam_break: %zu fluid particles, %llu steps in %.1f s, %llu lost; see %s\n",
              fluid_particles, static_cast<unsigned long long>(dam.steps()), wall.seconds(),
              static_cast<unsigned long long>(dam.particles_lost()), o.out.c_str());
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
  collapse_as<Dim, Case00, Case01, Case02, Case03, Case04, Case05, Case06, Case07, Case08, Case09,
              Case10>(o);
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  std::vector<std::string> probes;
  CLI::App app("Collapse of a column of water in a tank", "dam_break");
  describe(app, options, probes);
  return support::run(app, argc, argv, [&] {
    read_probes(options, probes);
    options.dimension == 2 ? collapse<2>(options) : collapse<3>(options);
  });
}
