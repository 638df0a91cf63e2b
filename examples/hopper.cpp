// SPDX-License-Identifier: MIT
// Discharge of a hopper: polydisperse grains are filled into a bin, settle, and flow out through
// openings of several widths D. The mass flow rate follows the law of W.A. Beverloo, H.A. Leniger,
// J. van de Velde, "The flow of granular solids through orifices", Chemical Engineering Science 15
// (1961) 260–269,
//
//   W = C ρ_b √g (D − k d)^n,   n = 5/2 for spheres and a round hole, 3/2 for discs and a slot
//
// with the bulk density ρ_b and the mean diameter d; it does not depend on the fill height.
//
//   hopper --out out/hopper                        spheres in a round bin, walls from STL files
//   hopper --dimension 2 --out out/hopper_2d       discs and a slot
//   examples/plot_hopper.py out/hopper
#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/dem/setup/settling.hpp>
#include <silt/dem/wall/mesh/mesh_wall.hpp>
#include <silt/dem/wall/polyline.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/stl.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/timed.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double g = 9.81;   // [m/s²]
constexpr double k = 1.4;    // in Beverloo's law [-]
constexpr int corners = 48;  // of the polygon that approximates a circle

struct Options {
  int dimension = 3;
  std::vector<double> openings;   // D/d [-]
  double diameter = 0.01;         // d, mean [m]
  double spread = 0.2;            // of the radii [-]
  double density = 2500;          // [kg/m³]
  double width = 0;               // of the bin, over d [-]
  double fill_height = 0;         // over d [-]
  double half_angle = 90;         // of the hopper [degrees]
  double stiffness = 5000;        // k_n over the weight of a grain and d [-]
  double friction_angle = 26.6;   // [degrees]
  double restitution = 0.5;       // [-]
  double share = 0.45;            // of the grains that is discharged [-]
  double longest = 0;             // maximum duration of a discharge, over √(d/g) [-]
  std::uint64_t seed = 1;
  int threads = 0;
  std::string stl;
  std::string out = "out/hopper";
  support::Resume resume = {};

  double unit_of_time() const { return std::sqrt(diameter / g); }
  double speed() const { return std::sqrt(diameter * g); }
  double exponent() const { return dimension - 0.5; }
  double bin() const { return width * diameter; }
  double bed() const { return fill_height * diameter; }
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return app.add_option(name, value, text)->check(check)->capture_default_str();
  };
  using support::positive, support::not_negative, support::between;
  add("--dimension", o.dimension, "2: discs and a slot; 3: spheres and a round hole",
      between({2, 3}));
  app.add_option("--openings", o.openings, "widths D of the opening over the mean diameter d; "
                 "default 6,7,8 in 3D and 8,10,12.5,16,20 in 2D")
      ->check(positive())
      ->delimiter(',');
  add("--diameter", o.diameter, "mean diameter d of the grains [m]", positive());
  add("--spread", o.spread, "radii are uniformly distributed within 1 ± spread of the mean; equal "
      "discs would crystallise", between({0, 0.9}));
  add("--density", o.density, "density of the grains [kg/m3]", positive());
  add("--width", o.width, "width of the bin over d; 0: 2.5 times the largest opening, so that the "
      "side walls have no effect", not_negative());
  add("--fill-height", o.fill_height, "fill height over d; 0: the width of the bin, in 2D 1.6 "
      "times the width", not_negative());
  add("--half-angle", o.half_angle, "angle between the axis and the side of the hopper [degrees]; "
      "90: a flat floor, as in Beverloo's law", between({10, 90}));
  add("--stiffness", o.stiffness, "stiffness of a contact over weight/diameter of a grain; by "
      "default the overlap at the bottom is less than a hundredth of d", positive());
  add("--friction-angle", o.friction_angle, "friction angle of grains and walls [degrees]",
      between({0, 80}));
  add("--restitution", o.restitution, "coefficient of restitution", between({0.01, 1}));
  add("--share", o.share, "fraction of the grains that is discharged through each opening",
      between({0.01, 0.9}));
  add("--longest", o.longest, "maximum duration of the discharge through one opening, over "
      "sqrt(d/g); 0: 20 in 3D, 40 in 2D", not_negative());
  add("--seed", o.seed, "seed of the random numbers", not_negative());
  add("--threads", o.threads, support::threads_help, between({0, 1024}));
  app.add_option("--stl", o.stl, "3D: STL file [m] of a user-defined hopper about the z axis, with "
                 "its opening in the plane z = 0; --width and --openings must be its dimensions");
  app.add_option("--out", o.out, "folder for discharge.csv, summary.json, frames.pvd and the walls")
      ->capture_default_str();
  support::describe_resume(app, o.resume);
}

void complete(Options& o) {
  if (o.openings.empty() && !o.stl.empty()) {
    throw support::OptionError("--stl " + o.stl +
                               " needs --openings with the width of its opening");
  }
  if (!o.stl.empty() && (o.dimension == 2 || o.openings.size() > 1 || o.width == 0)) {
    throw support::OptionError("--stl " + o.stl +
                               " needs --dimension 3, --width and a single value of --openings");
  }
  if (o.openings.empty()) {
    o.openings = o.dimension == 3 ? std::vector{6.0, 7.0, 8.0}
                                  : std::vector{8.0, 10.0, 12.5, 16.0, 20.0};
  }
  const double largest = *std::max_element(o.openings.begin(), o.openings.end());
  const double smallest = *std::min_element(o.openings.begin(), o.openings.end());
  if (smallest < 3) {
    throw support::OptionError("--openings " + to_text(smallest) +
                               " is below 3 diameters, where grains block it");
  }
  if (o.width == 0) o.width = 2.5 * largest;
  if (o.width < largest) {
    throw support::OptionError("--width " + to_text(o.width) + " is less than the largest opening");
  }
  if (o.fill_height == 0) o.fill_height = (o.dimension == 3 ? 1 : 1.6) * o.width;
  const std::pair<const char*, double> lengths[] = {
      {"--openings", largest}, {"--width", o.width}, {"--fill-height", o.fill_height}};
  for (const auto& [name, length] : lengths) {
    if (length <= 1e4) continue;
    throw support::OptionError(std::string(name) + " " + to_text(length) +
                               " is above 1e4 diameters, more than can be simulated");
  }
  if (o.longest == 0) o.longest = o.dimension == 3 ? 20 : 40;
}

// --- walls, for the opening D [m]; closed: with a lid on the opening -----------------------------

double height_of_hopper(const Options& o, double D) {
  if (o.half_angle == 90) return 0;
  return (o.bin() - D) / 2 / std::tan(o.half_angle * std::numbers::pi / 180);
}
double top_of_bed(const Options& o, double D) { return height_of_hopper(o, D) + o.bed(); }
double top_of_bin(const Options& o, double D) { return top_of_bed(o, D) + 12 * o.diameter; }

using Triangles = std::vector<Triangle<double>>;

// A band of a surface of revolution between two rings, each given by radius and height.
void add_band(Triangles& mesh, const Vec<2>& low, const Vec<2>& high) {
  const auto point = [](const Vec<2>& ring, int corner) {
    const double angle = 2 * std::numbers::pi * (corner % corners) / corners;
    return Vec<3>(ring[0] * std::cos(angle), ring[0] * std::sin(angle), ring[1]);
  };
  for (int c = 0; c < corners; ++c) {
    const Vec<3> a = point(low, c), b = point(low, c + 1);
    const Vec<3> e = point(high, c), f = point(high, c + 1);
    if (low[0] > 0) mesh.push_back({{a, b, e}});
    mesh.push_back({{low[0] > 0 ? b : a, f, e}});
  }
}

Triangles bin_of_triangles(const Options& o, double D, bool closed) {
  Triangles mesh;
  const double corner = height_of_hopper(o, D);
  if (closed) add_band(mesh, {0, 0}, {D / 2, 0});
  add_band(mesh, {D / 2, 0}, {o.bin() / 2, corner});
  add_band(mesh, {o.bin() / 2, corner}, {o.bin() / 2, top_of_bin(o, D)});
  return mesh;
}

dem::CundallStrack law_of(const Options& o) {
  const double R = o.diameter / 2;
  const double weight = o.density * dem::volume_of<3>(R) * g;
  const double disc_weight = o.density * dem::volume_of<2>(R) * g;
  const double stiffness = o.stiffness * (o.dimension == 3 ? weight : disc_weight) / o.diameter;
  return {.normal_stiffness = stiffness,
          .tangential_stiffness = stiffness * 2 / 7,
          .restitution = o.restitution,
          .friction_angle = o.friction_angle * std::numbers::pi / 180};
}

template <int Dim>
auto contacts_of(const Options& o, double D, bool closed) {
  const auto coarse = [](auto contacts) { return contacts.with({.steps_per_contact = 20}); };
  if constexpr (Dim == 2) {
    const double half = o.bin() / 2, corner = height_of_hopper(o, D), top = top_of_bin(o, D);
    const dem::Polyline<> left{{{-half, top}, {-half, corner}, {-D / 2, 0}}};
    const dem::Polyline<> right{{{half, top}, {half, corner}, {D / 2, 0}}};
    // If the opening is not closed, the lid is far away.
    const double below = closed ? 0 : -1e3 * o.diameter;
    const dem::Polyline<> lid{{{-D / 2, below}, {D / 2, below}}};
    return coarse(dem::Contacts{law_of(o), left, right, lid});
  } else {
    // The walls are read back from the STL files that are written.
    const std::string name =
        closed ? "/closed.stl" : "/opening_" + to_text(D / o.diameter) + ".stl";
    Triangles mesh;
    if (o.stl.empty()) {
      mesh = bin_of_triangles(o, D, closed);
    } else {
      mesh = read_stl(o.stl);
      if (closed) add_band(mesh, {0, -1e-9}, {D / 2 + o.diameter, -1e-9});
    }
    write_stl(o.out + name, mesh);
    return coarse(dem::Contacts{law_of(o), dem::MeshWall<>{read_stl(o.out + name)}});
  }
}

template <int Dim>
auto make_simulation(const Options& o, dem::Grains<Dim> grains, double D, bool closed) {
  return Simulation{std::move(grains), NeighbourList<Dim>{},
                    Forces{Gravity<Dim>{-g * Vec<Dim>::Unit(Dim - 1)},
                           contacts_of<Dim>(o, D, closed)},
                    Leapfrog{}};
}

template <int Dim>
auto region_above(const Options& o, double D) {
  const double low = top_of_bed(o, D), high = top_of_bin(o, D);
  if constexpr (Dim == 2) {
    return Box<2>{.lower = {-o.bin() / 2, low}, .upper = {o.bin() / 2, high}};
  } else {
    // The circle inscribed in the polygon of the mesh.
    const double inscribed = o.bin() / 2 * std::cos(std::numbers::pi / corners);
    return dem::VerticalCylinder<>{.base = {0, 0, low}, .radius = inscribed, .height = high - low};
  }
}

template <int Dim>
double cross_section(const Options& o) {
  return Dim == 2 ? o.bin() : std::numbers::pi / 4 * o.bin() * o.bin();
}

// --- stages: filling and discharge for each opening, each with its own checkpoint file -----------

std::string checkpoint_of(const Options& o, int stage) {
  return o.out + "/checkpoint_" + std::to_string(stage) + ".silt";
}
// The stage at which the run resumes.
int first_stage(const Options& o) {
  int stage = o.resume.is_requested() ? 2 * static_cast<int>(o.openings.size()) - 1 : 0;
  while (stage > 0 && !std::filesystem::exists(checkpoint_of(o, stage))) --stage;
  return stage;
}

// A stage consists of consecutive short runs. A resumed stage continues the run in which it was
// stopped.
struct Slices {
  double until = 0;  // end of the last run [s]
  bool is_open = false;

  template <class Run, class Sim, class... Observers>
  void run_for(double duration, double output_every, Run& run, const Sim& simulation,
               Observers&... observers) {
    if (!is_open) until = simulation.time() + duration;
    is_open = true;
    run.run({.until = until, .output_every = output_every}, observers...);
    is_open = false;
  }
  template <class Archive>
  void transfer(Archive& archive) {
    archive("until", until);
    archive("is_open", is_open);
  }
};

struct Discharge {
  double opening = 0;          // D/d
  std::vector<double> times;   // [s]
  std::vector<double> masses;  // that have passed the opening [kg]
  double rate = 0;             // [kg/s]
  double rate_of_halves[2]{};  // in the first and second half of the discharge [kg/s]
  double height_of_halves[2]{};  // fill height meanwhile, over D [-]
  std::uint64_t steps = 0;
  double wall_seconds = 0;
  double solid_fraction = 0;

  template <class Archive>
  void transfer(Archive& archive) {
    archive("opening", opening);
    archive("times", times);
    archive("masses", masses);
    archive("rate", rate);
    for (double& each : rate_of_halves) archive("rate_of_half", each);
    for (double& each : height_of_halves) archive("height_of_half", each);
    archive("steps", steps);
    archive("wall_seconds", wall_seconds);
    archive("solid_fraction", solid_fraction);
  }
};

// Results of the previous stages.
template <int Dim>
struct Results {
  std::optional<dem::Grains<Dim>> filled;
  std::vector<Discharge> discharges;

  template <class Archive>
  void transfer(Archive& archive) {
    bool has_filled = filled.has_value();
    archive("has_filled", has_filled);
    if (has_filled && !filled) filled.emplace();
    if (has_filled) filled->transfer(archive);
    auto number = discharges.size();
    archive("discharges", number);
    discharges.resize(number);
    for (Discharge& each : discharges) each.transfer(archive);
  }
};

// State of the settling, which lasts until the grains are at rest.
struct Settling {
  bool has_begun = false;
  double from = 0;  // [s]

  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_begun", has_begun);
    archive("from", from);
  }
};

// Fills the bin by an inflow and lets the grains settle.
template <int Dim>
dem::Grains<Dim> fill(const Options& o, double D, int stage, Results<Dim>& previous) {
  const double R = o.diameter / 2;
  const dem::Blend<dem::UniformSizes> blend{
      .sizes = {.min_radius = (1 - o.spread) * R, .max_radius = (1 + o.spread) * R},
      .density = o.density};
  // Solid fraction of a loose bed.
  const double solid_fraction = Dim == 2 ? 0.80 : 0.58;
  const double radius_cubed = 1 + o.spread * o.spread * (Dim == 2 ? 1.0 / 3 : 1.0);
  const double cone = height_of_hopper(o, D) * cross_section<Dim>(o) / Dim;
  const double volume = o.bed() * cross_section<Dim>(o) + cone;
  const auto number = static_cast<Index>(solid_fraction * volume /
                                         (dem::volume_of<Dim>(R) * radius_cubed));
  dem::Inflow rain{region_above<Dim>(o, D), blend,
                   {.number = number,
                    .velocity = -5 * o.speed() * Vec<Dim>::Unit(Dim - 1),
                    .every = o.unit_of_time(),
                    .tries = 200,
                    .seed = o.seed}};
  auto bin = make_simulation<Dim>(o, {}, D, true);
  Slices slices;
  Settling settling;
  support::ResumableRun run(o.resume, checkpoint_of(o, stage), bin, rain, slices, settling,
                            previous);
  while (!settling.has_begun && (slices.is_open || !rain.is_done())) {
    slices.run_for(5 * o.unit_of_time(), 0, run, bin, rain);
    if (bin.time() > 1000 * o.unit_of_time()) {
      throw support::OptionError("only " + std::to_string(rain.number()) + " of " +
                                 std::to_string(number) +
                                 " grains could be filled in within 1000 sqrt(d/g); widen the bin");
    }
  }
  if (!settling.has_begun) settling = {.has_begun = true, .from = bin.time()};
  while (true) {
    slices.run_for(2 * o.unit_of_time(), 0, run, bin);
    if (dem::rms_speed(bin.particles()) < 0.01 * o.speed()) break;
    if (bin.time() - settling.from >= 200 * o.unit_of_time()) {
      fail("hopper: the grains are not at rest after 200 sqrt(d/g); lower --restitution");
    }
  }
  const double time = bin.time() - settling.from;
  std::printf("hopper: %zu grains filled in within %.3g s, settled within another %.3g s, "
              "%llu steps\n",
              bin.particles().size(), bin.time() - time, time,
              static_cast<unsigned long long>(bin.steps()));
  return bin.particles();
}

// Solid fraction in the central half of the bed, from the grains whose centres lie in it.
template <int Dim>
double solid_fraction_of(const Options& o, const dem::Grains<Dim>& grains, double D) {
  const double low = height_of_hopper(o, D) + 0.2 * o.bed(), high = low + 0.5 * o.bed();
  double solid = 0;
  for (Index i = 0; i < grains.size(); ++i) {
    const double height = grains[position][i][Dim - 1];
    if (low <= height && height < high) solid += dem::volume_of<Dim>(grains[radius][i]);
  }
  return solid / ((high - low) * cross_section<Dim>(o));
}

// --- discharge ----------------------------------------------------------------------------------

// Least-squares slope of mass over time, of entries [first, last).
double slope(const Discharge& d, Index first, Index last) {
  double t = 0, m = 0;
  const auto n = double(last - first);
  for (Index e = first; e < last; ++e) t += d.times[e] / n, m += d.masses[e] / n;
  double tt = 0, tm = 0;
  for (Index e = first; e < last; ++e) {
    tt += squared(d.times[e] - t);
    tm += (d.times[e] - t) * (d.masses[e] - m);
  }
  return tt > 0 ? tm / tt : 0;
}

// Optional frames.
struct Frames {
  std::optional<VtkSeries> series;

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (series) (*series)(simulation);
  }
  template <class Archive>
  void transfer(Archive& archive) {
    if (series) series->transfer(archive);
  }
};

template <int Dim>
Discharge discharge_through(const Options& o, double ratio, int stage, Results<Dim>& previous,
                            const std::string& frames_folder) {
  const double D = ratio * o.diameter;
  Discharge discharge;
  auto hopper = make_simulation<Dim>(o, previous.filled.value_or(dem::Grains<Dim>{}), D, false);
  Box<Dim> far_below;
  far_below.upper[Dim - 1] = -6 * o.diameter;
  dem::Outflow drain{far_below, {.every = o.unit_of_time()}};
  Frames frames;
  if (!frames_folder.empty()) frames.series.emplace(frames_folder);
  Slices slices;
  support::ResumableRun run(o.resume, checkpoint_of(o, stage), hopper, drain, discharge, frames,
                            slices, previous);
  const dem::Grains<Dim>& filled = *previous.filled;
  discharge.opening = ratio;
  discharge.solid_fraction = solid_fraction_of<Dim>(o, filled, D);
  double whole = 0;
  for (const double m : filled[mass]) whole += m;
  const auto note = [&](const auto& simulation) {
    const auto& grains = simulation.particles();
    double above = 0;
    for (Index i = 0; i < grains.size(); ++i) {
      if (grains[position][i][Dim - 1] > 0) above += grains[mass][i];
    }
    if (!discharge.times.empty() && discharge.times.back() == simulation.time()) return;
    discharge.times.push_back(simulation.time());
    discharge.masses.push_back(whole - above);
  };
  const double slice = o.unit_of_time();
  Stopwatch wall;
  {
    const auto span = wall.start();
    if (!hopper.was_read()) hopper.run({.until = 0}, frames);
    while (slices.is_open || discharge.masses.empty() ||
           (discharge.masses.back() < o.share * whole &&
            hopper.time() < o.longest * o.unit_of_time())) {
      slices.run_for(slice, slice / 10, run, hopper, note, drain);
      hopper.run({.until = hopper.time()}, frames);
    }
  }
  discharge.steps = hopper.steps();
  discharge.wall_seconds = wall.seconds();
  // The flow is steady after a few √(D/g).
  const double steady = 2 * std::sqrt(D / g);
  const auto first = static_cast<Index>(
      std::lower_bound(discharge.times.begin(), discharge.times.end(), steady) -
      discharge.times.begin());
  const Index last = discharge.times.size();
  if (last < first + 20) {
    throw support::OptionError("the discharge through an opening of " + to_text(ratio) +
                               " diameters ends before it is steady; increase --fill-height");
  }
  const Index middle = (first + last) / 2;
  const double mean_mass = whole / double(filled.size());
  if (discharge.masses[last - 1] - discharge.masses[middle] < 10 * mean_mass) {
    throw support::OptionError("an arch of grains blocks the opening of " + to_text(ratio) +
                               " diameters; widen it, or lower --friction-angle");
  }
  discharge.rate = slope(discharge, first, last);
  discharge.rate_of_halves[0] = slope(discharge, first, middle);
  discharge.rate_of_halves[1] = slope(discharge, middle, last);
  const auto height = [&](Index from, Index to) {
    const double left = 1 - (discharge.masses[from] + discharge.masses[to - 1]) / 2 / whole;
    return left * (o.bed() + height_of_hopper(o, D) / Dim) / D;
  };
  discharge.height_of_halves[0] = height(first, middle);
  discharge.height_of_halves[1] = height(middle, last);
  std::printf("hopper: D/d = %g: %.4g kg/s, %.4g in the first half, %.4g in the second, "
              "%llu steps in %.1f s of wall-clock time\n",
              ratio, discharge.rate, discharge.rate_of_halves[0], discharge.rate_of_halves[1],
              static_cast<unsigned long long>(discharge.steps), discharge.wall_seconds);
  return discharge;
}

// --- Beverloo's law -----------------------------------------------------------------------------

struct Fit {
  double exponent = 0;     // slope of log W over log(D/d − k)
  double deviation = 0;    // rms deviation of log W from the fit
  double coefficient = 0;  // mean C with the exponent of the law
};

Fit fit_beverloo(const Options& o, const std::vector<Discharge>& all, double k_of_fit) {
  double x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  Fit fit;
  const auto n = double(all.size());
  for (const Discharge& d : all) {
    const double unit = d.solid_fraction * o.density * std::sqrt(g) *
                        std::pow(o.diameter, o.exponent());
    const double a = std::log(d.opening - k_of_fit), b = std::log(d.rate / unit);
    x += a / n, y += b / n, xx += a * a / n, xy += a * b / n, yy += b * b / n;
    fit.coefficient += d.rate / (unit * std::pow(d.opening - k_of_fit, o.exponent())) / n;
  }
  const double variance = xx - x * x;
  if (variance > 0) fit.exponent = (xy - x * y) / variance;
  fit.deviation = std::sqrt(std::max(0.0, yy - y * y - fit.exponent * (xy - x * y)));
  return fit;
}

// The k for which the fitted exponent is that of the law.
double fit_k(const Options& o, const std::vector<Discharge>& all) {
  double low = -2, high = 0.95 * all.front().opening;
  for (int step = 0; step < 60; ++step) {
    const double middle = (low + high) / 2;
    (fit_beverloo(o, all, middle).exponent > o.exponent() ? low : high) = middle;
  }
  return low;
}

template <int Dim>
void run(const Options& o) {
  Stopwatch wall;
  Results<Dim> results;
  {
    const auto span = wall.start();
    const int first = first_stage(o);
    for (Index number = 0; number < o.openings.size(); ++number) {
      const double opening = o.openings[number];
      const bool is_pictured = opening == o.openings.back();
      // On a flat floor, the bed does not depend on the opening.
      const int filling = 2 * static_cast<int>(number), discharge = filling + 1;
      if (filling >= first && (!results.filled || o.half_angle != 90)) {
        results.filled = fill<Dim>(o, opening * o.diameter, filling, results);
      }
      if (discharge >= first) {
        auto result = discharge_through<Dim>(o, opening, discharge, results,
                                             is_pictured ? o.out + "/frames" : "");
        results.discharges.push_back(std::move(result));
      }
    }
  }
  const std::vector<Discharge>& all = results.discharges;
  const Index grains = results.filled->size();
  CsvFile table(o.out + "/discharge.csv", {"opening_over_d", "t", "mass"});
  for (const Discharge& d : all) {
    for (Index e = 0; e < d.times.size(); ++e) table.row({d.opening, d.times[e], d.masses[e]});
  }
  nlohmann::json rates = nlohmann::json::array();
  double worst = 0;
  std::uint64_t steps = 0;
  for (const Discharge& d : all) {
    const double change = d.rate_of_halves[1] / d.rate_of_halves[0] - 1;
    worst = std::max(worst, std::abs(change));
    steps += d.steps;
    rates.push_back({{"opening_over_d", d.opening},
                     {"rate", d.rate},
                     {"rate_first_half", d.rate_of_halves[0]},
                     {"rate_second_half", d.rate_of_halves[1]},
                     {"height_over_D_first_half", d.height_of_halves[0]},
                     {"height_over_D_second_half", d.height_of_halves[1]},
                     {"solid_fraction", d.solid_fraction},
                     {"steps", d.steps},
                     {"wall_seconds", d.wall_seconds}});
  }
  const Fit fit = fit_beverloo(o, all, k);
  support::complete(
      o.resume, o.out,
      {{"grains", grains},
       {"steps", steps},
       {"wall_seconds", wall.seconds()},
       {"exponent", fit.exponent},
       {"exponent_of_the_law", o.exponent()},
       {"k", k},
       {"coefficient", fit.coefficient},
       {"deviation", fit.deviation},
       {"k_for_the_exponent_of_the_law",
        all.size() > 1 ? fit_k(o, all) : k},
       {"largest_change_with_height", worst},
       {"rates", rates},
       {"options",
        {{"dimension", o.dimension},
         {"diameter", o.diameter},
         {"spread", o.spread},
         {"density", o.density},
         {"width", o.width},
         {"fill_height", o.fill_height},
         {"half_angle", o.half_angle},
         {"stiffness", o.stiffness},
         {"friction_angle", o.friction_angle},
         {"restitution", o.restitution},
         {"share", o.share},
         {"longest", o.longest},
         {"seed", o.seed},
         {"threads", o.threads}}}});
  std::printf("hopper: %zu grains, %llu steps in %.1f s of wall-clock time", grains,
              static_cast<unsigned long long>(steps), wall.seconds());
  if (all.size() > 1) {
    std::printf("; exponent %.3f with k = %g (law: %g), C = %.3f", fit.exponent, k, o.exponent(),
                fit.coefficient);
  }
  std::printf("; results in %s\n", o.out.c_str());
}

void discharge(Options& o) {
  complete(o);
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);
  if (o.dimension == 2) {
    run<2>(o);
  } else {
    run<3>(o);
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Discharge of a hopper through openings of several widths", "hopper");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&options] { discharge(options); });
}
