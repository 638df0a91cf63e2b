// SPDX-License-Identifier: MIT
// The vibrating floor: smooth spheres in a cell with periodic sides and no lid, agitated by a floor
// that vibrates fast. Collisions dissipate energy, so that the granular temperature is highest at
// the floor and the density some way above it. Computes profiles of fluctuation energy and solid
// fraction over height.
//
// After J.-Y. Sah, J.-W. Choi, "Analysis of Granular Flow Using DEM", Table 1 and Figs 4–8, which
// follow Y. Lan, A.D. Rosato, Physics of Fluids 7, 1818 (1995).
//
//   vibrating_floor --mass-holdup 2.5 --boundary-velocity 2 --out out/vibrating_floor/single
//   examples/plot_vibrating_floor.py out/vibrating_floor/single
//   examples/run --study vibrating_floor         all five runs of the paper, with checks
#include <silt/dem.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/block_sums.hpp>
#include <silt/measure/profiles.hpp>
#include <silt/measure/timed.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double g = 9.81;  // [m/s²]
constexpr double pi = std::numbers::pi;

struct Options {
  int dimension = 3;
  double mass_holdup = 2.5;           // m_t [-]
  double boundary_velocity = 2;       // V_b [-]
  double frequency = 50;              // f [Hz]
  double cell_width = 8;              // L/d [-]
  double diameter = 0.1;              // d [m]
  double density = 1200;              // [kg/m³]
  double loading_stiffness = 2.7e8;   // K_1 [N/m]
  double restitution = 0.9;           // e = e_b [-]
  double steps_per_contact = 50;      // [-]
  double warm_up = 4;                 // [s]
  double until = 24;                  // [s]
  double slice = 0.1;                 // over d [-]
  int samples_per_period = 16;
  double frames_every = 0.5;          // [s]
  int seed = 1;
  int threads = 0;
  std::string out = "out/vibrating_floor";
  support::Resume resume = {};

  double period() const { return 1 / frequency; }
  /// A of y = A sin(2π f t) [m]: the floor's rms velocity A ω/√2 is V_b √(g d).
  double amplitude() const {
    return boundary_velocity * std::sqrt(2 * g * diameter) / (2 * pi * frequency);
  }
  /// Horizontal cross-section of the cell: L² [m²], in 2D L [m].
  double cross_section() const { return std::pow(cell_width * diameter, dimension - 1); }
  /// Volume of a sphere [m³], in 2D area of a disc [m²].
  double grain_volume() const {
    return dimension == 2 ? pi * squared(diameter) / 4 : pi * diameter * squared(diameter) / 6;
  }
  /// N of m_t = N π d²/(6 L²), in 2D N π d/(4 L).
  Index grains() const {
    return static_cast<Index>(
        std::lround(mass_holdup * cross_section() * diameter / grain_volume()));
  }
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    app.add_option(name, value, text)->check(check)->capture_default_str();
  };
  using support::positive, support::not_negative, support::between;
  add("--dimension", o.dimension, "2: discs, for qualitative trends; 3: spheres", between({2, 3}));
  add("--mass-holdup", o.mass_holdup, "m_t [-], volume of the grains over that of a layer one "
      "diameter high; 1, 2.5 and 5 in the paper", positive());
  add("--boundary-velocity", o.boundary_velocity, "V_b [-], rms velocity of the floor over "
      "sqrt(g d); 0.25, 2 and 5 in the paper (2 is 90 g at 50 Hz)", positive());
  add("--frequency", o.frequency, "frequency of the floor [Hz]; its period is short compared with "
      "the flights of the grains, so that only V_b matters", positive());
  add("--cell-width", o.cell_width, "width of the square cell in diameters [-]; doubling the "
      "default changes nothing", between({3, 1000}));
  add("--diameter", o.diameter, "diameter of a grain [m]", positive());
  add("--density", o.density, "density of a grain [kg/m3]", positive());
  add("--loading-stiffness", o.loading_stiffness, "K_1 [N/m]; the unloading stiffness is K_1/e2",
      positive());
  add("--restitution", o.restitution, "coefficient of restitution e between grains, and between "
      "grains and floor [-]", between({0.05, 1}));
  add("--steps-per-contact", o.steps_per_contact, "minimum number of time steps in the shortest "
      "contact [-]", between({10, 1000}));
  add("--warm-up", o.warm_up, "time before averaging begins [s]; a flight of a grain lasts about "
      "half a second", not_negative());
  add("--until", o.until, "end of the run [s]", positive());
  add("--slice", o.slice, "height of a slice of the profiles in diameters [-]",
      between({0.01, 2}));
  add("--samples-per-period", o.samples_per_period, "samples for the averages per period of the "
      "floor", between({1, 1000}));
  add("--frames-every", o.frames_every, "time between frames [s]", positive());
  add("--seed", o.seed, "seed of the initial velocities", between({0, 1e9}));
  add("--threads", o.threads, support::threads_help, between({0, 1024}));
  app.add_option("--out", o.out, "folder for profile.csv, summary.json and frames.pvd")
      ->capture_default_str();
  support::describe_resume(app, o.resume);
}

void check_combination(const Options& o) {
  if (o.until < o.warm_up + 20 * o.period()) {
    throw support::OptionError("--until " + to_text(o.until) +
                               " leaves less than 20 periods of the floor after the warm-up; use "
                               "at least " + to_text(o.warm_up + 20 * o.period()));
  }
  if (o.grains() < 2 || o.grains() > 1000000) {
    throw support::OptionError("--mass-holdup " + to_text(o.mass_holdup) + " gives " +
                               std::to_string(o.grains()) +
                               " grains; change it or --cell-width so that there are 2 to 1e6");
  }
}

// Layers in a square lattice above the floor, with random velocities of zero mean.
template <int Dim>
dem::Grains<Dim> make_bed(const Options& o) {
  constexpr int up = Dim - 1;
  const double d = o.diameter;
  const double width = o.cell_width * d;
  Box<Dim> box;
  for (int k = 0; k < up; ++k) {
    box.lower[k] = 0;
    box.upper[k] = width;
    box.periodic[Index(k)] = true;
  }
  const double spacing = width / std::floor(o.cell_width / 1.05);
  Box<Dim> filled{.lower = box.lower, .upper = box.upper};
  filled.lower[up] = o.amplitude() + (d - spacing) / 2 + 0.1 * d;
  const auto per_layer = std::pow(std::round(width / spacing), up);
  filled.upper[up] = filled.lower[up] + spacing * std::ceil(double(o.grains()) / per_layer);
  auto points = lattice<Dim>(filled, spacing);
  points.resize(o.grains());
  dem::Grains<Dim> grains(box);
  for (const auto& x : points) {
    dem::add_grain(grains, x, {.radius = d / 2, .density = o.density, .shape = dem::Shape::sphere});
  }
  const double speed = o.boundary_velocity * std::sqrt(g * d) / 2;
  Vec<Dim> mean = Vec<Dim>::Zero();
  for (Index i = 0; i < grains.size(); ++i) {
    Random random{.seed = static_cast<std::uint64_t>(o.seed), .id = grains.id(i)};
    for (int k = 0; k < Dim; ++k) grains[velocity][i][k] = speed * random.normal();
    mean += grains[velocity][i] / double(grains.size());
  }
  for (auto& v : grains[velocity]) v -= mean;
  return grains;
}

// Observer that averages quantities of the whole bed.
template <int Dim>
class BedSums {
 public:
  template <class Sim>
  void after_step(const Sim& simulation, const Run&) {
    impulse_ += floor_force(simulation) * simulation.last_time_step();
    time_ += simulation.last_time_step();
  }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (!(time_ > 0)) return;  // the beginning of the run
    const auto grains = simulation.snapshot();
    const double n = double(grains.size());
    std::array<double, numbers> sample{};
    for (Index i = 0; i < grains.size(); ++i) {
      sample[height] += grains[position][i][Dim - 1] / n;
      for (int k = 0; k < Dim; ++k) {
        const double v = grains[velocity][i][k];
        sample[flow + Index(k)] += v / n;
        sample[square + Index(k)] += v * v / n;
      }
    }
    sample[load] = impulse_ / time_ / (n * grains[mass][0] * g);
    sums_.add(sample);
    impulse_ = time_ = 0;
  }
  template <class Archive>
  void transfer(Archive& archive) {
    sums_.transfer(archive);
    archive("impulse", impulse_);
    archive("time", time_);
  }

  /// <v'²>/Dim of all grains [m²/s²], v' = v − <v>.
  Estimate temperature() const {
    return sums_.estimate([](std::span<const double> means) {
      double sum = 0;
      for (Index k = 0; k < Dim; ++k) sum += means[square + k] - squared(means[flow + k]);
      return sum / Dim;
    });
  }
  Estimate centre_of_mass() const { return sums_.mean(height); }  ///< [m]
  Estimate floor_force_over_weight() const { return sums_.mean(load); }
  Index samples() const { return sums_.samples(); }

 private:
  static constexpr Index load = 0;
  static constexpr Index height = 1;
  static constexpr Index flow = 2;
  static constexpr Index square = flow + Dim;
  static constexpr Index numbers = square + Dim;

  template <class Sim>
  static double floor_force(const Sim& simulation) {
    const auto& contacts = simulation.interaction().template part<1>();
    return -contacts.load_on(simulation.particles(), 0).force[Dim - 1];
  }

  BlockSums sums_{numbers};
  double impulse_ = 0;  // on the floor since the last sample [N s]
  double time_ = 0;     // since the last sample [s]
};

// Maximum of the solid fraction, smoothed over one diameter to remove noise and layering, and
// interpolated between slices by a parabola.
struct Peak {
  double solid_fraction = 0;  // [-]
  double slice = 0;           // position, in slices from the middle of the lowest [-]

  Peak(std::span<const double> fractions, Index slices_per_diameter) {
    std::vector<double> smooth;
    double sum = 0;
    for (Index s = 0; s < fractions.size(); ++s) {
      sum += fractions[s];
      if (s >= slices_per_diameter) sum -= fractions[s - slices_per_diameter];
      if (s + 1 >= slices_per_diameter) smooth.push_back(sum / double(slices_per_diameter));
    }
    const auto top = std::max_element(smooth.begin(), smooth.end());
    solid_fraction = *top;
    slice = double(top - smooth.begin()) + (double(slices_per_diameter) - 1) / 2;
    if (top == smooth.begin() || top + 1 == smooth.end()) return;
    const double curvature = top[-1] - 2 * top[0] + top[1];
    if (curvature < 0) slice += (top[-1] - top[1]) / (2 * curvature);
  }
};

// Observer that records the maximum height of a grain.
template <int Dim>
struct MaxHeight {
  double height = 0;  // [m]

  template <class Sim>
  void operator()(const Sim& simulation) {
    for (const auto& x : simulation.particles()[position]) height = std::max(height, x[Dim - 1]);
  }
};

// The averages, which begin after the warm-up. The height reached by the bed until then determines
// the slices.
template <int Dim>
struct Averages {
  Options options;
  MaxHeight<Dim> max_height = {};
  BedSums<Dim> sums = {};
  std::optional<Profiles<Dim>> profiles = {};

  Index slices_below() const {
    return static_cast<Index>(std::ceil(options.amplitude() / options.diameter / options.slice));
  }
  void begin() {
    const auto above = static_cast<Index>(
        std::ceil((2 * max_height.height / options.diameter + 10) / options.slice));
    const double slice = options.slice * options.diameter;
    profiles.emplace(Slices{.lower = -double(slices_below()) * slice,
                            .upper = double(above) * slice,
                            .count = slices_below() + above,
                            .cross_section = options.cross_section()});
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("highest", max_height.height);
    bool have_begun = profiles.has_value();
    archive("have_begun", have_begun);
    if (!have_begun) return;
    if constexpr (Archive::reads) begin();
    sums.transfer(archive);
    profiles->transfer(archive);
  }
};

// Observer that writes a frame every so many samples.
struct Frames {
  VtkSeries series;
  Index samples_per_frame;
  Index sample = 0;

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (sample++ % samples_per_frame == 0) series(simulation);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    series.transfer(archive);
    archive("sample", sample);
  }
};

template <int Dim>
void write_profile(const Options& o, const std::vector<ProfileRow<Dim>>& rows) {
  const std::vector<std::string> columns{"y_over_d", "solid_fraction", "temperature_over_gd",
                                         "temperature_vertical", "temperature_horizontal"};
  CsvFile values(o.out + "/profile.csv", columns);
  CsvFile errors(o.out + "/profile_errors.csv", columns);
  const double gd = g * o.diameter;
  for (const auto& row : rows) {
    if (!(row.solid_fraction.value > 0)) continue;
    // The horizontal axes are equivalent: their mean is more precise.
    const Estimate& horizontal = row.component[0];
    const Estimate& other = row.component[Dim - 2];
    const double y = row.height / o.diameter;
    values.row({y, row.solid_fraction.value, row.temperature.value / gd,
                row.component[Dim - 1].value / gd,
                (horizontal.value + other.value) / 2 / gd});
    errors.row({y, row.solid_fraction.standard_error, row.temperature.standard_error / gd,
                row.component[Dim - 1].standard_error / gd,
                std::hypot(horizontal.standard_error, other.standard_error) / 2 / gd});
  }
}

nlohmann::ordered_json options_of(const Options& o) {
  return {{"dimension", o.dimension},
          {"mass_holdup", o.mass_holdup},
          {"boundary_velocity", o.boundary_velocity},
          {"frequency", o.frequency},
          {"cell_width", o.cell_width},
          {"diameter", o.diameter},
          {"density", o.density},
          {"loading_stiffness", o.loading_stiffness},
          {"restitution", o.restitution},
          {"steps_per_contact", o.steps_per_contact},
          {"warm_up", o.warm_up},
          {"until", o.until},
          {"slice", o.slice},
          {"samples_per_period", o.samples_per_period},
          {"frames_every", o.frames_every},
          {"seed", o.seed},
          {"threads", o.threads}};
}

template <int Dim>
void vibrate(const Options& o) {
  auto grains = make_bed<Dim>(o);
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);
  const double actual_holdup =
      double(grains.size()) * o.grain_volume() / (o.cross_section() * o.diameter);

  const dem::Law law{dem::WaltonBraun{.loading_stiffness = o.loading_stiffness,
                                      .restitution = o.restitution}};
  const Vec<Dim> up = Vec<Dim>::Unit(Dim - 1);
  const dem::Moving floor{dem::Plane<Dim>{.normal = up},
                          dem::Vibration<Dim>{.amplitude = o.amplitude() * up,
                                              .frequency = o.frequency}};
  const auto contacts = dem::Contacts{law, floor}.with({.steps_per_contact = o.steps_per_contact});
  Simulation bed{std::move(grains), NeighbourList<Dim>{}, Forces{Gravity<Dim>{-g * up}, contacts},
                 Leapfrog{}};
  const double sample_every = o.period() / o.samples_per_period;
  const double dt = sample_every / std::ceil(sample_every / bed.time_step());
  if (o.until / dt > 1e10) {
    throw support::OptionError("--until " + to_text(o.until) + " takes " + to_text(o.until / dt) +
                               " steps with these grains; reduce it, or --loading-stiffness");
  }

  Frames frames{VtkSeries{o.out + "/frames"},
                std::max<Index>(1, static_cast<Index>(std::lround(o.frames_every / sample_every)))};
  Averages<Dim> averages{o};
  support::ResumableRun run(o.resume, o.out + "/checkpoint.silt", bed, averages, frames);
  Progress progress;
  Stopwatch wall;
  const auto run_until = [&](double until, auto&... observers) {
    const auto span = wall.start();
    run.run({.until = until, .output_every = sample_every, .time_step = dt}, observers...,
            progress);
  };
  if (!averages.profiles) {
    run_until(o.warm_up, averages.max_height);
    averages.begin();
  }
  auto& sums = averages.sums;
  auto& profiles = *averages.profiles;
  run_until(o.until, sums, profiles, frames);

  const auto rows = profiles.rows();
  write_profile(o, rows);
  double profile_holdup = 0;
  for (const auto& row : rows) profile_holdup += row.solid_fraction.value * o.slice;
  const auto per_diameter = std::max<Index>(1, static_cast<Index>(std::lround(1 / o.slice)));
  const Estimate densest = profiles.of_solid_fractions(
      [&](auto fractions) { return Peak(fractions, per_diameter).solid_fraction; });
  const Estimate densest_at = profiles.of_solid_fractions([&](auto fractions) {
    return (Peak(fractions, per_diameter).slice + 0.5 - double(averages.slices_below())) * o.slice;
  });

  const double gd = g * o.diameter;
  nlohmann::ordered_json summary;
  nlohmann::ordered_json errors;
  const auto add = [&](const std::string& name, const Estimate& estimate, double unit) {
    summary[name] = estimate.value / unit;
    errors[name] = estimate.standard_error / unit;
  };
  add("mean_temperature_over_gd", sums.temperature(), gd);
  add("centre_of_mass_over_d", sums.centre_of_mass(), o.diameter);
  add("solid_fraction_max", densest, 1);
  add("solid_fraction_peak_over_d", densest_at, 1);
  add("floor_force_over_weight", sums.floor_force_over_weight(), 1);
  summary["standard_errors"] = errors;
  summary["grains"] = bed.particles().size();
  summary["mass_holdup"] = actual_holdup;
  summary["mass_holdup_of_profile"] = profile_holdup;
  summary["samples"] = sums.samples();
  summary["amplitude_over_d"] = o.amplitude() / o.diameter;
  summary["time_step"] = dt;
  summary["steps"] = bed.steps();
  summary["wall_seconds"] = wall.seconds();
  summary["options"] = options_of(o);
  support::complete(o.resume, o.out, summary);
  std::printf("vibrating_floor: %zu grains, "
              "%llu steps in %.1f s of wall-clock time, T = %.4f g d; results in %s\n",
              bed.particles().size(), static_cast<unsigned long long>(bed.steps()),
              wall.seconds(), sums.temperature().value / gd, o.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("A bed of smooth grains on a vibrating floor", "vibrating_floor");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&options] {
    check_combination(options);
    options.dimension == 2 ? vibrate<2>(options) : vibrate<3>(options);
  });
}
