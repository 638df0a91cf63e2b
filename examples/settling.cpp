// SPDX-License-Identifier: MIT
// Spheres settle in a tank of water: a single one, whose speed is compared with its drag law, or a
// suspension, which settles more slowly. Its speed is compared with J.F. Richardson, W.N. Zaki,
// "Sedimentation and fluidisation: part I", Transactions of the Institution of Chemical Engineers
// 32 (1954) 35–53: v = v_t ε^n, where v_t and its Reynolds number Re are those of a single sphere,
// and
//
//   n = 4.65 for Re < 0.2, 4.35 Re^−0.03 < 1, 4.45 Re^−0.1 < 500, and 2.39 above.
//
//   settling --out out/settling
//   settling --fraction 0.3 --viscosity 1e-6 --density 1500 --until 0.5 --out out/fast
//   settling --fraction 0 --viscosity 2e-5 --width 0.2 --depth 0.4 --out out/single
//   examples/plot_settling.py out/settling
//
// At small Re, the walls of the tank slow down a single sphere and a thin suspension.
#include <silt/coupled.hpp>
#include <silt/geometry/shapes.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/coupled_program.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double rho = 1000;  // of water [kg/m³]
using Drag = coupled::DiFelice;

struct Options : support::CoupledOptions {
  double fraction = 0.2;  // of the volume that is spheres; 0: one sphere [-]
  double width = 0.16;    // of the tank [m]
  double depth = 0.32;    // of the mixture [m]

  double volume() const { return dem::volume_of<3>(diameter / 2); }
  bool is_single() const { return fraction == 0; }
  // Terminal velocity of a single sphere [m/s], positive if it sinks.
  double terminal() const {
    const double weight = volume() * (density - rho) * support::g;
    double speed = 0;
    for (int k = 0; k < 200; ++k) {
      const double beta = Drag::coefficient({.diameter = diameter,
                                             .fluid_fraction = 1,
                                             .speed = speed,
                                             .density = rho,
                                             .viscosity = rho * viscosity});
      speed = (speed + std::abs(weight) / beta) / 2;
    }
    return std::copysign(speed, weight);
  }
  double reynolds() const { return std::abs(terminal()) * diameter / viscosity; }
  double exponent() const {
    const double re = reynolds();
    return re < 0.2   ? 4.65
           : re < 1   ? 4.35 * std::pow(re, -0.03)
           : re < 500 ? 4.45 * std::pow(re, -0.1)
                      : 2.39;
  }
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  add_option(app, "--fraction", o.fraction, "of the volume that is spheres; 0: a single one",
             between({0, 0.5}));
  add_option(app, "--width", o.width, "of the tank [m], a whole number of spacings", positive());
  add_option(app, "--depth", o.depth, "of the water [m], a whole number of spacings", positive());
  support::describe_coupled(app, o, "settling.csv, frames.pvd and summary.json");
}

Box<3> box(const Options& o) {
  return {.lower = Vec<3>::Constant(-0.1),
          .upper = {o.width + 0.1, o.width + 0.1, 2 * o.depth + 0.1}};
}

// On a lattice that is not quite regular, or one near the surface, or the floor if it rises.
coupled::GrainsInFluid<3> spheres(const Options& o) {
  coupled::GrainsInFluid<3> grains{box(o)};
  const dem::Grain sphere{.radius = o.diameter / 2, .density = o.density};
  if (o.is_single()) {
    const double height = (o.density > rho ? 0.85 : 0.15) * o.depth;
    dem::add_grain(grains, Vec<3>(0.53 * o.width, 0.53 * o.width, height), sphere);
    return grains;
  }
  const Index number = Index(o.fraction * o.width * o.width * o.depth / o.volume());
  const Index across = Index(std::round(o.width / std::cbrt(o.volume() / o.fraction)));
  const Index layers = (number + across * across - 1) / (across * across);
  double shift = 0;
  const auto part = [&](Index of, Index count, double length) {
    shift = std::fmod(shift + 0.618034, 1.0);
    const double gap = std::max(0.0, length / double(count) - 1.05 * o.diameter);
    return (double(of) + 0.5) * length / double(count) + gap * (shift - 0.5);
  };
  for (Index k = 0; k < number; ++k) {
    const double x = part(k % across, across, o.width);
    const double y = part(k / across % across, across, o.width);
    const double z = part(k / (across * across), layers, o.depth);
    dem::add_grain(grains, Vec<3>(x, y, z), sphere);
  }
  return grains;
}

// Mean speed of the spheres, downwards, and ε around them; of a suspension those in the middle.
std::vector<double> measure(const Options& o, const auto& both) {
  const auto grains = both.grains().snapshot();
  const auto x = grains[position];
  double speed = 0, fraction = 0, height = 0, count = 0;
  for (Index k = 0; k < grains.size(); ++k) {
    height += x[k][2] / double(grains.size());
    if (!o.is_single() && std::abs(x[k][2] - o.depth / 2) > o.depth / 4) continue;
    speed -= grains[velocity][k][2];
    fraction += grains[coupled::fluid_share][k];
    count += 1;
  }
  return {speed / count, fraction / count, height};
}

std::vector<support::Finding> evaluate(const Options& o, const support::History& history) {
  const auto& t = history["t"];
  const double from = 0.5 * t.back(), terminal = o.terminal();
  const double speed = support::mean_from(from, t, history["speed"]);
  const support::Finding reynolds{.quantity = "Reynolds number of a single sphere [-]",
                                  .reference = support::no_reference,
                                  .measured = o.reynolds(),
                                  .allowed = support::stated,
                                  .scale = 1};
  if (o.is_single()) {
    return {reynolds,
            {.quantity = "speed of the sphere [m/s]",
             .reference = terminal,
             .measured = speed,
             .allowed = 0.05}};
  }
  const double fraction = support::mean_from(from, t, history["fluid_fraction"]);
  return {reynolds,
          {.quantity = "speed of the suspension [m/s]",
           .reference = terminal * std::pow(fraction, o.exponent()),
           .measured = speed,
           .allowed = support::stated},
          {.quantity = "exponent of the fluid fraction [-]",
           .reference = o.exponent(),
           .measured = std::log(speed / terminal) / std::log(fraction),
           .allowed = 0.1}};
}

void simulate(const Options& o) {
  auto settings = support::mixture_settings<3>(o, o.depth);
  settings.walls.triangles =
      faces_of(Box<3>{Vec<3>::Zero(), Vec<3>(o.width, o.width, 2 * o.depth)}, Sides<3>::open());
  auto grains = spheres(o);
  mps::FluidInMixture<3> water{box(o)};
  for (const auto& x : lattice<3>({Vec<3>::Zero(), Vec<3>(o.width, o.width, o.depth)}, o.spacing)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  support::or_reject([&] { return coupled::make_room(water, grains, {.spacing = o.spacing}); });
  auto both = support::couple<3>(o, std::move(grains), std::move(water), settings,
                                 support::contacts_in_tank(o, o.width), Drag{});
  if (!o.resume.is_requested()) {
    support::or_reject([&] { return both.let_fluid_settle(); });
  }
  const auto row = [&](const auto& simulation) { return measure(o, simulation); };
  support::run_coupled(
      o, both,
      support::Study{"settling",
                     {"speed", "fluid_fraction", "height"},
                     row,
                     [&](const support::History& history) { return evaluate(o, history); },
                     nlohmann::ordered_json{{"fraction", o.fraction},
                                            {"width", o.width},
                                            {"thickness", o.width},
                                            {"depth", o.depth},
                                            {"terminal", o.terminal()}}});
}

void check(const Options& o) {
  support::require_spheres(o);
  support::require_small_grains(o);
  if (o.density == rho) {
    throw support::OptionError("--density " + to_text(o.density) +
                               ": spheres of the density of water do not settle");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.02;
  options.dimension = 3;
  options.until = 1;
  options.density = 1100;
  options.viscosity = 1e-3;
  options.stiffness = 200;
  options.friction_angle = 0;
  options.output_every = 0.05;
  options.out = "out/settling";
  CLI::App app("Spheres that settle in water", "settling");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    simulate(options);
  });
}
