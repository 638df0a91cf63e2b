// SPDX-License-Identifier: MIT
// A column of fine beads collapses in a viscous liquid, after L. Rondon, O. Pouliquen, P.
// Aussillous, "Granular collapse in a fluid: role of the initial volume fraction", Physics of
// Fluids 23 (2011) 073301: glass beads of 0.225 mm in a liquid 12 times as viscous as water, in a
// column 60 mm long and 42 or 48 mm high. They found that the packing decides. A loose column,
// which contracts when it is sheared, puts pressure on the liquid in its pores, which carries it:
// it runs out fast, and thinly. A dense one must first expand, which sucks at the liquid: it flows
// slowly, half as far.
//
//   submerged_collapse --out out/loose
//   submerged_collapse --dense --height 0.042 --until 6 --out out/dense
//   examples/plot_submerged_collapse.py out/loose
//
// Each grain stands for all beads in its volume, with their drag. The column leans on the wall x =
// 0; the floor is z = 0; y is periodic. What holds the column is taken away at t = 0.
#include <silt/coupled.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/geometry/shapes.hpp>

#include "support/command_line.hpp"
#include "support/coupled_program.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

struct Options : support::CoupledOptions {
  double bead = 225e-6;            // diameter of the beads [m]
  double liquid = 1010;            // density of the liquid [kg/m³]
  double length = 0.06;            // of the column [m]
  double height = 0.048;           // of the column [m]
  double thickness = 0.0315;       // of the slice, along y [m]
  double tank = 0.27;              // length of the tank [m]
  double depth = 0.09;             // of the liquid [m]
  double rolling_friction = 0.05;  // of grains [-]
  bool dense = false;              // whether they settle without friction before

  double friction_of_packing() const { return dense ? 0.05 : 1; }  // angle [rad]
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  app.add_flag("--dense", o.dense, "the column is packed densely, not loosely");
  add_option(app, "--bead", o.bead, "diameter of the beads for which a grain stands [m]",
             positive());
  add_option(app, "--liquid", o.liquid, "density of the liquid [kg/m3]", positive());
  add_option(app, "--length", o.length, "of the column [m]", positive());
  add_option(app, "--height", o.height, "of the column, about [m]", positive());
  add_option(app, "--thickness", o.thickness, "of the periodic slice [m]", positive());
  add_option(app, "--tank", o.tank, "length of the tank [m]", positive());
  add_option(app, "--depth", o.depth, "of the liquid [m]", positive());
  add_option(app, "--rolling-friction", o.rolling_friction, "of grains", between({0, 2}));
  support::describe_coupled(app, o, "submerged_collapse.csv, frames.pvd and summary.json");
}

/// The drag of all beads in the volume of a grain.
struct DragOfBeads {
  static constexpr int dimension = 3;
  double bead;  ///< diameter [m]

  double coefficient(coupled::GrainInFluid at) const {
    const double ratio = at.diameter / bead;
    at.diameter = bead;
    return ratio * ratio * ratio * coupled::GidaspowDrag{}.coefficient(at);
  }
};

Box<3> box(const Options& o) {
  Box<3> box{.lower = {-0.02, 0, -0.02}, .upper = {o.tank + 0.02, o.thickness, 4 * o.depth}};
  box.periodic[1] = true;
  return box;
}
dem::BoxWall<3> walls(double length) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {{.lower = {0, -infinity, 0}, .upper = {length, infinity, infinity}}};
}

// The column at rest, in air: the more friction it settles with, the looser it is.
coupled::GrainsInFluid<3> column(const Options& o) {
  coupled::GrainsInFluid<3> grains{box(o)};
  const double d = o.diameter, fraction = o.dense ? 0.62 : 0.55;
  const auto count = [&](double size) {
    return Index(std::max(1.0, std::floor(size / (1.12 * d))));
  };
  const Index along = count(o.length), across = count(o.thickness);
  const double volume = fraction * o.length * o.thickness * o.height;
  double solid = 0;
  while (solid < volume) {
    const Index k = grains.size();
    Random random{.seed = 1, .id = k};
    const Vec<3> x((double(k % along) + 0.5) * o.length / double(along),
                   (double(k / along % across) + 0.5) * o.thickness / double(across),
                   (double(k / (along * across)) + 0.6) * 1.15 * d);
    const Vec<3> shift(random.uniform({-1, 1}), random.uniform({-1, 1}), random.uniform({-1, 1}));
    const double R = d / 2 * random.uniform({0.9, 1.0});
    dem::add_grain(grains, Vec<3>(x + 0.05 * d * shift), {.radius = R, .density = o.density});
    solid += dem::volume_of<3>(R);
  }
  auto law = support::law_of<3>(o);
  law.friction_angle = o.friction_of_packing();
  Simulation dry{std::move(grains), NeighbourList<3>{},
                 Forces{dem::Contacts{law, walls(o.length)}, Gravity<3>{Vec<3>(0, 0, -support::g)}},
                 Leapfrog{GlobalDamping{.alpha = 30}}};
  dry.run({.until = 0.8});
  coupled::GrainsInFluid<3> settled{box(o)};
  const auto found = dry.snapshot();
  for (Index k = 0; k < found.size(); ++k) {
    dem::add_grain(settled, found[position][k], {.radius = found[radius][k], .density = o.density});
  }
  return settled;
}

// Within the lower 70 % of the column.
double packing_fraction(const Options& o, const coupled::GrainsInFluid<3>& grains) {
  double solid = 0;
  const double top = 0.7 * o.height;
  for (Index k = 0; k < grains.size(); ++k) {
    if (grains[position][k][2] < top) solid += dem::volume_of<3>(grains[radius][k]);
  }
  return solid / (top * o.length * o.thickness);
}

// p + ρ g z at the floor around a place, the mean over five spacings [Pa].
double piezometric(const Options& o, const auto& water, double place) {
  double sum = 0, number = 0;
  for (Index i = 0; i < water.size(); ++i) {
    const auto x = water[position][i];
    if (std::abs(x[0] - place) > 2.5 * o.spacing || x[2] > 1.5 * o.spacing) continue;
    sum += water[mps::pressure][i] + o.liquid * support::g * x[2];
    number += 1;
  }
  return number > 0 ? sum / number : 0;
}

// The front, without single grains that roll before it; the height at the wall; and the pressure in
// the pores of the column over that in the still liquid.
std::vector<double> measure(const Options& o, const auto& both) {
  const auto& grains = both.grains().particles();
  std::vector<double> places, heights;
  for (const auto& x : grains[position]) {
    places.push_back(x[0]);
    if (x[0] < o.length / 3) heights.push_back(x[2]);
  }
  const auto high = [](std::vector<double>& values) {
    const auto at = values.begin() + std::ptrdiff_t(0.99 * double(values.size()));
    std::nth_element(values.begin(), at, values.end());
    return *at;
  };
  const auto& water = both.fluid().particles();
  const double excess =
      piezometric(o, water, o.length / 3) - piezometric(o, water, o.tank - 4 * o.spacing);
  return {high(places) + o.diameter / 2, high(heights) + o.diameter / 2, excess};
}

std::vector<support::Finding> evaluate(const Options& o, double fraction,
                                       const support::History& history) {
  const auto &t = history["t"], &front = history["front"], &excess = history["excess_pressure"];
  const double runout = front.back() - o.length;
  const auto almost =
      std::ranges::find_if(front, [&](double x) { return x - o.length > 0.95 * runout; });
  // Of the first half of the collapse: shear begins it.
  double sum = 0, duration = 0;
  for (std::size_t k = 1; k < t.size() && front[k] - o.length < runout / 2; ++k) {
    sum += excess[k] * (t[k] - t[k - 1]);
    duration += t[k] - t[k - 1];
  }
  const auto finding = [](const std::string& name, double reference, double value) {
    return support::Finding{.quantity = name,
                            .reference = reference,
                            .measured = value,
                            .allowed = support::stated,
                            .scale = 1};
  };
  return {finding("volume fraction of the column [-]", o.dense ? 0.60 : 0.55, fraction),
          finding("run-out over its length [-]", support::no_reference, runout / o.length),
          finding("time of 95 % of it [s]", support::no_reference,
                  t[std::size_t(almost - front.begin())]),
          finding("height at the wall [m]", support::no_reference, history["height"].back()),
          finding("mean excess pressure in the pores, to half of it [Pa]", support::no_reference,
                  duration > 0 ? sum / duration : 0)};
}

void simulate(const Options& o) {
  auto settings = support::mixture_settings<3>(o, o.depth);
  settings.density = o.liquid;
  settings.speed_scale = 0.3;
  Box<3> tank{.lower = Vec<3>::Zero(), .upper = {o.tank, o.thickness, 2 * o.depth}};
  tank.periodic[1] = true;
  settings.walls.triangles = faces_of(tank, Sides<3>::open());
  auto grains = column(o);
  mps::FluidInMixture<3> water{box(o)};
  for (const auto& x :
       lattice<3>({Vec<3>::Zero(), Vec<3>(o.tank, o.thickness, o.depth)}, o.spacing)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  support::or_reject([&] { return coupled::make_room(water, grains, {.spacing = o.spacing}); });
  const double fraction = packing_fraction(o, grains);
  const dem::Law law{
      dem::LinearSpringDashpot{.normal_stiffness = o.stiffness, .restitution = o.restitution},
      dem::LinearFriction{.tangential_stiffness = o.stiffness * 2 / 7,
                          .friction_angle = o.friction_angle * std::numbers::pi / 180},
      dem::RollingResistance{.rolling_friction = o.rolling_friction}};
  auto both = support::couple<3>(o, std::move(grains), std::move(water), settings,
                                 dem::Contacts{law, walls(o.tank)}, DragOfBeads{o.bead});
  if (!o.resume.is_requested()) {
    support::or_reject(
        [&] { return both.let_fluid_settle({.tolerance = 1e-3, .max_steps = 100}); });
  }
  const auto row = [&](const auto& simulation) { return measure(o, simulation); };
  support::run_coupled(
      o, both,
      support::Study{
          "submerged_collapse",
          {"front", "height", "excess_pressure"},
          row,
          [&](const support::History& history) { return evaluate(o, fraction, history); },
          nlohmann::ordered_json{{"bead", o.bead},
                                 {"liquid", o.liquid},
                                 {"length", o.length},
                                 {"height", o.height},
                                 {"thickness", o.thickness},
                                 {"tank", o.tank},
                                 {"depth", o.depth},
                                 {"rolling_friction", o.rolling_friction},
                                 {"dense", o.dense}}});
}

void check(const Options& o) {
  support::require_spheres(o);
  support::require_small_grains(o);
  const double least = 6.3 * o.spacing;
  if (o.thickness < least) {
    throw support::OptionError("--thickness " + to_text(o.thickness) +
                               " is too small for a periodic slice; give " + to_text(least) +
                               " or more");
  }
  if (o.length + 10 * o.spacing > o.tank || o.height > o.depth) {
    throw support::OptionError("the column does not fit into --tank " + to_text(o.tank) +
                               " and --depth " + to_text(o.depth) + "; make it smaller");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.dimension = 3;
  options.spacing = 0.0045;
  options.diameter = 0.003;
  options.density = 2500;
  options.stiffness = 300;
  options.restitution = 0.3;
  options.friction_angle = 26.6;
  options.viscosity = 1.2e-5;
  options.until = 2;
  options.output_every = 0.05;
  options.out = "out/submerged_collapse";
  CLI::App app("A column of beads that collapses in a viscous liquid", "submerged_collapse");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    simulate(options);
  });
}
