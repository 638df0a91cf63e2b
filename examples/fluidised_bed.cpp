// SPDX-License-Identifier: MIT
// Water rises through a packed bed of spheres, faster and faster, until it carries them. The
// pressure drop over the packed bed is compared with S. Ergun, "Fluid flow through packed columns",
// Chemical Engineering Progress 48 (1952) 89–94, at the measured ε,
//
//   Δp/Δz = 150 (1 − ε)² μ U/(ε³ d²) + 1.75 (1 − ε) ρ U²/(ε³ d),
//
// the speed at which the bed is fluidised with that at which this is its buoyant weight, and with
// the fit of C.Y. Wen, Y.H. Yu, "A generalized method for predicting the minimum fluidization
// velocity", AIChE Journal 12 (1966) 610–612: Re = √(33.7² + 0.0408 Ar) − 33.7.
//
//   fluidised_bed --out out/fluidised_bed
//   examples/plot_fluidised_bed.py out/fluidised_bed
//
// U is the superficial velocity. Water enters through all of the floor, z = 0; grains lie on a grid
// two spacings above it, which the water does not feel.
#include <silt/coupled.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps/setup/inflow.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/coupled_program.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

constexpr double rho = 1000;  // of water [kg/m³]

struct Options : support::CoupledOptions {
  double width = 0.15;   // of the tank [m]
  double bed = 0.2;      // height of the bed [m]
  double depth = 0.35;   // of the water in the beginning [m]
  double fastest = 1.5;  // U in the end, over that of fluidisation by Ergun at ε = 0.4 [-]

  double grid() const { return 2 * spacing; }   // height [m]
  double ramp() const { return 0.8 * until; }   // [s]
  double begin() const { return 0.1 * until; }  // of the flow [s]
  double viscosity_of_water() const { return rho * viscosity; }
  double weight(double fluid_fraction) const {  // buoyant, per volume of the bed [N/m³]
    return (1 - fluid_fraction) * (density - rho) * support::g;
  }
  // Ergun [Pa/m].
  double drop(double fluid_fraction, double U) const {
    const double e = fluid_fraction, solid = 1 - e, cube = e * e * e;
    return 150 * solid * solid * viscosity_of_water() * U / (cube * diameter * diameter) +
           1.75 * solid * rho * U * U / (cube * diameter);
  }
  // U at which the drop carries the bed [m/s].
  double fluidisation(double fluid_fraction) const {
    const double a = drop(fluid_fraction, 1), linear = (4 * drop(fluid_fraction, 0.5) - a);
    const double square = a - linear;
    return (std::sqrt(linear * linear + 4 * square * weight(fluid_fraction)) - linear) /
           (2 * square);
  }
  double fluidisation_of_wen_yu() const {
    const double archimedes = rho * (density - rho) * support::g * diameter * diameter * diameter /
                              (viscosity_of_water() * viscosity_of_water());
    return (std::sqrt(33.7 * 33.7 + 0.0408 * archimedes) - 33.7) * viscosity / diameter;
  }
  double speed() const { return fastest * fluidisation(0.4); }
  double height() const { return depth + speed() * until + 6 * spacing; }  // of the tank [m]
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  add_option(app, "--width", o.width, "of the tank [m], a whole number of spacings", positive());
  add_option(app, "--bed", o.bed, "height of the bed [m]", positive());
  add_option(app, "--depth", o.depth, "of the water in the beginning [m]", positive());
  add_option(app, "--fastest", o.fastest,
             "superficial velocity in the end, over that of fluidisation by Ergun at "
             "a porosity of 0.4",
             between({0.1, 3}));
  support::describe_coupled(app, o, "fluidised_bed.csv, frames.pvd and summary.json");
}

Box<3> box(const Options& o) {
  return {.lower = Vec<3>::Constant(-0.1),
          .upper = {o.width + 0.1, o.width + 0.1, o.height() + 0.1}};
}

// At rest, without water.
coupled::GrainsInFluid<3> packed_bed(const Options& o) {
  coupled::GrainsInFluid<3> grains{box(o)};
  const Index across = Index(std::floor(o.width / (1.02 * o.diameter)));
  const double pitch = o.width / double(across);
  // As many as the bed has in the end, within a few percent.
  constexpr double solid_fraction = 0.6;
  const double number =
      solid_fraction * o.width * o.width * o.bed / dem::volume_of<3>(o.diameter / 2);
  double shift = 0;
  for (Index k = 0; k < Index(number); ++k) {
    const auto random = [&] {
      shift = std::fmod(shift + std::numbers::phi, 1.0);
      return 0.1 * o.diameter * (shift - 0.5);
    };
    const Vec<3> x((double(k % across) + 0.5) * pitch, (double(k / across % across) + 0.5) * pitch,
                   o.grid() + (double(k / (across * across)) + 0.5) * 1.1 * o.diameter);
    dem::add_grain(grains, Vec<3>(x + Vec<3>(random(), random(), 0)),
                   {.radius = o.diameter / 2, .density = o.density});
  }
  Simulation dry{std::move(grains), NeighbourList<3>{},
                 Forces{support::contacts_in_tank(o, o.width, o.grid()),
                        Gravity<3>{Vec<3>(0, 0, -support::g)}},
                 Leapfrog{GlobalDamping{.alpha = 20}}};
  dry.run({.until = 1});
  auto settled = dry.snapshot();
  for (auto&& v : settled[velocity]) v.setZero();
  return settled;
}

// Of a sphere, below a plane at a height above its centre [m³].
double volume_below(double height, double R) {
  const double h = std::clamp(height, -R, R);
  return std::numbers::pi * (2 * R * R * R / 3 + R * R * h - h * h * h / 3);
}

// The piezometric pressure p + ρ g z below and above the bed, the same over the middle of the bed,
// per length, and what is there.
std::vector<double> measure(const Options& o, double area, const mps::Inflow<3>& inflow,
                            const auto& both) {
  const auto grains = both.grains().snapshot();
  std::vector<double> heights;
  for (const auto& x : grains[position]) heights.push_back(x[2]);
  const auto high = heights.begin() + std::ptrdiff_t(0.95 * double(heights.size()));
  std::nth_element(heights.begin(), high, heights.end());
  const double top = *high, low = o.grid() + 0.2 * o.bed, middle = o.grid() + 0.7 * o.bed;

  const auto& water = both.fluid().particles();
  const auto x = water[position];
  const auto p = water[mps::pressure];
  double surface = 0;
  for (Index i = 0; i < water.size(); ++i) surface = std::max(surface, double(x[i][2]));
  struct Mean {
    double sum = 0, count = 0;
    void add(double value) { sum += value, count += 1; }
    double value() const { return count > 0 ? sum / count : 0; }
  } below, above, z_in_bed, p_in_bed;
  double zz = 0, zp = 0;
  for (Index i = 0; i < water.size(); ++i) {
    const double z = x[i][2], piezometric = p[i] + rho * support::g * z;
    if (z < o.grid()) below.add(piezometric);
    if (z > top + 2 * o.spacing && z < surface - 3 * o.spacing) above.add(piezometric);
    if (z < low || z > middle) continue;
    z_in_bed.add(z), p_in_bed.add(piezometric);
    zz += z * z, zp += z * piezometric;
  }
  const double n = z_in_bed.count, z_mean = z_in_bed.value(), p_mean = p_in_bed.value();
  const double slope = -(zp / n - z_mean * p_mean) / (zz / n - z_mean * z_mean);
  double solid = 0;
  for (const double z : heights) {
    solid += volume_below(middle - z, o.diameter / 2) - volume_below(low - z, o.diameter / 2);
  }
  const double fluid_fraction = 1 - solid / (area * (middle - low));
  return {inflow.flow_at(both.time()) / area, slope, fluid_fraction, below.value() - above.value(),
          top + o.diameter / 2 - o.grid()};
}

std::vector<support::Finding> evaluate(const Options& o, double weight,
                                       const support::History& history) {
  const auto &t = history["t"], &U = history["velocity"], &slope = history["slope"],
             &porosity = history["fluid_fraction"], &drop = history["drop"];
  const double expected = o.fluidisation(0.4);
  // Of the packed bed, where inertia has no part.
  double measured = 0, by_ergun = 0, of_packing = 0, count = 0;
  // Least squares of Δp = a U + b U².
  double uu = 0, uuu = 0, uuuu = 0, up = 0, uup = 0;
  double plateau = 0, fluidised = 0;
  for (std::size_t k = 0; k < t.size(); ++k) {
    const double u = U[k], share = u / expected;
    if (share > 0.3 && share < 0.8) {
      measured += slope[k];
      by_ergun += o.drop(porosity[k], u);
      of_packing += porosity[k];
      count += 1;
      uu += u * u, uuu += u * u * u, uuuu += u * u * u * u;
      up += u * drop[k], uup += u * u * drop[k];
    }
    if (share > 1.25) plateau += drop[k], fluidised += 1;
  }
  const double determinant = uu * uuuu - uuu * uuu;
  const double a = (up * uuuu - uup * uuu) / determinant, b = (uup * uu - up * uuu) / determinant;
  const double found = (std::sqrt(a * a + 4 * b * weight) - a) / (2 * b);
  const double fraction = of_packing / count;
  return {{.quantity = "pressure drop of the packed bed over Ergun's [-]",
           .reference = 1,
           .measured = measured / by_ergun,
           .allowed = 0.05},
          {.quantity = "fluid fraction of the packed bed [-]",
           .reference = support::no_reference,
           .measured = fraction,
           .allowed = support::stated,
           .scale = 1},
          {.quantity = "velocity of fluidisation, by Ergun [m/s]",
           .reference = o.fluidisation(fraction),
           .measured = found,
           .allowed = 0.05},
          {.quantity = "the same by Wen and Yu [m/s]",
           .reference = o.fluidisation_of_wen_yu(),
           .measured = found,
           .allowed = support::stated},
          {.quantity = "pressure drop of the fluidised bed over its weight [-]",
           .reference = 1,
           .measured = plateau / fluidised / weight,
           .allowed = 0.05}};
}

void simulate(const Options& o) {
  const Box<3> tank{.lower = Vec<3>::Zero(), .upper = {o.width, o.width, o.height()}};
  auto settings = support::mixture_settings<3>(o, o.depth);
  auto sides = Sides<3>::open();
  sides.lower[2] = false;
  settings.walls.triangles = faces_of(tank, sides);
  Sides<3> floor{};
  floor.lower[2] = true;
  const mps::Inflow<3> inflow = support::or_reject([&] {
    return mps::Inflow<3>{{.faces = faces_of(tank, floor),
                           .velocity = {0, 0, o.speed()},
                           .spacing = o.spacing,
                           .from = o.begin(),
                           .ramp = o.ramp()}};
  });
  settings.walls.moving_3d = mps::MovingWalls<3>{.faces = {inflow.piston()}};

  auto grains = packed_bed(o);
  mps::FluidInMixture<3> water{box(o)};
  for (const auto& x : lattice<3>({Vec<3>::Zero(), Vec<3>(o.width, o.width, o.depth)}, o.spacing)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  support::or_reject([&] { return coupled::make_room(water, grains, {.spacing = o.spacing}); });
  const double area = o.width * o.width;
  const double weight = double(grains.size()) * dem::volume_of<3>(o.diameter / 2) *
                        (o.density - rho) * support::g / area;
  auto both =
      support::couple<3>(o, std::move(grains), std::move(water), settings,
                         support::contacts_in_tank(o, o.width, o.grid()), coupled::GidaspowDrag{});
  if (!o.resume.is_requested()) {
    support::or_reject([&] { return both.let_fluid_settle({.max_steps = 30}); });
  }
  coupled::OfFluid entering{inflow};
  const auto row = [&](const auto& simulation) { return measure(o, area, inflow, simulation); };
  support::run_coupled(
      o, both,
      support::Study{"fluidised_bed",
                     {"velocity", "slope", "fluid_fraction", "drop", "height"},
                     row,
                     [&](const support::History& history) { return evaluate(o, weight, history); },
                     nlohmann::ordered_json{{"width", o.width},
                                            {"thickness", o.width},
                                            {"bed", o.bed},
                                            {"depth", o.depth},
                                            {"fastest", o.fastest},
                                            {"weight_per_area", weight}}},
      entering);
}

void check(const Options& o) {
  if (o.dimension == 2) {
    throw support::OptionError("--dimension 2: Ergun's law is one of spheres; leave it out");
  }
  support::require_small_grains(o);
  if (o.depth < o.grid() + 1.2 * o.bed + 6 * o.spacing) {
    throw support::OptionError("--depth " + to_text(o.depth) + " does not cover the bed; give " +
                               to_text(o.grid() + 1.2 * o.bed + 6 * o.spacing) + " or more");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.0125;
  options.dimension = 3;
  options.until = 6;
  options.density = 2500;
  options.stiffness = 1000;
  options.friction_angle = 15;
  options.output_every = 0.1;
  options.out = "out/fluidised_bed";
  CLI::App app("Water that rises through a bed of spheres", "fluidised_bed");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    simulate(options);
  });
}
