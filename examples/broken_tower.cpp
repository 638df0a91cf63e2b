// SPDX-License-Identifier: MIT
// The broken tower: discs (2D) or spheres (3D), stacked in a square lattice on a rough floor,
// collapse after another grain falls on the top. With global damping no grain is thrown off;
// without it (--alpha 0) some are.
//
// After J.-Y. Sah, J.-W. Choi, "Analysis of Granular Flow Using DEM", Figs 9 and 10. The paper
// gives no parameters; --help gives the reasons for those used here.
//
//   broken_tower --out out/broken_tower
//   broken_tower --out out/broken_tower/undamped --alpha 0
//   examples/plot_broken_tower.py out/broken_tower
//   broken_tower --dimension 3 --columns 20 --depth 20 --rows 40 --out out/tall_tower
#include <silt/dem.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/timed.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double g = 9.81;  // [m/s²]
constexpr int up = 1;       // the vertical axis, also in 3D

struct Options {
  int dimension = 2;
  int columns = 10;
  int depth = 10;
  int rows = 30;
  double radius = 0.02;            // [m]
  double density = 2500;           // [kg/m³]
  std::optional<double> normal_stiffness;  // [N/m]
  double friction_angle = 35;      // [degrees]
  double restitution = 0.8;        // [-]
  double alpha = 2;                // [1/s]
  double drop_height = 0.06;       // [m]
  double offset = 0.006;           // [m]
  double until = 4;                // [s]
  double output_every = 0.01;      // [s]
  int threads = 0;
  std::string out = "out/broken_tower";
  support::Resume resume = {};

  int grains_per_row() const { return dimension == 2 ? columns : columns * depth; }
  Index grains() const { return static_cast<Index>(rows) * static_cast<Index>(grains_per_row()); }
  double stiffness() const { return normal_stiffness.value_or(dimension == 2 ? 1e6 : 3e4); }
  double grain_mass() const {
    const double disc = density * std::numbers::pi * radius * radius;
    return dimension == 2 ? disc : disc * radius * 4 / 3;
  }
  double grain_weight() const { return grain_mass() * g; }
  double height() const { return 2 * radius * rows; }
  // Time in which a disturbance travels from one grain to the next, √(m/k).
  double time_per_layer() const { return std::sqrt(grain_mass() / stiffness()); }
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    return app.add_option(name, value, text)->check(check);
  };
  using support::positive, support::not_negative, support::between;
  app.option_defaults()->always_capture_default();
  add("--dimension", o.dimension, "2: discs of unit thickness; 3: spheres", between({2, 3}));
  add("--columns", o.columns, "width of the tower [grains]", between({1, 10000}));
  add("--depth", o.depth, "depth of the tower in 3D [grains]", between({1, 10000}));
  add("--rows", o.rows, "height of the tower [grains]; with 10 columns, 30 rows are tall enough to "
      "fail internally and wide enough to leave a heap", between({1, 10000}));
  add("--radius", o.radius, "radius of a grain [m]", positive());
  add("--density", o.density, "density of a grain [kg/m3]; the default is that of stone",
      positive());
  add("--normal-stiffness", o.normal_stiffness, "stiffness of a contact [N/m]; default 1e6 in 2D "
      "and 3e4 in 3D, where 30 rows compress the lowest contacts by 2 % of a diameter", positive());
  add("--friction-angle", o.friction_angle, "friction angle between grains and with the floor "
      "[degrees]; on a smoother floor the whole heap slides, and no disc separates from it",
      between({0, 89}));
  add("--restitution", o.restitution, "coefficient of restitution [-]; the default loses little "
      "energy per contact, so that the effect of global damping is visible", between({0.01, 1}));
  add("--alpha", o.alpha, "global damping [1/s], 0: none; the default stops a rolling disc within "
      "a second, but hardly slows the fall, which takes half a second", not_negative());
  // Farther away, positions have too few digits for contacts.
  constexpr double far = 1e9;  // [m]
  add("--drop-height", o.drop_height, "initial height of the falling grain above the top [m]",
      between({1e-9, far}));
  add("--offset", o.offset, "distance of the falling grain from the tower's axis, to the right "
      "[m]; 0: symmetric", between({-far, far}));
  add("--until", o.until, "end of the run [s]; long enough for grains that are thrown off to "
      "separate from the heap", positive());
  add("--output-every", o.output_every, "time between frames and between rows of the tables [s]",
      positive());
  add("--threads", o.threads, support::threads_help, between({0, 1024}));
  app.add_option("--out", o.out,
                 "folder for energy.csv, spreading.csv, floor.csv, summary.json and frames.pvd");
  support::describe_resume(app, o.resume);
}

void check_combination(const Options& o) {
  if (double(o.rows) * o.columns * (o.dimension == 2 ? 1 : o.depth) > 1e6) {
    throw support::OptionError("--columns times --rows (times --depth in 3D) must not exceed 1e6");
  }
  const double min_stiffness = 5 * o.rows * o.grain_weight() / o.radius;
  if (o.stiffness() < min_stiffness) {
    throw support::OptionError("--normal-stiffness " + to_text(o.stiffness()) +
                               " is too low for the weight of the tower; use at least " +
                               to_text(min_stiffness));
  }
}

template <int Dim>
Vec<Dim> point(double across, double height, [[maybe_unused]] double deep) {
  if constexpr (Dim == 2) {
    return {across, height};
  } else {
    return {across, height, deep};
  }
}

// Horizontal distance from the tower's axis.
template <class V>
double distance(const V& x) {
  return V::RowsAtCompileTime == 2 ? std::abs(x[0]) : std::hypot(x[0], x[x.size() - 1]);
}

// Built layer by layer from the floor up, each contact compressed by the weight above it, so that
// the tower is initially in equilibrium. The last grain is the falling one.
template <int Dim>
dem::Grains<Dim> make_tower(const Options& o) try {
  const dem::Grain grain{.radius = o.radius, .density = o.density};
  dem::Grains<Dim> grains;
  double height = -o.radius;
  const int depth = Dim == 2 ? 1 : o.depth;
  for (int row = 0; row < o.rows; ++row) {
    height += 2 * o.radius - (o.rows - row) * o.grain_weight() / o.stiffness();
    for (int behind = 0; behind < depth; ++behind) {
      for (int column = 0; column < o.columns; ++column) {
        dem::add_grain(grains,
                       point<Dim>((2 * column - o.columns + 1) * o.radius, height,
                                  (2 * behind - depth + 1) * o.radius),
                       grain);
      }
    }
  }
  dem::add_grain(grains, point<Dim>(o.offset, height + 2 * o.radius + o.drop_height, 0), grain);
  return grains;
} catch (const Error& error) {
  throw support::OptionError(error.what());
}

// Writes energy.csv and, until the grain lands, compares the loads inside the tower with the weight
// above, i m g.
template <int Dim>
class Ledger {
 public:
  explicit Ledger(const Options& options)
      : options_(options),
        table_(options.out + "/energy.csv",
               {"t", "kinetic", "rotational", "potential", "elastic", "momentum_x", "momentum_y",
                "floor_x", "floor_y", "contacts"}) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    const auto state = simulation.state();
    const auto& grains = state.particles;
    const auto& contacts = state.interaction.template part<1>();
    Vec<Dim> floor = Vec<Dim>::Zero();
    double error = 0;
    contacts.for_each_contact(
        grains, [&](Index i, Index j, const auto& contact, const Vec<Dim>& f) {
          if (j == no_index) floor += f;
          if (std::abs(contact.normal[up]) < 0.5) return;
          const Id upper = j == no_index ? grains.id(i) : std::max(grains.id(i), grains.id(j));
          error = std::max(error, std::abs(std::abs(f[up]) / load_below(upper) - 1));
        });
    if (simulation.time() < std::sqrt(2 * options_.drop_height / g)) {
      floor_load_ = floor[up] / (options_.grain_weight() * double(grains.size() - 1));
      layer_error_ = std::max(layer_error_, error);
    }
    const Vec<Dim> p = momentum(grains);
    table_.row({simulation.time(), kinetic_energy(grains), rotational_energy(grains),
                potential_energy(grains, Vec<Dim>(-g * Vec<Dim>::Unit(up))),
                contacts.elastic_energy(grains), p[0], p[up], floor[0], floor[up],
                double(contacts.size())});
  }

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    contacts_ += double(simulation.interaction().template part<1>().size());
  }
  template <class Archive>
  void transfer(Archive& archive) {
    table_.transfer(archive);
    archive("contacts", contacts_);
    archive("floor_load", floor_load_);
    archive("layer_error", layer_error_);
  }

  /// Sum over all steps [-].
  double contacts() const { return contacts_; }
  /// Force on the floor over the weight of the tower, just before the grain lands [-].
  double floor_load() const { return floor_load_; }
  /// Largest deviation of a contact's force from the weight above it before the grain lands [-].
  double layer_error() const { return layer_error_; }

 private:
  // Load on the contacts below a grain of the tower [N].
  double load_below(Id grain) const {
    const double layer = double(grain / static_cast<Id>(options_.grains_per_row()));
    return (options_.rows - layer) * options_.grain_weight();
  }

  Options options_;
  CsvFile table_;
  double contacts_ = 0;
  double floor_load_ = 0;
  double layer_error_ = 0;
};

// The disturbance that travels down: the force on the floor at every step after the grain has
// landed, in floor.csv. The front of a pulse in a chain of masses and springs travels one mass per
// √(m/k); it arrives when the force on the floor has risen by half of its maximum.
template <int Dim>
class Wave {
 public:
  explicit Wave(const Options& options)
      : options_(options), table_(options.out + "/floor.csv", {"t", "over_weight"}) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.steps() == 0) table_.begin();  // there may be no row for a long time
  }
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    // The contacts are those at the beginning of the step.
    const double time = simulation.time() - simulation.last_time_step();
    if (time < 0.9 * std::sqrt(2 * options_.drop_height / g)) return;
    if (has_landed() && since(time) > 3) return;
    double floor = 0;
    bool lands = false;
    const auto& grains = simulation.particles();
    const Id falling = options_.grains();
    simulation.interaction().template part<1>().for_each_contact(
        grains, [&](Index i, Index j, const auto&, const Vec<Dim>& f) {
          if (j == no_index) floor += f[up];
          lands |= grains.id(i) == falling || (j != no_index && grains.id(j) == falling);
        });
    if (!has_landed() && lands) landing_ = time;
    if (!has_landed()) {
      rest_ = floor;
      return;
    }
    const double weight = options_.grain_weight() * double(options_.grains());
    table_.row({time - landing_, floor / weight});
    signal_.push_back({time - landing_, floor - rest_});
  }
  template <class Archive>
  void transfer(Archive& archive) {
    table_.transfer(archive);
    archive("landing", landing_);
    archive("rest", rest_);
    archive("signal", signal_);
  }

  /// Time of the first contact of the falling grain with the tower [s].
  double landing() const { return landing_; }
  /// Arrival of the disturbance at the floor, after the landing [s].
  double arrival() const {
    if (signal_.empty() || since(landing_ + signal_.back().time) < 2) return nan;
    const double half = max_force() / 2;
    for (std::size_t k = 1; k < signal_.size(); ++k) {
      const auto& [t, force] = signal_[k];
      const auto& previous = signal_[k - 1];
      if (force < half) continue;
      return previous.time +
             (t - previous.time) * (half - previous.force) / (force - previous.force);
    }
    return nan;
  }
  /// Maximum force on the floor before the reflected pulse can return, minus the tower's weight,
  /// over the weight of a grain [-].
  double peak() const { return signal_.empty() ? nan : max_force() / options_.grain_weight(); }

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  struct Sample {
    double time;   // since the landing [s]
    double force;  // minus the force at rest [N]
  };

  bool has_landed() const { return is_finite(landing_); }

  // Time since the landing, in units of the travel time of the pulse from the top to the floor.
  double since(double time) const {
    return (time - landing_) / (options_.rows * options_.time_per_layer());
  }
  double max_force() const {
    double force = 0;
    for (const Sample& sample : signal_) {
      if (since(landing_ + sample.time) < 2) force = std::max(force, sample.force);
    }
    return force;
  }

  Options options_;
  CsvFile table_;
  double landing_ = nan;  // [s]
  double rest_ = 0;       // force on the floor before the landing [N]
  std::vector<Sample> signal_;
};

// Spreading of the lowest layer and of the heap along the floor, in spreading.csv.
template <int Dim>
class Spreading {
 public:
  explicit Spreading(const Options& options)
      : options_(options),
        table_(options.out + "/spreading.csv",
               {"t", "basal_moved", "basal_front", "half_width", "height"}) {}

  template <class Sim>
  void operator()(const Sim& simulation) {
    const auto& grains = simulation.particles();
    const auto x = grains[position];
    const auto basal = static_cast<Index>(options_.grains_per_row());
    std::vector<Vec<Dim>> lowest(basal);
    std::vector<double> distances, heights;
    for (Index i = 0; i < grains.size(); ++i) {
      if (grains.id(i) < basal) lowest[grains.id(i)] = x[i];
      distances.push_back(distance(x[i]));
      heights.push_back(x[i][up] + options_.radius);
    }
    if (lowest_.empty()) lowest_ = lowest;
    double moved = 0, front = 0;
    for (Index k = 0; k < basal; ++k) {
      moved += (lowest[k] - lowest_[k]).norm() > options_.radius;
      front = std::max(front, distance(lowest[k]));
    }
    moved_ = moved / double(basal);
    if (simulation.time() > time_) {
      speed_ = std::max(speed_, (front - front_) / (simulation.time() - time_));
    }
    time_ = simulation.time();
    front_ = front;
    half_width_ = percentile_95(distances);
    if (time_ == 0) first_half_width_ = half_width_;
    table_.row({time_, moved_, front, half_width_, percentile_95(heights)});
  }
  template <class Archive>
  void transfer(Archive& archive) {
    table_.transfer(archive);
    archive("lowest", lowest_);
    archive("time", time_);
    archive("moved", moved_);
    archive("front", front_);
    archive("speed", speed_);
    archive("half_width", half_width_);
    archive("first_half_width", first_half_width_);
  }

  /// Fraction of the lowest layer that has moved by more than a radius [-].
  double basal_moved() const { return moved_; }
  /// Largest speed of the outermost grain of the lowest layer between outputs [m/s].
  double front_speed() const { return speed_; }
  /// Half width of the heap, containing 95 % of the grains, over that of the tower [-].
  double widening() const { return half_width_ / first_half_width_; }

 private:
  static double percentile_95(std::vector<double>& values) {
    const auto last = (values.size() * 95 + 99) / 100 - 1;
    const auto found = values.begin() + static_cast<std::ptrdiff_t>(last);
    std::nth_element(values.begin(), found, values.end());
    return *found;
  }

  Options options_;
  CsvFile table_;
  std::vector<Vec<Dim>> lowest_;  // initial positions
  double time_ = 0;
  double moved_ = 0;
  double front_ = 0;
  double speed_ = 0;
  double half_width_ = 0;
  double first_half_width_ = 1;
};

// Distances of the grains from the tower's axis. The radius of the pile contains 95 % of them; a
// grain at more than twice that distance has escaped.
struct Spread {
  double pile_radius = 0;  // [m]
  double farthest = 0;     // [m]
  Index escaped = 0;

  template <class P>
  explicit Spread(const P& grains) {
    std::vector<double> distances;
    for (const auto& x : grains[position]) distances.push_back(distance(x));
    std::sort(distances.begin(), distances.end());
    pile_radius = distances[(distances.size() * 95 + 99) / 100 - 1];
    farthest = distances.back();
    for (const double d : distances) escaped += d > 2 * pile_radius;
  }
};

// Combinations of options without a usable time step are rejected like any invalid option.
template <class Sim>
void check_time_step(const Options& o, Sim& tower) {
  double steps = 0;
  try {
    steps = o.until / tower.time_step();
    GlobalDamping{.alpha = o.alpha}.check(tower.time_step());
  } catch (const Error& error) {
    throw support::OptionError(error.what());
  }
  if (steps > 1e10) {
    throw support::OptionError("--until " + to_text(o.until) + " takes " + to_text(steps) +
                               " steps with these grains; reduce it, or --normal-stiffness");
  }
}

template <int Dim>
void collapse(const Options& o) {
  auto grains = make_tower<Dim>(o);
  support::open_output_folder(o.resume, o.out);
  support::use_threads_of_option(o.threads);

  const dem::CundallStrack law{.normal_stiffness = o.stiffness(),
                               .tangential_stiffness = o.stiffness() / 2,
                               .restitution = o.restitution,
                               .friction_angle = o.friction_angle * std::numbers::pi / 180};
  const auto floor = dem::Plane<Dim>{.normal = Vec<Dim>::Unit(up)};
  const Gravity<Dim> gravity{Vec<Dim>(-g * Vec<Dim>::Unit(up))};
  Simulation tower{std::move(grains), TimedSearch{UniformGrid<Dim>{}},
                   Forces{gravity, TimedInteraction{dem::Contacts{law, floor}}},
                   Leapfrog{GlobalDamping{.alpha = o.alpha}}};
  check_time_step(o, tower);
  Ledger<Dim> ledger(o);
  Wave<Dim> wave(o);
  Spreading<Dim> spreading(o);
  Stopwatch wall;
  {
    const auto span = wall.start();
    support::run_or_resume(o.resume, o.out, tower,
                           {.until = o.until, .output_every = o.output_every}, ledger, wave,
                           spreading, VtkSeries{o.out + "/frames"}, Progress{});
  }

  const Spread spread(tower.particles());
  support::complete(
      o.resume, o.out,
      {{"steps", tower.steps()},
       {"wall_seconds", wall.seconds()},
       {"particles", tower.particles().size()},
       {"contacts_mean", ledger.contacts() / double(tower.steps())},
       {"escaped", spread.escaped},
       {"seconds_search", tower.search().seconds()},
       {"seconds_contacts", tower.interaction().template part<1>().seconds()},
       {"time_step", tower.last_time_step()},
       {"pile_radius", spread.pile_radius},
       {"farthest", spread.farthest},
       {"floor_load_over_weight", ledger.floor_load()},
       {"layer_load_error", ledger.layer_error()},
       {"grain_weight", o.grain_weight()},
       {"time_a_layer", o.time_per_layer()},
       {"landing_time", wave.landing()},
       {"wave_arrival", wave.arrival()},
       {"wave_arrival_a_layer", wave.arrival() / (o.rows * o.time_per_layer())},
       {"wave_speed", o.height() / wave.arrival()},
       {"floor_peak_over_grain_weight", wave.peak()},
       {"basal_moved", spreading.basal_moved()},
       {"front_speed", spreading.front_speed()},
       {"front_speed_over_fall", spreading.front_speed() / std::sqrt(2 * g * o.height())},
       {"half_width_over_first", spreading.widening()},
       {"options",
        {{"dimension", o.dimension},
         {"columns", o.columns},
         {"depth", o.dimension == 2 ? 1 : o.depth},
         {"rows", o.rows},
         {"radius", o.radius},
         {"density", o.density},
         {"normal_stiffness", o.stiffness()},
         {"friction_angle", o.friction_angle},
         {"restitution", o.restitution},
         {"alpha", o.alpha},
         {"drop_height", o.drop_height},
         {"offset", o.offset},
         {"until", o.until},
         {"output_every", o.output_every},
         {"threads", o.threads}}}});
  std::printf("broken_tower: %zu grains, "
              "%llu steps in %.1f s of wall-clock time, %zu escaped; results in %s\n",
              tower.particles().size(), static_cast<unsigned long long>(tower.steps()),
              wall.seconds(), spread.escaped, o.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Collapse of a tower of discs or spheres hit by a falling grain", "broken_tower");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&options] {
    check_combination(options);
    options.dimension == 2 ? collapse<2>(options) : collapse<3>(options);
  });
}
