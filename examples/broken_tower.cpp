// SPDX-License-Identifier: MIT
// The broken tower: discs stacked in a square pattern on a rough floor collapse after one more disc
// fell on the top. With global damping none is thrown off, without it (--alpha 0) some are.
//
// After J.-Y. Sah, J.-W. Choi, "Analysis of Granular Flow Using DEM", Figs 9 and 10. The paper
// gives no sizes; those here are ours, and --help says why they are what they are.
//
//   broken_tower --out out/broken_tower
//   broken_tower --out out/broken_tower/undamped --alpha 0
//   examples/plot_broken_tower.py out/broken_tower
#include <silt/dem.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/timed.hpp>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "support/command_line.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double g = 9.81;  // [m/s²]

struct Options {
  int columns = 10;
  int rows = 30;
  double radius = 0.02;            // [m]
  double density = 2500;           // [kg/m³]
  double normal_stiffness = 1e6;   // [N/m]
  double friction_angle = 35;      // [degrees]
  double restitution = 0.8;        // [-]
  double alpha = 2;                // [1/s]
  double drop_height = 0.06;       // [m]
  double offset = 0.006;           // [m]
  double until = 4;                // [s]
  double output_every = 0.01;      // [s]
  int threads = 1;
  std::string out = "out/broken_tower";

  double disc_weight() const { return density * std::numbers::pi * radius * radius * g; }
};

void describe(CLI::App& app, Options& o) {
  const auto add = [&app](const std::string& name, auto& value, const std::string& text,
                          const CLI::Validator& check) {
    app.add_option(name, value, text)->check(check)->capture_default_str();
  };
  using support::positive, support::not_negative, support::between;
  const CLI::Validator any = support::finite();
  add("--columns", o.columns, "discs beside one another", between({1, 10000}));
  add("--rows", o.rows, "discs above one another; with 10 columns, 30 rows are tall enough to fail "
      "from within and wide enough to leave a heap", between({1, 10000}));
  add("--radius", o.radius, "of a disc [m]", positive());
  add("--density", o.density, "of a disc [kg/m3], stone; discs are of unit thickness", positive());
  add("--normal-stiffness", o.normal_stiffness, "of a contact [N/m]; by default the weight of the "
      "tower presses the lowest contacts by 2 % of a diameter", positive());
  add("--friction-angle", o.friction_angle, "between discs and with the floor [degrees]; on a "
      "smoother floor the whole heap slides, and no disc is far from the others",
      between({0, 89}));
  add("--restitution", o.restitution, "of a contact [-]; hard discs lose little at a contact, so "
      "that global damping makes the difference", between({0.01, 1}));
  add("--alpha", o.alpha, "global damping [1/s]; 0: none. The default stops a rolling disc within "
      "a second, and hardly slows the fall, which takes half a second", not_negative());
  add("--drop-height", o.drop_height, "of the falling disc above the top [m]", positive());
  add("--offset", o.offset, "of the falling disc from the tower's axis, to the right [m]; 0: all "
      "is symmetric", any);
  add("--until", o.until, "end of the run [s]; discs that were thrown off must have the time to "
      "get away from the others", positive());
  add("--output-every", o.output_every, "time between frames, and between energies [s]",
      positive());
  add("--threads", o.threads, "threads; the result is the same bits for any number",
      between({1, 1024}));
  app.add_option("--out", o.out, "folder for energy.csv, summary.json and frames.pvd")
      ->capture_default_str();
}

void check_together(const Options& o) {
  if (o.columns * static_cast<double>(o.rows) > 1e6) {
    throw support::Refusal("--columns times --rows must be at most 1e6");
  }
  const double softest = 5 * o.rows * o.disc_weight() / o.radius;
  if (o.normal_stiffness < softest) {
    throw support::Refusal("--normal-stiffness " + to_text(o.normal_stiffness) +
                           " is too soft for the weight of the tower; give at least " +
                           to_text(softest));
  }
}

// Layer by layer from the floor up, each contact already pressed by the weight above it, so that
// the tower begins at rest in its own equilibrium. The last disc is the one that falls.
dem::Grains<2> make_tower(const Options& o) try {
  const dem::Grain disc{.radius = o.radius, .density = o.density};
  dem::Grains<2> grains;
  double height = -o.radius;
  for (int row = 0; row < o.rows; ++row) {
    height += 2 * o.radius - (o.rows - row) * o.disc_weight() / o.normal_stiffness;
    for (int column = 0; column < o.columns; ++column) {
      dem::add_grain(grains, {(2 * column - o.columns + 1) * o.radius, height}, disc);
    }
  }
  dem::add_grain(grains, {o.offset, height + 2 * o.radius + o.drop_height}, disc);
  return grains;
} catch (const Error& error) {
  throw support::Refusal(error.what());
}

// Writes energy.csv, and compares the loads inside the tower with the weight above, i m g, for as
// long as the disc is falling.
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
    Vec<2> floor = Vec<2>::Zero();
    double error = 0;
    contacts.for_each_contact(grains, [&](Index i, Index j, const auto& contact, const Vec<2>& f) {
      if (j == nowhere) floor += f;
      if (std::abs(contact.normal[1]) < 0.5) return;
      const Id upper = grains.id(j == nowhere ? i : j);
      error = std::max(error, std::abs(std::abs(f[1]) / load_below(upper) - 1));
    });
    if (simulation.time() < std::sqrt(2 * options_.drop_height / g)) {
      floor_load_ = floor[1] / (options_.disc_weight() * double(grains.size() - 1));
      layer_error_ = std::max(layer_error_, error);
    }
    const Vec<2> p = momentum(grains);
    table_.row({simulation.time(), kinetic_energy(grains), rotational_energy(grains),
                potential_energy(grains, {0, -g}), contacts.elastic_energy(grains), p[0], p[1],
                floor[0], floor[1], double(contacts.size())});
  }

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    contacts_ += double(simulation.interaction().template part<1>().size());
  }

  /// Added up over all steps [-].
  double contacts() const { return contacts_; }
  /// Force on the floor over the weight of the tower, last seen before the disc lands [-].
  double floor_load() const { return floor_load_; }
  /// Largest deviation of a contact's force from the weight above it before the disc lands [-].
  double layer_error() const { return layer_error_; }

 private:
  // What the contacts under a disc of the tower carry [N].
  double load_below(Id disc) const {
    const double layer = double(disc / static_cast<Id>(options_.columns));
    return (options_.rows - layer) * options_.disc_weight();
  }

  Options options_;
  CsvFile table_;
  double contacts_ = 0;
  double floor_load_ = 0;
  double layer_error_ = 0;
};

// How far the discs got from the tower's axis. The pile's radius is that of 95 % of them; a disc
// twice as far away has escaped.
struct Spread {
  double pile_radius = 0;  // [m]
  double farthest = 0;     // [m]
  Index escaped = 0;

  explicit Spread(const dem::Grains<2>& grains) {
    std::vector<double> distances;
    for (const auto& x : grains[position]) distances.push_back(std::abs(x[0]));
    std::sort(distances.begin(), distances.end());
    pile_radius = distances[(distances.size() * 95 + 99) / 100 - 1];
    farthest = distances.back();
    for (const double distance : distances) escaped += distance > 2 * pile_radius;
  }
};

// Numbers that only together give no usable time step are refused like any other option.
template <class Sim>
void check_time_step(const Options& o, Sim& tower) {
  double steps = 0;
  try {
    steps = o.until / tower.time_step();
    GlobalDamping{.alpha = o.alpha}.check(tower.time_step());
  } catch (const Error& error) {
    throw support::Refusal(error.what());
  }
  if (steps > 1e10) {
    throw support::Refusal("--until " + to_text(o.until) + " takes " + to_text(steps) +
                           " steps with these grains; shorten it, or soften them");
  }
}

void collapse(const Options& o) {
  check_together(o);
  auto grains = make_tower(o);
  support::make_output_folder(o.out);
  use_threads(o.threads);

  const dem::CundallStrack law{.normal_stiffness = o.normal_stiffness,
                               .tangential_stiffness = o.normal_stiffness / 2,
                               .restitution = o.restitution,
                               .friction_angle = o.friction_angle * std::numbers::pi / 180};
  const auto floor = dem::Plane<2>{.normal = {0, 1}};
  Simulation tower{std::move(grains), TimedSearch{UniformGrid<2>{}},
                   Forces{Gravity<2>{{0, -g}}, TimedInteraction{dem::Contacts{law, floor}}},
                   Leapfrog{GlobalDamping{.alpha = o.alpha}}};
  check_time_step(o, tower);
  Ledger ledger(o);
  Stopwatch wall;
  {
    const auto span = wall.start();
    tower.run({.until = o.until, .output_every = o.output_every}, ledger,
              VtkSeries{o.out + "/frames"}, Progress{});
  }

  const Spread spread(tower.particles());
  support::write_summary(
      o.out, {{"steps", tower.steps()},
              {"wall_seconds", wall.seconds()},
              {"particles", tower.particles().size()},
              {"contacts_mean", ledger.contacts() / double(tower.steps())},
              {"escaped", spread.escaped},
              {"seconds_search", tower.search().seconds()},
              {"seconds_contacts", tower.interaction().part<1>().seconds()},
              {"time_step", tower.last_time_step()},
              {"pile_radius", spread.pile_radius},
              {"farthest", spread.farthest},
              {"floor_load_over_weight", ledger.floor_load()},
              {"layer_load_error", ledger.layer_error()},
              {"options",
               {{"columns", o.columns},
                {"rows", o.rows},
                {"radius", o.radius},
                {"density", o.density},
                {"normal_stiffness", o.normal_stiffness},
                {"friction_angle", o.friction_angle},
                {"restitution", o.restitution},
                {"alpha", o.alpha},
                {"drop_height", o.drop_height},
                {"offset", o.offset},
                {"until", o.until},
                {"output_every", o.output_every},
                {"threads", o.threads}}}});
  std::printf("broken_tower: %zu discs, %llu steps in %.1f s, %zu escaped; see %s\n",
              tower.particles().size(), static_cast<unsigned long long>(tower.steps()),
              wall.seconds(), spread.escaped, o.out.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("Collapse of a tower of discs, hit from above by one more", "broken_tower");
  describe(app, options);
  return support::run(app, argc, argv, [&options] { collapse(options); });
}
