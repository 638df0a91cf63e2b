// SPDX-License-Identifier: MIT
// Water in a tank that is swayed near its first natural period, and then stands still. The period
// of the sloshing, and the motion of the centre of the water, are compared with linear theory. The
// tank moves, or, with --frame tank, stands still, and a body force replaces its acceleration.
//
//   sloshing --out out/sloshing
//   sloshing --frame tank --out out/sloshing/tank
//   examples/plot_sloshing.py out/sloshing
//
// The tank is displaced by A (1 − cos 2π t/T), for a whole number of periods T.
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/findings.hpp"
#include "support/fluid_cases/oscillation.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"
#include "support/sloshing_theory.hpp"
#include "support/tank_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace {

using namespace silt;

struct Options : support::TankOptions {
  double amplitude = 0.002;  // A [m]
  double period = 0;         // T [s]; 0: the first natural period
  int periods = 2;           // of the sway
  std::string frame = "room";

  support::SloshingTank tank() const { return {.length = length, .depth = depth}; }
  support::Sway sway() const {
    return {.amplitude = amplitude,
            .period = period > 0 ? period : tank().natural_period(1),
            .periods = periods};
  }
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::not_negative, support::between;
  add_option(app, "--amplitude", o.amplitude, "of the sway, half of its way [m]", positive());
  add_option(app, "--period", o.period, "of the sway [s]; 0: the first natural period",
             not_negative());
  add_option(app, "--periods", o.periods, "of the sway; then the tank stands still",
             between({1, 1000}));
  add_option(app, "--frame", o.frame,
             "room: the tank moves; tank: a body force replaces its motion",
             CLI::IsMember({"room", "tank"}));
  support::describe_tank(app, o, "sloshing.csv, frames.pvd, walls.pvd and summary.json");
}

// `record` has the displacement of the tank and, relative to it, the centre of the water.
std::vector<support::Finding> evaluate(const Options& o, const support::History& record) {
  const auto& t = record["t"];
  const auto& centre = record["centre"];
  const auto& theory = record["centre_theory"];
  double squares = 0, largest = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    squares += std::pow(centre[k] - theory[k], 2) / double(t.size());
    largest = std::max(largest, std::abs(theory[k]));
  }
  std::vector<double> times, free;
  for (std::size_t k = 0; k < t.size(); ++k) {
    if (t[k] < o.sway().end()) continue;
    times.push_back(t[k]);
    free.push_back(centre[k]);
  }
  const auto zeros = fluid_cases::zero_crossings(times, free);
  const std::size_t whole = zeros.size() > 2 ? (zeros.size() - 1) / 2 : 1;
  return {{.quantity = "period, mean of " + std::to_string(whole) + " after the sway [s]",
           .reference = o.tank().natural_period(1),
           .measured = fluid_cases::mean_period(zeros, whole),
           .allowed = 0.01},
          {.quantity = "centre of the water against linear theory, rms [m]",
           .measured = std::sqrt(squares),
           .allowed = support::stated,
           .scale = largest}};
}

template <int Dim>
void simulate(const Options& o) {
  const auto sway = o.sway();
  auto tank = support::make_tank<mps::Recommended, Dim>(o, 2 * o.amplitude);
  auto settings = support::flow_settings<mps::Recommended, Dim>(o, o.depth);
  auto& at_rest = tank.walls.template faces<Dim>();
  const bool moves = o.frame == "room";
  if (moves) {
    const MotionFunction<Dim> motion{[=](double t) {
      Pose<Dim> pose;
      pose.shift[0] = sway.displacement(t);
      return pose;
    }};
    support::set_moving<Dim>(tank.walls, {.faces = {{.faces = at_rest, .motion = motion}}});
    at_rest.clear();
  } else {
    settings.body_force = [=](const Vec<Dim>&, double t) {
      return Vec<Dim>(-sway.acceleration(t) * Vec<Dim>::Unit(0));
    };
  }
  settings.walls = tank.walls;
  const auto measure = [&](const auto& simulation) {
    const auto x = simulation.particles()[position];
    double sum = 0;
    for (const auto& at : x) sum += at[0];
    const double t = simulation.time(), displacement = sway.displacement(t);
    const double centre = sum / double(x.size()) - (moves ? displacement : 0) - o.length / 2;
    return std::vector<double>{displacement, centre, support::centre_by_theory(o.tank(), sway, t)};
  };
  const std::vector<std::string> names{"displacement", "centre", "centre_theory"};
  support::run_tank(
      o, tank.particles, settings,
      support::Study{"sloshing", names, measure,
                     [&](const support::History& record) { return evaluate(o, record); },
                     nlohmann::ordered_json{{"amplitude", o.amplitude},
                                            {"period", sway.period},
                                            {"periods", o.periods},
                                            {"frame", o.frame}}});
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.02;
  options.length = 0.4;
  options.depth = 0.2;
  options.until = 6;
  options.out = "out/sloshing";
  CLI::App app("Water in a tank that is swayed", "sloshing");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    options.dimension == 2 ? simulate<2>(options) : simulate<3>(options);
  });
}
