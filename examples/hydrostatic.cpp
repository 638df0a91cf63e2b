// SPDX-License-Identifier: MIT
// Hydrostatic pressure in a tank of water: the study of Figs 4 to 9 in S.C. Hwang, B.H. Lee,
// J.C. Park, "Improvement of MPS method in simulating violent free-surface motion and predicting
// impact-loads". There is an option for each choice of the paper's scheme; without any of them,
// Silt's recommended scheme is used.
//
//   hydrostatic --out out/hydrostatic
//   hydrostatic --scheme paper --out out/hydrostatic_case_10
//   hydrostatic --kernel 3a --collision 0.5,0.2 --out out/hydrostatic_3a
//   hydrostatic --dimension 3 --spacing 0.02 --thickness 0.2 --out out/hydrostatic_3d
//   examples/plot_hydrostatic.py out/hydrostatic
//
// Depths are measured downwards from the still surface, which is --depth above the floor. With the
// recommended scheme, the exact pressure at a depth z, of fluid and of the gauge P1 on the floor, is
// ρ g z. With the paper's, a gauge on a wall reads the pressure of the nearby wall particles, which lie
// half a spacing behind the wall, and P = 0 holds at the surface particles, half a spacing below the
// still surface: the exact reading of P1, at the depth h, is ρ g h, and the exact pressure of fluid
// ρ g (z − l0/2).
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/flow_program.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using namespace silt;

struct Options : support::FlowOptions {
  std::string scheme;  // empty: chosen by the other options
  int source = 16;
  std::vector<double> collision = {1.0, 0.2};  // a [spacings], b
  std::string kernel = "3c";
  std::string surface = "both";
  int gradient = 18;
  double width = 0.4;             // [m]
  double depth = 0.4;             // [m]
  double thickness = 0.2;         // [m]
  double statistics_from = 0.5;   // [s]
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return support::add_option(app, name, value, text, check);
  };
  using support::positive, support::not_negative;
  app.add_option("--scheme", o.scheme, "recommended, or paper: given by the five options below, by "
                 "default those of case 10; default recommended, or paper if one of them is given")
      ->check(CLI::IsMember({"recommended", "paper"}));
  add("--source", o.source, "source term of the pressure equation: 9, the original, or 16",
      CLI::IsMember({9, 16}));
  add("--collision", o.collision, "A,B of the collision model: distance over spacing, and "
      "coefficient of restitution", not_negative())->delimiter(',')->expected(2);
  add("--kernel", o.kernel, "kernel of equation (3a), (3b) or (3c)",
      CLI::IsMember({"3a", "3b", "3c"}));
  add("--surface", o.surface, "condition of the free surface: (13), (17) or both",
      CLI::IsMember({"13", "17", "both"}));
  add("--gradient", o.gradient, "pressure gradient: 4, from the lowest neighbouring pressure, or "
      "18", CLI::IsMember({4, 18}));
  add("--width", o.width, "width of the tank [m], a whole number of spacings, like the next two",
      positive());
  add("--depth", o.depth, "depth of the water [m]", positive());
  add("--thickness", o.thickness, "thickness of the tank in 3D, along y [m]", positive());
  add("--statistics-from", o.statistics_from, "beginning of the time over which means and standard "
      "deviations are taken [s]", not_negative());
  support::describe_flow(app, o, "P1 of the paper: the middle of the floor",
                         "pressure.csv, profile.csv, summary.json and frames.pvd");
}

// Chooses the scheme from the other options if --scheme is not given.
void choose_scheme(const CLI::App& app, Options& o) {
  for (const char* choice : {"--source", "--collision", "--kernel", "--surface", "--gradient"}) {
    if (app.count(choice) == 0) continue;
    if (o.scheme == "recommended") {
      throw support::OptionError(std::string(choice) +
                                 " needs --scheme paper, but --scheme is recommended");
    }
    o.scheme = "paper";
  }
  if (o.scheme.empty()) o.scheme = "recommended";
}

// Walls extend above the water, because unstable schemes splash; by whole spacings, as they may be
// particles [m].
double wall_height(const Options& o) {
  return o.spacing * std::round(1.5 * o.depth / o.spacing);
}

template <class Scheme, int Dim>
auto make_tank(const Options& o) {
  return support::or_reject([&] {
    return mps::make_tank<Scheme, Dim>(
        {.column = {o.width, o.depth},
         .size = {.length = o.width, .height = wall_height(o), .depth = o.thickness},
         .spacing = o.spacing,
         .dummy_layers = support::dummy_layers(o),
         .on_escape = OnEscape::remove});
  });
}

// User-defined free-surface policy: condition (13), (17) or both, chosen at run time.
struct ChosenSurface {
  bool by_density = true;
  bool by_count = true;
  mps::DensitySurface density{};
  mps::CountSurface neighbours{};

  void check() const {
    density.check();
    neighbours.check();
  }
  bool is_on_surface(const mps::LocalDensity& local_density) const {
    return (!by_density || density.is_on_surface(local_density)) &&
           (!by_count || neighbours.is_on_surface(local_density));
  }
};

// Time-weighted mean and standard deviation.
class Average {
 public:
  struct Sample {
    double value;
    double seconds;
  };
  void add(const Sample& sample) {
    seconds_ += sample.seconds;
    const double deviation = sample.value - mean_;
    mean_ += deviation * sample.seconds / seconds_;
    squares_ += deviation * (sample.value - mean_) * sample.seconds;
  }
  bool empty() const { return !(seconds_ > 0); }
  double mean() const { return mean_; }
  double deviation() const { return std::sqrt(squares_ / seconds_); }
  template <class Archive>
  void transfer(Archive& archive) {
    archive("seconds", seconds_);
    archive("mean", mean_);
    archive("squares", squares_);
  }

 private:
  double seconds_ = 0;
  double mean_ = 0;
  double squares_ = 0;
};

// Observer that averages the first gauge, and the fluid in layers one spacing thick, over time.
template <int Dim>
class Statistics {
 public:
  Statistics(const Options& o, const support::PressureGauges<Dim>& gauges)
      : options_(&o),
        gauges_(&gauges),
        layers_(static_cast<Index>(std::lround(o.depth / o.spacing))) {}

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    if (simulation.time() < options_->statistics_from) return;
    const double dt = simulation.last_time_step();
    gauge_.add({gauges_->first(), dt});

    const auto& particles = simulation.particles();
    std::vector<Sums> sums(layers_.size());
    for (Index i = 0; i < particles.size(); ++i) {
      if (particles[mps::kind][i] != mps::Kind::fluid) continue;
      const double depth = options_->depth - particles[position][i][Dim - 1];
      const double layer = std::floor(depth / options_->spacing);
      if (!(layer >= 0 && layer < double(layers_.size()))) continue;
      Sums& sum = sums[static_cast<Index>(layer)];
      sum.pressure += particles[mps::pressure][i];
      sum.depth += depth;
      ++sum.particles;
    }
    for (Index k = 0; k < layers_.size(); ++k) {
      if (sums[k].particles == 0) continue;
      layers_[k].pressure.add({sums[k].pressure / sums[k].particles, dt});
      layers_[k].depth.add({sums[k].depth / sums[k].particles, dt});
    }
  }

  template <class Archive>
  void transfer(Archive& archive) {
    gauge_.transfer(archive);
    for (Layer& layer : layers_) {
      layer.pressure.transfer(archive);
      layer.depth.transfer(archive);
    }
  }

  const Average& gauge() const { return gauge_; }

  // depth: mean over the particles of the layer and time, below the still surface.
  void write_profile(const std::string& path) const {
    CsvFile file(path, {"depth", "p_mean", "p_std"});
    file.begin();  // there may be no row
    for (const Layer& layer : layers_) {
      if (layer.pressure.empty()) continue;
      file.row({layer.depth.mean(), layer.pressure.mean(), layer.pressure.deviation()});
    }
  }

 private:
  struct Sums {
    double pressure = 0;
    double depth = 0;
    int particles = 0;
  };
  struct Layer {
    Average pressure;
    Average depth;
  };

  const Options* options_;
  const support::PressureGauges<Dim>* gauges_;
  Average gauge_;
  std::vector<Layer> layers_;
};

// Height of the surface, as twice the mean height of the fluid [m].
template <class P>
double level(const P& particles) {
  double sum = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::fluid) continue;
    sum += particles[position][i][P::dimension - 1];
  }
  return 2 * sum / double(count(particles, mps::Kind::fluid));
}

template <class Scheme, int Dim>
void simulate(const Options& o, mps::FlowSettings<Dim, Scheme> settings) {
  const auto start = make_tank<Scheme, Dim>(o);
  const auto& particles = start.particles;
  settings.walls = start.walls;
  const auto water = support::or_reject([&] {
    return mps::Flow<Scheme, Dim>{settings, mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  });
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);

  Simulation tank{particles, TimedSearch{UniformGrid<Dim>{}}, water,
                  SemiImplicit<>{}};
  support::PressureGauges<Dim> gauges(o);
  Statistics<Dim> statistics(o, gauges);
  support::SolverIterations iterations;
  Stopwatch wall;
  {
    const auto span = wall.start();
    support::run_or_resume(o.resume, o.out, tank,
                           {.until = o.until, .output_every = o.output_every}, gauges, statistics,
                           iterations, VtkSeries{o.out + "/frames"}, Progress{});
  }
  statistics.write_profile(o.out + "/profile.csv");

  nlohmann::ordered_json summary;
  const double gauge_depth = o.depth - o.probes.front().back();
  const double analytic = settings.density * support::g * gauge_depth;
  const Average& gauge = statistics.gauge();
  summary["rer"] = nullptr;  // (14)
  summary["std_over_mean"] = nullptr;
  summary["mean"] = nullptr;
  if (!gauge.empty()) {
    summary["rer"] = gauge.mean() / analytic - 1;
    summary["std_over_mean"] = gauge.deviation() / gauge.mean();
    summary["mean"] = gauge.mean();
  }
  summary["analytic"] = analytic;  // ρ g times the depth of the gauge
  summary["still_depth"] = o.depth;
  summary["level"] = level(tank.particles());
  summary.update(support::summary_of(tank, particles, iterations, wall.seconds()));
  auto& options = summary["options"];
  options["scheme"] = o.scheme;
  if (o.scheme == "paper") {
    options.update({{"source", o.source},
                    {"collision", o.collision},
                    {"kernel", o.kernel},
                    {"surface", o.surface},
                    {"gradient", o.gradient}});
  }
  options["width"] = o.width;
  options["depth"] = o.depth;
  options["thickness"] = o.thickness;
  options["statistics_from"] = o.statistics_from;
  support::add_flow_options(options, o);
  support::complete(o.resume, o.out, summary);

  std::printf("hydrostatic: %zu fluid particles, "
              "%llu steps in %.1f s of wall-clock time, %llu lost; ",
              count(particles, mps::Kind::fluid), static_cast<unsigned long long>(tank.steps()),
              wall.seconds(), static_cast<unsigned long long>(tank.particles_lost()));
  if (gauge.empty()) {
    std::printf("too short for statistics, which begin at %g s; results in %s\n", o.statistics_from,
                o.out.c_str());
  } else {
    std::printf("RER %.2f %%, standard deviation %.2f %% of the mean; results in %s\n",
                100 * (gauge.mean() / analytic - 1), 100 * gauge.deviation() / gauge.mean(),
                o.out.c_str());
  }
}

template <int Dim>
void simulate_recommended(const Options& o) {
  simulate<mps::Recommended, Dim>(o, support::flow_settings<mps::Recommended, Dim>(o, o.depth));
}

// Choices that are types select a template instance; the others are settings.
template <int Dim, class Source, class Kernel, class Gradient>
void simulate(const Options& o) {
  struct Scheme : mps::Case10 {
    Source source{};
    Kernel kernel{};
    ChosenSurface surface{};
    Gradient gradient{};
  };
  auto settings = support::flow_settings<Scheme, Dim>(o, o.depth);
  settings.collision.distance = o.collision[0];
  settings.collision.restitution = o.collision[1];
  settings.surface = {.by_density = o.surface != "17", .by_count = o.surface != "13"};
  simulate<Scheme, Dim>(o, settings);
}

template <int Dim, class Source, class Kernel>
void simulate(const Options& o) {
  o.gradient == 4 ? simulate<Dim, Source, Kernel, mps::MinimumGradient>(o)
                  : simulate<Dim, Source, Kernel, mps::ConservingGradient>(o);
}

template <class Source>
void simulate_with_kernel(const Options& o) {
  if (o.kernel == "3a") return simulate<2, Source, mps::InverseKernel>(o);
  if (o.kernel == "3b") return simulate<2, Source, mps::GaussianKernel>(o);
  simulate<2, Source, mps::CubicKernel>(o);
}

void simulate_2d(const Options& o) {
  if (o.scheme == "recommended") return simulate_recommended<2>(o);
  o.source == 9 ? simulate_with_kernel<mps::DensitySource>(o)
                : simulate_with_kernel<mps::DivergenceSource>(o);
}

// Every scheme costs compile time, so 3D, which the paper does not treat, has only the scheme that
// the paper adopts.
void simulate_3d(const Options& o) {
  if (o.scheme == "recommended") return simulate_recommended<3>(o);
  if (o.source != 16 || o.kernel != "3c") {
    throw support::OptionError("--dimension 3 supports only --source 16 and --kernel 3c; for "
                               "others change simulate_3d() in hydrostatic.cpp");
  }
  simulate<3, mps::DivergenceSource, mps::CubicKernel>(o);
}

void check_probes(const Options& o) {
  for (const auto& probe : o.probes) {
    if (probe.back() < o.depth) continue;
    throw support::OptionError("--probe at a height of " + to_text(probe.back()) +
                               " m must lie below the still surface, at " +
                               to_text(o.depth) + " m");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.until = 2;
  options.out = "out/hydrostatic";
  CLI::App app("Water at rest in a tank", "hydrostatic");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    choose_scheme(app, options);
    const double middle = options.width / 2;
    if (options.dimension == 2) {
      support::read_probes(options, {options.width, wall_height(options)}, {middle, 0});
      check_probes(options);
      simulate_2d(options);
    } else {
      support::read_probes(options, {options.width, options.thickness, wall_height(options)},
                           {middle, options.thickness / 2, 0});
      check_probes(options);
      simulate_3d(options);
    }
  });
}
