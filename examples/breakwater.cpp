// SPDX-License-Identifier: MIT
// Waves of a piston meet a breakwater of stones. The height of the waves behind it over that before
// it is compared with K. d'Angremond, J.W. van der Meer, R.J. de Jong, "Wave transmission at
// low-crested structures", Proceedings of the 25th International Conference on Coastal Engineering
// (1996) 2418–2427, for permeable structures,
//
//   Kt = −0.4 Rc/H + 0.64 (B/H)^−0.31 (1 − e^{−ξ/2}) from 0.075 to 0.8,   ξ = tan α/√(2π H/(g T²))
//
// with the height Rc of the crest above the still water, its width B, and the slope α. It is a fit
// to tests with irregular waves of the significant height H, where B/H < 10.
//
//   breakwater --out out/breakwater
//   breakwater --height 0.24 --out out/high
//   examples/plot_breakwater.py out/breakwater
//
// The piston is at x = 0, the floor at z = 0. All is periodic along y, across the flume. Behind the
// breakwater, a sponge absorbs the waves.
#include <silt/coupled.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/dem/wall/plane.hpp>
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/coupled_program.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"
#include "support/sponge.hpp"
#include "support/water_waves.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace silt;

struct Scheme : mps::Recommended {
  support::Sponge friction{};
};
using InMixture = mps::InMixture<Scheme>;

struct Options : support::CoupledOptions {
  double depth = 0.2;             // of the water [m]
  double thickness = 0.175;       // of the slice of the flume, along y [m]
  double stroke = 0.04;           // of the piston [m]
  double period = 1;              // T of the waves [s]
  double height = 0.2;            // of the breakwater [m]
  double crest = 0.1;             // B of the breakwater [m]
  double cotangent = 1.5;         // of its slopes [-]
  double rolling_friction = 0.3;  // of the stones [-]

  support::LinearWave wave() const { return {.period = period, .depth = depth}; }
  // Three depths from the piston, whose evanescent waves are gone there, and two from the heel.
  std::vector<double> gauges() const {
    auto x = support::gauges_from(3 * depth, wave().length());
    for (const double behind : support::gauges_from(heel() + 2 * depth, wave().length())) {
      x.push_back(behind);
    }
    return x;
  }
  double toe() const { return 4.5 * depth + 0.45 * wave().length(); }  // x [m]
  double middle() const { return toe() + cotangent * height + crest / 2; }
  double heel() const { return toe() + 2 * cotangent * height + crest; }
  double sponge() const { return gauges().back() + depth; }
  double length() const {  // of the flume, in whole spacings [m]
    return std::ceil((sponge() + wave().length()) / spacing) * spacing;
  }
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive, support::between;
  add_option(app, "--depth", o.depth, "of the water [m], a whole number of spacings", positive());
  add_option(app, "--thickness", o.thickness,
             "of the slice of the flume, along y [m], a whole number of spacings", positive());
  add_option(app, "--stroke", o.stroke, "whole way of the piston [m]", positive());
  add_option(app, "--period", o.period, "of the waves [s]", positive());
  add_option(app, "--height", o.height, "of the breakwater [m]", positive());
  add_option(app, "--crest", o.crest, "width of its crest [m]", positive());
  add_option(app, "--cotangent", o.cotangent, "of its slopes", between({1, 10}));
  add_option(app, "--rolling-friction", o.rolling_friction, "of the stones", between({0, 1}));
  support::describe_coupled(app, o, "breakwater.csv, frames.pvd and summary.json");
}

// --- the flume -----------------------------------------------------------------------------------

Box<3> box(const Options& o) {
  Box<3> box{.lower = {-o.stroke - 4 * o.spacing, 0, -4 * o.spacing},
             .upper = {o.length() + 4 * o.spacing, o.thickness, 4 * o.depth + o.height}};
  box.periodic[1] = true;
  return box;
}

// The flume goes on behind the piston, which is a wall without thickness.
mps::ImageWalls walls_of(const Options& o) {
  Box<3> flume = box(o);
  flume.lower[0] = 0;
  flume.lower[2] = 0;
  flume.upper[0] = o.length();
  flume.upper[2] = 2 * o.depth + o.height;
  mps::ImageWalls walls;
  Sides<3> left{};
  left.lower[0] = true;
  const support::WaveMakerShift shift{.stroke = o.stroke, .period = o.period};
  walls.moving_3d = mps::MovingWalls<3>{
      .faces = {{.faces = faces_of(flume, left), .motion = MotionFunction<3>{[=](double t) {
                                                   return Pose<3>{.shift = {shift(t), 0, 0}};
                                                 }}}}};
  flume.lower[0] = box(o).lower[0];
  auto sides = Sides<3>::open();
  sides.lower[0] = false;
  walls.triangles = faces_of(flume, sides);
  return walls;
}

// Stones are no spheres: they resist rolling.
auto law_of(const Options& o) {
  return dem::Law{
      dem::LinearSpringDashpot{.normal_stiffness = o.stiffness, .restitution = o.restitution},
      dem::LinearFriction{.tangential_stiffness = o.stiffness * 2 / 7,
                          .friction_angle = o.friction_angle * std::numbers::pi / 180},
      dem::RollingResistance{.rolling_friction = o.rolling_friction,
                             .twisting_friction = o.rolling_friction}};
}

// The same stones at rest in air, numbered anew.
template <class Wall>
coupled::GrainsInFluid<3> settled(const coupled::GrainsInFluid<3>& stones, const Options& o,
                                  const Wall& wall) {
  Simulation dry{stones, NeighbourList<3>{},
                 Forces{dem::Contacts{law_of(o), wall}, Gravity<3>{Vec<3>(0, 0, -support::g)}},
                 Leapfrog{GlobalDamping{.alpha = 20}}};
  dry.run({.until = 0.8});
  coupled::GrainsInFluid<3> at_rest{box(o)};
  const auto now = dry.snapshot();
  for (const auto& x : now[position]) {
    dem::add_grain(at_rest, x, {.radius = o.diameter / 2, .density = o.density});
  }
  return at_rest;
}

// Cut out of a bed that has settled between upright walls.
coupled::GrainsInFluid<3> breakwater(const Options& o) {
  Box<3> pit = box(o);
  pit.lower[0] = o.toe();
  pit.lower[2] = 0;
  pit.upper[0] = o.heel();
  pit.upper[2] = std::numeric_limits<double>::infinity();
  constexpr double looseness = 1.08, shrinks = 1.4;
  const double pitch = looseness * o.diameter;
  const auto count = [&](double size) { return std::max(1, int(std::floor(size / pitch))); };
  std::mt19937 random(1);
  const auto jitter = [&] {
    return (looseness - 1) / 2 * o.diameter * (2 * double(random()) / double(random.max()) - 1);
  };
  coupled::GrainsInFluid<3> bed{box(o)};
  const int columns = count(o.heel() - o.toe()), rows = count(o.thickness);
  for (int k = 0; k < count(shrinks * o.height); ++k) {
    for (int i = 0; i < columns; ++i) {
      for (int j = 0; j < rows; ++j) {
        const Vec<3> x(o.toe() + (i + 0.5) * (o.heel() - o.toe()) / columns + jitter(),
                       (j + 0.5) * o.thickness / rows + jitter(), (k + 0.5) * pitch + jitter());
        dem::add_grain(bed, x, {.radius = o.diameter / 2, .density = o.density});
      }
    }
  }
  auto stones = settled(bed, o, dem::BoxWall<3>{.box = pit});
  const auto x = stones[position];
  stones.remove_if([&](Index k) {
    const double from_crest = std::abs(x[k][0] - o.middle()) - o.crest / 2;
    return x[k][2] > o.height - std::max(0.0, from_crest) / o.cotangent;
  });
  return settled(stones, o, dem::Plane<3>{});
}

// --- what is measured ----------------------------------------------------------------------------

std::string gauge_name(std::size_t k) { return "level_" + std::to_string(k + 1); }

// Height of the crest: of the surface of the stones, on the mean over parts of its width as long as
// a stone [m].
double crest_of(const Options& o, const auto& stones) {
  const auto parts = std::max(1, int(std::round(o.crest / o.diameter)));
  std::vector<double> tops(std::size_t(parts), 0.0);
  for (const Vec<3>& x : stones[position]) {
    const double part = std::floor((x[0] - o.middle() + o.crest / 2) / o.crest * parts);
    if (part < 0 || part >= parts) continue;
    double& top = tops[std::size_t(part)];
    top = std::max(top, x[2] + o.diameter / 2);
  }
  double sum = 0;
  for (const double top : tops) sum += top / parts;
  return sum;
}

// The crest, the share of stones that are more than a diameter away from where they were, and the
// levels.
std::vector<double> measure(const Options& o, const std::vector<Vec<3>>& initial,
                            const auto& both) {
  const auto stones = both.grains().snapshot();
  double moved = 0;
  for (Index k = 0; k < stones.size(); ++k) {
    Vec<3> way = stones[position][k] - initial[std::size_t(stones.id(k))];
    way[1] -= o.thickness * std::round(way[1] / o.thickness);
    if (way.norm() > o.diameter) moved += 1 / double(stones.size());
  }
  std::vector<double> row{crest_of(o, stones), moved};
  for (const double x : o.gauges()) {
    row.push_back(
        SurfaceHeight<3>{.point = {x, o.thickness / 2, 0}, .spacing = o.spacing}.read(both));
  }
  return row;
}

double transmission(const Options& o, double height, double freeboard) {
  const double steepness = 2 * std::numbers::pi * height / (support::g * o.period * o.period);
  const double breaker = 1 / (o.cotangent * std::sqrt(steepness));
  const double through = 0.64 * std::pow(o.crest / height, -0.31) * (1 - std::exp(-breaker / 2));
  return std::clamp(-0.4 * freeboard / height + through, 0.075, 0.8);
}

std::vector<support::Finding> evaluate(const Options& o, const support::History& history) {
  const auto& t = history["t"];
  const auto x = o.gauges();
  const std::size_t half = x.size() / 2;
  // Of the last periods: the ramp has passed all gauges, and so has what the stones reflected and
  // the piston sent back.
  const double begin = 3 * o.period + (x.back() + 2 * o.toe()) / o.wave().group_speed();
  const double periods = std::floor((t.back() - begin) / o.period + 1e-9);
  const auto waves_at = [&](std::size_t from) -> support::Waves {
    if (!(periods >= 1)) return {};
    std::vector<std::complex<double>> amplitudes;
    for (std::size_t k = from; k < from + half; ++k) {
      amplitudes.push_back(support::amplitude_of(t, history[gauge_name(k)], o.wave().frequency(),
                                                 {t.back() - periods * o.period, t.back()}));
    }
    return support::separate(
        {x.begin() + std::ptrdiff_t(from), x.begin() + std::ptrdiff_t(from + half)}, amplitudes,
        o.wave().wave_number());
  };
  const auto before = waves_at(0), behind = waves_at(half);
  const double height = 2 * before.incident;
  // Before the waves are there, but not at first: single stones fall from the crest.
  const auto arrival = std::ranges::find_if(
      t, [&](double time) { return time >= o.toe() / o.wave().group_speed(); });
  const double crest = arrival == t.end() ? std::numeric_limits<double>::quiet_NaN()
                                          : history["crest"][std::size_t(arrival - t.begin())];
  const double freeboard = crest - o.depth;
  const auto stated = [](const std::string& name, double value) {
    return support::Finding{.quantity = name,
                            .reference = support::no_reference,
                            .measured = value,
                            .allowed = support::stated,
                            .scale = 1};
  };
  return {
      stated("height H of the waves before the breakwater [m]", height),
      stated("height of those behind it [m]", 2 * behind.incident),
      stated("freeboard Rc over H [-]", freeboard / height),
      {.quantity = "transmission coefficient Kt [-]",
       .reference = transmission(o, height, freeboard),
       .measured = behind.incident / before.incident,
       .allowed = 0.1,
       .scale = 1},
      stated("reflection coefficient [-]", before.reflected / before.incident),
      stated("reflection of the sponge [-]", behind.reflected / behind.incident),
      stated("settlement of the crest over d [-]", (crest - history["crest"].back()) / o.diameter),
      stated("share of stones that moved by more than d [-]", history["moved"].back())};
}

void simulate(const Options& o) {
  auto settings = support::mixture_settings<3, InMixture>(o, o.depth);
  settings.walls = walls_of(o);
  settings.friction = support::sponge_for(o.wave(), o.sponge(), o.length() - o.sponge());
  auto stones = support::or_reject([&] { return breakwater(o); });
  std::vector<Vec<3>> initial;
  for (const Vec<3>& x : stones[position]) initial.push_back(x);
  mps::FluidInMixture<3> water{box(o)};
  for (const auto& x :
       lattice<3>({Vec<3>::Zero(), Vec<3>(o.length(), o.thickness, o.depth)}, o.spacing)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  support::or_reject([&] { return coupled::make_room(water, stones, {.spacing = o.spacing}); });
  auto both = support::couple<3>(o, std::move(stones), std::move(water), settings,
                                 dem::Contacts{law_of(o), dem::Plane<3>{}}, coupled::DiFelice{});
  if (!o.resume.is_requested()) {
    support::or_reject([&] { return both.let_fluid_settle({.max_steps = 30}); });
  }
  std::vector<std::string> names{"crest", "moved"};
  for (std::size_t k = 0; k < o.gauges().size(); ++k) names.push_back(gauge_name(k));
  const auto row = [&](const auto& simulation) { return measure(o, initial, simulation); };
  support::run_coupled(
      o, both,
      support::Study{"breakwater", names, row,
                     [&](const support::History& history) { return evaluate(o, history); },
                     nlohmann::ordered_json{{"depth", o.depth},
                                            {"thickness", o.thickness},
                                            {"stroke", o.stroke},
                                            {"period", o.period},
                                            {"height", o.height},
                                            {"crest", o.crest},
                                            {"cotangent", o.cotangent},
                                            {"rolling_friction", o.rolling_friction},
                                            {"toe", o.toe()},
                                            {"heel", o.heel()},
                                            {"sponge", o.sponge()},
                                            {"length", o.length()},
                                            {"gauges", o.gauges()}}});
}

void check(const Options& o) {
  support::require_spheres(o);
  support::require_small_grains(o);
  const double least = 2 * std::max(o.radius, o.laplacian_radius) * o.spacing;
  if (o.thickness < least) {
    throw support::OptionError("--thickness " + to_text(o.thickness) +
                               " is too small for a periodic slice; give " + to_text(least) +
                               " or more");
  }
  if (!(o.stroke < o.depth)) {
    throw support::OptionError("--stroke " + to_text(o.stroke) + " must be below --depth");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.025;
  options.dimension = 3;
  options.until = 13;
  options.diameter = 0.02;
  options.stiffness = 2000;
  options.friction_angle = 35;
  options.output_every = 0.1;
  options.out = "out/breakwater";
  CLI::App app("Waves at a breakwater of stones", "breakwater");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    simulate(options);
  });
}
