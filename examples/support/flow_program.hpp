// SPDX-License-Identifier: MIT
// Shared by the MPS examples: common options, pressure gauges, and the common part of the summary.
#pragma once

#include <silt/geometry/face.hpp>
#include <silt/io/csv.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/timed.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "findings.hpp"
#include "resume.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace support {

inline constexpr double g = 9.81;  // [m/s²]

struct FlowOptions {
  double spacing = 0.01;  // [m]
  int dimension = 2;
  double until = 1;                          // [s]
  std::vector<std::string> probe_texts = {};
  std::vector<std::vector<double>> probes = {};  // the same as numbers [m]
  double radius = 3.1;                       // [spacings]
  double laplacian_radius = 3.1;             // [spacings]
  double courant = 0.2;
  double max_time_step = std::numeric_limits<double>::infinity();  // [s]
  double tolerance = 1e-6;
  double output_every = 0.02;  // [s]
  int threads = 0;
  std::string out = {};
  Resume resume = {};
};

/// Adds an option with a check; the help shows its default.
template <class Value>
CLI::Option* add_option(CLI::App& app, const std::string& name, Value& value,
                        const std::string& text, const CLI::Validator& check) {
  return app.add_option(name, value, text)->check(check)->capture_default_str();
}

/// Adds the common options but those of pressure gauges. `files` describes the content of --out.
inline void describe_numerics(CLI::App& app, FlowOptions& o, const std::string& files) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return add_option(app, name, value, text, check);
  };
  add("--spacing", o.spacing, "particle spacing [m]", positive());
  add("--dimension", o.dimension, "2 or 3", between({2, 3}));
  add("--until", o.until, "end of the run [s]", positive());
  add("--radius", o.radius,
      "effective radius of number density, surface, gradient and divergence [spacings]",
      between({1.5, 6}));
  add("--laplacian-radius", o.laplacian_radius, "effective radius of the Laplacian [spacings]",
      between({1.5, 6}));
  add("--courant", o.courant, "Courant number: displacement of the fastest particle per step "
      "[spacings]", between({1e-3, 0.5}));
  app.add_option("--max-time-step", o.max_time_step, "upper limit of the time step [s]; default "
                 "none")
      ->check(positive());
  add("--tolerance", o.tolerance, "of the pressure solver: norm of the residual over that of the "
      "right-hand side", between({1e-12, 1e-1}));
  add("--output-every", o.output_every, "time between frames [s]", positive());
  add("--threads", o.threads, support::threads_help, between({0, 1024}));
  app.add_option("--out", o.out, "folder for " + files)->capture_default_str();
  describe_resume(app, o.resume);
}

/// Adds the common options. `gauge` describes the default of --probe, `files` the content of --out.
inline void describe_flow(CLI::App& app, FlowOptions& o, const std::string& gauge,
                          const std::string& files) {
  app.add_option("--probe", o.probe_texts, "X,Y or in 3D X,Y,Z of a pressure gauge [m]; may be "
                 "repeated; default " + gauge);
  describe_numerics(app, o, files);
}

/// Converts every --probe to numbers. Gauges must lie in the tank or on its walls: within
/// [0, upper]. The default is one gauge at `default_point`.
inline void read_probes(FlowOptions& o, const std::vector<double>& upper,
                        const std::vector<double>& default_point) {
  for (const std::string& text : o.probe_texts) {
    std::vector<double> point;
    for (const std::string& part : CLI::detail::split(text, ',')) {
      double value = 0;
      if (!CLI::detail::lexical_cast(part, value) || !silt::is_finite(value)) {
        throw OptionError("--probe " + text + ": " + part + " is not a finite number");
      }
      point.push_back(value);
    }
    if (point.size() != upper.size()) {
      throw OptionError("--probe " + text + " has " + std::to_string(point.size()) +
                        " coordinates, but needs " + std::to_string(upper.size()));
    }
    for (std::size_t k = 0; k < point.size(); ++k) {
      if (!(point[k] >= 0 && point[k] <= upper[k])) {
        throw OptionError("--probe " + text + " must lie in the tank or on its walls");
      }
    }
    o.probes.push_back(point);
  }
  if (o.probes.empty()) o.probes.push_back(default_point);
}

/// Number of layers of dummy particles within the effective radii.
inline int dummy_layers(const FlowOptions& o) {
  return static_cast<int>(std::ceil(std::max(o.radius, o.laplacian_radius)));
}

/// Settings of a flow with the initial depth `depth` [m].
template <class Scheme, int Dim>
silt::mps::FlowSettings<Dim, Scheme> flow_settings(const FlowOptions& o, double depth) {
  return {.spacing = o.spacing,
          .radius = o.radius,
          .laplacian_radius = o.laplacian_radius,
          .courant = o.courant,
          .speed_scale = std::sqrt(g * depth),
          .max_time_step = o.max_time_step};
}

/// Observer that writes the readings of the gauges to pressure.csv, at every step.
template <int Dim>
class PressureGauges {
 public:
  explicit PressureGauges(const FlowOptions& o)
      : file_(o.out + "/pressure.csv", names(o.probes.size())) {
    for (const auto& point : o.probes) {
      probes_.push_back({.point = Eigen::Map<const silt::Vec<Dim>>(point.data()),
                         .spacing = o.spacing});
    }
  }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) read(simulation);
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    read(simulation);
  }

  template <class Archive>
  void transfer(Archive& archive) {
    file_.transfer(archive);
  }

  /// Reading of the first gauge after the last step [Pa].
  double first() const { return row_[1]; }

 private:
  static std::vector<std::string> names(std::size_t probes) {
    std::vector<std::string> names{"t"};
    for (std::size_t k = 1; k <= probes; ++k) names.push_back("p_" + std::to_string(k));
    return names;
  }

  template <class Sim>
  void read(const Sim& simulation) {
    const auto& particles = simulation.particles();
    const auto kinds = particles[silt::mps::kind];
    const auto is = [&](silt::mps::Kind wanted) {
      return [&kinds, wanted](silt::Index i) { return kinds[i] == wanted; };
    };
    row_.assign(1, simulation.time());
    for (const silt::Probe<Dim>& probe : probes_) {
      if constexpr (requires { simulation.interaction().settings().walls.template faces<Dim>(); }) {
        if (const auto pressure = read_at_face(simulation, probe)) {
          row_.push_back(*pressure);
          continue;
        }
      }
      // A gauge on a wall reads the wall particles; one away from walls reads the fluid.
      const auto of_wall = probe.read(particles, silt::mps::pressure, is(silt::mps::Kind::wall));
      const auto of_fluid = probe.read(particles, silt::mps::pressure, is(silt::mps::Kind::fluid));
      row_.push_back(of_wall ? *of_wall : of_fluid.value_or(0));
    }
    file_.row(row_);
  }

  // The pressure at a face, on the side on which fluid is; nothing away from faces.
  template <class Sim>
  static std::optional<double> read_at_face(const Sim& simulation, const silt::Probe<Dim>& probe) {
    const auto& faces = simulation.interaction().settings().walls.template faces<Dim>();
    const auto is_near = [&](const silt::Face<Dim>& face) {
      return (silt::nearest_of(face, probe.point) - probe.point).norm() < 1e-3 * probe.spacing;
    };
    const auto face = std::ranges::find_if(faces, is_near);
    if (face == faces.end()) return {};
    const silt::Vec<Dim> normal = silt::normal_of(*face);
    const auto on_side = [&](double side) {
      return silt::WallGauge<Dim>{probe.point, side * normal, probe.spacing}.read(
          simulation.particles(), silt::mps::pressure);
    };
    return std::max(on_side(1), on_side(-1));
  }

  silt::CsvFile file_;
  std::vector<silt::Probe<Dim>> probes_;
  std::vector<double> row_;
};

/// Observer that writes the energies and their changes to energy.csv, at every step.
class EnergyFile {
 public:
  explicit EnergyFile(const FlowOptions& o)
      : file_(o.out + "/energy.csv",
              {"t", "kinetic", "potential", "total", "by_viscosity", "by_force", "by_friction",
               "by_collision", "by_pressure", "by_shifting", "by_integration", "added"}) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() > 0) return;
    write(simulation.time(), simulation.interaction().energy_of(simulation.particles()));
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    write(simulation.time(), simulation.interaction().energy());
  }
  template <class Archive>
  void transfer(Archive& archive) {
    file_.transfer(archive);
  }

 private:
  void write(double time, const silt::mps::FlowEnergy& energy) {
    file_.row({time, energy.kinetic, energy.potential, energy.total(), energy.by_viscosity,
               energy.by_force, energy.by_friction, energy.by_collision, energy.by_pressure,
               energy.by_shifting, energy.by_integration, energy.added});
  }

  silt::CsvFile file_;
};

/// Observer that counts the iterations of the pressure solver.
class SolverIterations {
 public:
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    const int iterations = simulation.interaction().last_solve().iterations;
    sum_ += iterations;
    max_ = std::max(max_, iterations);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    archive("sum", sum_);
    archive("max", max_);
  }

  double sum() const { return sum_; }  // over all steps
  int max() const { return max_; }

 private:
  double sum_ = 0;
  int max_ = 0;
};

/// Size and cost of a run, for summary.json. `particles` are the initial ones.
template <class P, class Sim>
nlohmann::ordered_json summary_of(const Sim& simulation, const P& particles,
                                  const SolverIterations& iterations, double seconds) {
  const auto steps = double(std::max<std::uint64_t>(simulation.steps(), 1));
  return {{"steps", simulation.steps()},
          {"wall_seconds", seconds},
          {"fluid_particles", count(particles, silt::mps::Kind::fluid)},
          {"wall_particles", count(particles, silt::mps::Kind::wall)},
          {"dummy_particles", count(particles, silt::mps::Kind::dummy)},
          {"time_simulated", simulation.time()},
          {"solver_iterations_mean", iterations.sum() / steps},
          {"solver_iterations_max", iterations.max()},
          {"seconds_search", simulation.search().seconds()},
          {"seconds_pressure", simulation.interaction().seconds_in_pressure()},
          {"seconds_total", seconds},
          {"particles_lost", simulation.particles_lost()}};
}

/// The findings for summary.json, which are also printed. Numbers that are not finite are null.
inline nlohmann::ordered_json report(const std::vector<Finding>& findings) {
  auto all = nlohmann::ordered_json::array();
  for (const Finding& finding : findings) {
    all.push_back({{"quantity", finding.quantity},
                   {"reference", finding.reference},
                   {"measured", finding.measured},
                   {"error", finding.error()},
                   {"allowed", finding.allowed},  // null if there is no limit
                   {"holds", finding.holds()}});
    const char* const verdict = finding.allowed == stated ? "stated"
                                : finding.holds()         ? "holds"
                                                          : "does not hold";
    std::printf("%-50s reference %-10.5g measured %-10.5g %s\n", finding.quantity.c_str(),
                finding.reference, finding.measured, verdict);
  }
  return all;
}

/// Adds the common options, for summary.json.
inline void add_flow_options(nlohmann::ordered_json& options, const FlowOptions& o) {
  options["spacing"] = o.spacing;
  options["dimension"] = o.dimension;
  options["until"] = o.until;
  options["probes"] = o.probes;
  options["radius"] = o.radius;
  options["laplacian_radius"] = o.laplacian_radius;
  options["courant"] = o.courant;
  // JSON has no infinity: null if there is no limit.
  options["max_time_step"] = o.max_time_step;
  options["tolerance"] = o.tolerance;
  options["output_every"] = o.output_every;
  options["threads"] = o.threads;
}

}  // namespace support
