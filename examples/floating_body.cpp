// SPDX-License-Identifier: MIT
// A box that floats in a tank: released above its draught it heaves, released with a tilt it rolls,
// or turns over. With the default options it is twice as wide as high, has half the density of
// water, and its heave is compared with linear potential theory.
//
//   floating_body --hold both --out out/floating_body
//   floating_body --width 0.2 --height 0.2 --density-ratio 0.5 --offset 0 --tilt 10 --out out/roll
//   floating_body --dimension 3 --spacing 0.02 --length 1 --thickness 0.8 --until 0.5 --out out/box_3d
//   examples/plot_floating_body.py out/floating_body
//
// Heights are above the floor. The tilt is a turn from x towards the vertical; in 3D about the axis
// −y.
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_group.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/findings.hpp"
#include "support/fluid_cases/oscillation.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"
#include "support/tank_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace {

using namespace silt;

struct Options : support::TankOptions {
  double width = 0.4;          // of the box [m], along x
  double height = 0.2;         // [m]
  double breadth = 0.4;        // [m], in 3D, along y
  double density_ratio = 0.5;  // to that of water
  double offset = 0.02;        // above its draught [m]
  double tilt = 0;             // [°]
  std::string hold = "none";

  double draught() const { return density_ratio * height; }
};

constexpr double water_density = 1000;             // [kg/m³]
constexpr double degree = std::numbers::pi / 180;  // [rad]

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  add_option(app, "--width", o.width, "width of the box, along x [m]", positive());
  add_option(app, "--height", o.height, "its height [m]", positive());
  add_option(app, "--breadth", o.breadth, "its length along y in 3D [m]", positive());
  add_option(app, "--density-ratio", o.density_ratio, "its density over that of water",
             between({0.01, 0.99}));
  add_option(app, "--offset", o.offset, "how far above its draught it is released [m]",
             between({-100, 100}));
  add_option(app, "--tilt", o.tilt, "angle at which it is released [°]", between({-180, 180}));
  add_option(app, "--hold", o.hold,
             "motions that it does not make: none, sway (horizontally), "
             "roll (turns) or both",
             CLI::IsMember({"none", "sway", "roll", "both"}));
  support::describe_tank(app, o, "floating_body.csv, frames.pvd, walls.pvd and summary.json");
}

template <int Dim>
Eigen::Matrix<double, Dim, Dim> rotation_of_tilt(double angle) {
  if constexpr (Dim == 2) {
    return rotation_by(angle);
  } else {
    return rotation_about(Vec<3>(-Vec<3>::UnitY()), angle);
  }
}

template <int Dim>
Vec<Dim> centre_of_body(const Options& o) {
  Vec<Dim> centre = Vec<Dim>::Constant(o.thickness / 2);
  centre[0] = o.length / 2;
  centre[Dim - 1] = o.depth - o.draught() + o.height / 2 + o.offset;
  return centre;
}

template <int Dim>
mps::FloatingBody<Dim> make_body(const Options& o) {
  Vec<Dim> half = Vec<Dim>::Constant(o.breadth / 2);
  half[0] = o.width / 2;
  half[Dim - 1] = o.height / 2;
  const Vec<Dim> centre = centre_of_body<Dim>(o);
  mps::FloatingBody<Dim> body{.faces = faces_of(Box<Dim>{.lower = -half, .upper = half}),
                              .density = o.density_ratio * water_density,
                              .keeps_orientation = o.hold == "roll" || o.hold == "both"};
  const auto rotation = rotation_of_tilt<Dim>(o.tilt * degree);
  for (auto& face : body.faces) {
    for (auto& corner : face.corners) corner = centre + rotation * corner;
  }
  if (o.hold == "sway" || o.hold == "both") {
    body.is_held.fill(true);
    body.is_held.back() = false;
  }
  return body;
}

// Of a vector along the axes, or of an angular vector, which is one number in 2D.
template <class V>
void append(std::vector<double>& row, const V& values) {
  if constexpr (std::is_arithmetic_v<V>) {
    row.push_back(values);
  } else {
    row.insert(row.end(), values.begin(), values.end());
  }
}

template <int Dim>
WallLoad<Dim> load_of_body(const Options& o) {
  return WallLoad<Dim>(WallGroup::body(0)).about(centre_of_body<Dim>(o));
}

// Position [m], turn [rad], velocity [m/s], spin [1/s] of the body, and the load of the water on it
// in the last step, see WallLoad.
template <int Dim>
std::vector<std::string> names(const Options& o) {
  const std::vector<std::string> axes =
      Dim == 2 ? std::vector<std::string>{"x", "y"} : std::vector<std::string>{"x", "y", "z"};
  std::vector<std::string> all;
  const auto add = [&](const std::string& name, bool is_turn) {
    if (is_turn && Dim == 2) return all.push_back(name);
    for (const auto& axis : axes) all.push_back(name.empty() ? axis : name + "_" + axis);
  };
  add("", false), add("turn", true), add("velocity", false), add("spin", true);
  for (const auto& name : load_of_body<Dim>(o).columns()) all.push_back(name);
  return all;
}
template <int Dim>
auto measure(const Options& o) {
  return [tilt = o.tilt * degree, load = load_of_body<Dim>(o)](const auto& simulation) {
    const BodyState<Dim> state = simulation.interaction().walls().bodies()[0].state();
    std::vector<double> row;
    append(row, state.position);
    if constexpr (Dim == 2) {
      row.push_back(tilt + state.orientation.angle);  // with whole turns
    } else {
      append(row, turn_of(Eigen::Matrix3d(state.pose.rotation * rotation_of_tilt<3>(tilt))));
    }
    append(row, state.velocity);
    append(row, state.spin);
    append(row, load.row(simulation));
    return row;
  };
}

// Zeros of the heave of a box of 0.4 m × 0.2 m, half as dense as the water, which is 0.4 m deep
// [s]: linear potential theory, see tests/reference/heave_of_a_box.py.
constexpr double zeros_of_theory[] = {0.3195, 0.7934, 1.2815};

// `level` of the water when the box is at rest [m].
std::vector<support::Finding> evaluate(const Options& o, double level,
                                       const support::History& history) {
  std::vector<support::Finding> findings;
  const bool is_2d = o.dimension == 2;
  const auto& t = history["t"];
  const std::vector<double>& y = history[is_2d ? "y" : "z"];
  const double at_rest = level - o.draught() + o.height / 2;
  // About the surface as it was: its rise, by the water that the box displaces, comes with the
  // waves.
  std::vector<double> heave = y;
  for (double& value : heave) value -= at_rest - level + o.depth;

  const auto zeros = fluid_cases::zero_crossings(t, heave);
  const auto is_close = [](double a, double b) { return std::abs(a - b) < 1e-6 * b; };
  const bool has_theory = is_2d && o.tilt == 0 && o.offset != 0 &&
                          is_close(o.width, 2 * o.height) && is_close(o.depth, o.width) &&
                          is_close(o.density_ratio, 0.5);
  for (std::size_t k = 0; k < 3 && k < zeros.size() && o.tilt == 0 && o.offset != 0; ++k) {
    const double theory = zeros_of_theory[k] * std::sqrt(o.width / 0.4);
    findings.push_back({.quantity = "zero " + std::to_string(k + 1) + " of the heave [s]",
                        .reference = has_theory ? theory : support::no_reference,
                        .measured = zeros[k],
                        .allowed = has_theory ? 0.05 : support::stated});
  }
  findings.push_back({.quantity = "height of the centre, mean of the last quarter [m]",
                      .reference = at_rest,
                      .measured = support::mean_from(0.75 * t.back(), t, y),
                      .allowed = support::stated,
                      .scale = o.spacing});  // the error is in spacings
  if (o.tilt != 0) {
    // Metacentric height over the height of the box: above 0 it is stable upright.
    const double stability =
        std::pow(o.width, 2) / (12 * o.draught() * o.height) - (1 - o.density_ratio) / 2;
    std::vector<double> turn = history[is_2d ? "turn" : "turn_y"];
    for (double& value : turn) value *= (is_2d ? 1 : -1) / degree;
    findings.push_back({.quantity = "metacentric height over height [-]",
                        .reference = stability,
                        .measured = stability,
                        .allowed = support::stated});
    const auto [lowest, highest] = std::minmax_element(turn.begin(), turn.end());
    findings.push_back({.quantity = "largest tilt [°]",
                        .reference = support::no_reference,
                        .measured = std::max(*highest, -*lowest),
                        .allowed = support::stated});
    findings.push_back({.quantity = "tilt, mean of the last quarter [°]",
                        .reference = stability > 0 ? 0 : support::no_reference,
                        .measured = support::mean_from(0.75 * t.back(), t, turn),
                        .allowed = support::stated,
                        .scale = std::abs(o.tilt)});
    const auto of_roll = fluid_cases::zero_crossings(t, turn);
    findings.push_back({.quantity = "period of the roll [s]",
                        .reference = support::no_reference,
                        .measured = fluid_cases::mean_period(of_roll, 1),
                        .allowed = support::stated});
  }
  return findings;
}

// A body closer to a wall than a spacing would be held there.
template <int Dim>
void require_inside(const Options& o, const mps::FloatingBody<Dim>& body) {
  Vec<Dim> upper = Vec<Dim>::Constant(o.thickness);
  upper[0] = o.length;
  upper[Dim - 1] = std::numeric_limits<double>::infinity();
  for (const auto& face : body.faces) {
    for (const auto& corner : face.corners) {
      if (corner.minCoeff() >= o.spacing && (upper - corner).minCoeff() >= o.spacing) continue;
      throw support::OptionError("the box has a corner at " + to_text(corner) +
                                 " m, less than a spacing from a wall of the tank, or beyond it; "
                                 "make the tank larger, or the box smaller");
    }
  }
}

template <int Dim>
void simulate(const Options& o) {
  auto tank = support::make_tank<mps::Recommended, Dim>(o);
  const auto body = make_body<Dim>(o);
  require_inside(o, body);
  support::or_reject([&] { return mps::remove_inside(tank.particles, body.faces, o.spacing); });
  support::set_moving<Dim>(tank.walls, {.bodies = {body}});
  const double volume = double(tank.particles.size()) * std::pow(o.spacing, Dim) +
                        o.draught() * o.width * (Dim == 3 ? o.breadth : 1);
  const double level = volume / (o.length * (Dim == 3 ? o.thickness : 1));

  auto settings = support::flow_settings<mps::Recommended, Dim>(o, o.depth);
  settings.walls = tank.walls;
  support::run_tank(
      o, tank.particles, settings,
      support::Study{"floating_body", names<Dim>(o), measure<Dim>(o),
                     [&](const support::History& history) { return evaluate(o, level, history); },
                     nlohmann::ordered_json{{"width", o.width},
                                            {"height", o.height},
                                            {"breadth", o.breadth},
                                            {"density_ratio", o.density_ratio},
                                            {"offset", o.offset},
                                            {"tilt", o.tilt},
                                            {"hold", o.hold}}});
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.length = 4;
  options.depth = 0.4;
  options.until = 2;
  options.out = "out/floating_body";
  CLI::App app("A box that floats in a tank", "floating_body");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    options.dimension == 2 ? simulate<2>(options) : simulate<3>(options);
  });
}
