// SPDX-License-Identifier: MIT
// Water stands in a tank, whose pressure everybody knows: the study of Figs 4 to 9 in S.C. Hwang,
// B.H. Lee, J.C. Park, "Improvement of MPS method in simulating violent free-surface motion and
// predicting impact-loads". Each choice of the paper's scheme is an option of its own; with none of
// them, the scheme is Silt's recommended one.
//
//   hydrostatic --out out/hydrostatic
//   hydrostatic --scheme paper --out out/hydrostatic_case_10
//   hydrostatic --kernel 3a --collision 0.5,0.2 --out out/hydrostatic_3a
//   hydrostatic --dimension 3 --spacing 0.02 --thickness 0.2 --out out/hydrostatic_3d
//   examples/plot_hydrostatic.py out/hydrostatic
//
// What is read where. Depths are measured downwards from the still surface, --depth above the floor
// (rounded to whole spacings, as all lengths of the tank are).
// A gauge on a wall takes the pressure of the wall particles around it, which lie half a spacing
// behind the wall, for that of its own place: P1, on the floor, is at the depth of the water, and
// must read ρ g h. (P = 0 lies in the particles of the surface, half a spacing below the still
// surface: they are as far from the floor's wall particles as the water is deep.) Fluid at a depth z
// has ρ g (z − l0/2), therefore.
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
  std::string scheme;  // empty: by the others
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
  app.add_option("--scheme", o.scheme, "recommended, or paper: made of the five choices below, by "
                 "default those of case 10; without it paper if one of them is given")
      ->check(CLI::IsMember({"recommended", "paper"}));
  add("--source", o.source, "of the pressure equation: (9) the original, or (16)",
      CLI::IsMember({9, 16}));
  add("--collision", o.collision, "A,B: the distance over the spacing and the restitution",
      not_negative())->delimiter(',')->expected(2);
  add("--kernel", o.kernel, "(3a), (3b) or (3c)", CLI::IsMember({"3a", "3b", "3c"}));
  add("--surface", o.surface, "pressure is zero where (13), where (17), or where both hold",
      CLI::IsMember({"13", "17", "both"}));
  add("--gradient", o.gradient, "(4) from the lowest pressure around, or (18)",
      CLI::IsMember({4, 18}));
  add("--width", o.width, "of the tank [m]", positive());
  add("--depth", o.depth, "of the water [m]", positive());
  add("--thickness", o.thickness, "of the tank in 3D, along y [m]", positive());
  add("--statistics-from", o.statistics_from, "when means and deviations begin [s]",
      not_negative());
  support::describe_flow(app, o, "P1 of the paper: the middle of the floor",
                         "pressure.csv, profile.csv, summary.json and frames.pvd");
}

// The depth of the water in whole spacings, as the tank is made [m].
double still_depth(const Options& o) { return std::round(o.depth / o.spacing) * o.spacing; }

// The scheme that the options ask for, where they do not name it.
void choose_scheme(const CLI::App& app, Options& o) {
  for (const char* choice : {"--source", "--collision", "--kernel", "--surface", "--gradient"}) {
    if (app.count(choice) == 0) continue;
    if (o.scheme == "recommended") {
      throw support::Refusal(std::string(choice) + " is a choice of --scheme paper, not recommended");
    }
    o.scheme = "paper";
  }
  if (o.scheme.empty()) o.scheme = "recommended";
}

// Walls go on above the water, which would leave the tank where a scheme boils.
double wall_height(const Options& o) { return 1.5 * o.depth; }

template <int Dim>
auto make_tank(const Options& o) {
  return support::or_refuse([&] {
    return mps::make_tank<Dim>(
        {.column = {o.width, o.depth},
         .size = {.length = o.width, .height = wall_height(o), .depth = o.thickness},
         .spacing = o.spacing,
         .dummy_layers = support::dummy_layers(o),
         .on_escape = OnEscape::remove});
  });
}

// (13), (17) or both, as the options have it: a free surface of one's own is any such struct.
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
    return (!by_density || density.is_on_surface(local_density)) && (!by_count || neighbours.is_on_surface(local_density));
  }
};

// Mean and standard deviation of samples that each hold for some time.
class Average {
 public:
  struct Sample {
    double value;
    double seconds;
  };
  void add(const Sample& sample) {
    seconds_ += sample.seconds;
    const double off = sample.value - mean_;
    mean_ += off * sample.seconds / seconds_;
    squares_ += off * (sample.value - mean_) * sample.seconds;
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

// Observer that averages the first gauge, and the fluid in layers of one spacing, over time.
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
      const double depth = still_depth(*options_) - particles[position][i][Dim - 1];
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

  // depth: of the fluid in the layer, on average over particles and time, below the still surface.
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

// Twice the mean height of the fluid: where its surface is [m].
template <class P>
double level(const P& particles) {
  double sum = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::fluid) continue;
    sum += particles[position][i][P::dimension - 1];
  }
  return 2 * sum / double(count(particles, mps::Kind::fluid));
}

// Any scheme, with any settings of its own.
template <class Scheme, int Dim>
void stand(const Options& o, const mps::FlowSettings<Dim, Scheme>& settings) {
  const auto water = support::or_refuse([&] {
    return mps::Flow<Scheme, Dim>{settings, mps::PressureSolver<Dim>{{.tolerance = o.tolerance}}};
  });
  const auto particles = make_tank<Dim>(o);
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
  const double analytic = settings.density * support::g * (still_depth(o) - o.probes.front().back());
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
  summary["still_depth"] = still_depth(o);
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
  support::complete(o.out, summary);

  std::printf("hydrostatic: %zu fluid particles, %llu steps in %.1f s, %llu lost; ",
              count(particles, mps::Kind::fluid), static_cast<unsigned long long>(tank.steps()),
              wall.seconds(), static_cast<unsigned long long>(tank.particles_lost()));
  if (gauge.empty()) {
    std::printf("too short for statistics, which begin at %g s; see %s\n", o.statistics_from,
                o.out.c_str());
  } else {
    std::printf("RER %.2f %%, standard deviation %.2f %% of the mean; see %s\n",
                100 * (gauge.mean() / analytic - 1), 100 * gauge.deviation() / gauge.mean(),
                o.out.c_str());
  }
}

template <int Dim>
void stand_as_recommended(const Options& o) {
  stand<mps::Recommended, Dim>(o, support::flow_settings<mps::Recommended, Dim>(o, o.depth));
}

// The paper's choices that are types are compiled, the others are numbers.
template <int Dim, class Source, class Kernel, class Gradient>
void stand(const Options& o) {
  using Scheme = mps::Scheme<Source, mps::AdoptedCollision, Kernel, ChosenSurface, Gradient>;
  auto settings = support::flow_settings<Scheme, Dim>(o, o.depth);
  settings.collision.distance = o.collision[0];
  settings.collision.restitution = o.collision[1];
  settings.surface = {.by_density = o.surface != "17", .by_count = o.surface != "13"};
  stand<Scheme, Dim>(o, settings);
}

template <int Dim, class Source, class Kernel>
void stand(const Options& o) {
  o.gradient == 4 ? stand<Dim, Source, Kernel, mps::MinimumGradient>(o)
                  : stand<Dim, Source, Kernel, mps::ConservingGradient>(o);
}

template <class Source>
void stand_with_kernel(const Options& o) {
  if (o.kernel == "3a") return stand<2, Source, mps::InverseKernel>(o);
  if (o.kernel == "3b") return stand<2, Source, mps::GaussianKernel>(o);
  stand<2, Source, mps::CubicKernel>(o);
}

void stand_in_2d(const Options& o) {
  if (o.scheme == "recommended") return stand_as_recommended<2>(o);
  o.source == 9 ? stand_with_kernel<mps::DensitySource>(o)
                : stand_with_kernel<mps::DivergenceSource>(o);
}

// Every scheme is compiled, so 3D, which the paper does not have, gets what the paper adopts.
void stand_in_3d(const Options& o) {
  if (o.scheme == "recommended") return stand_as_recommended<3>(o);
  if (o.source != 16 || o.kernel != "3c") {
    throw support::Refusal("--dimension 3 is there for --source 16 and --kernel 3c only; for others "
                           "change stand_in_3d() in hydrostatic.cpp");
  }
  stand<3, mps::DivergenceSource, mps::CubicKernel>(o);
}

void check_probes(const Options& o) {
  for (const auto& probe : o.probes) {
    if (probe.back() < still_depth(o)) continue;
    throw support::Refusal("--probe at a height of " + to_text(probe.back()) +
                           " m must lie below the still surface, at " + to_text(still_depth(o)) +
                           " m");
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
      stand_in_2d(options);
    } else {
      support::read_probes(options, {options.width, options.thickness, wall_height(options)},
                           {middle, options.thickness / 2, 0});
      check_probes(options);
      stand_in_3d(options);
    }
  });
}
