// SPDX-License-Identifier: MIT
// A wave maker at the left end of a tank: a piston, or a flap that is hinged at the floor. The
// height of the waves over its stroke is compared with Biésel's linear theory, as long as no
// reflection is there, and the reflection of the far end, a wall, a beach or a sponge, is measured.
//
//   wave_maker --out out/wave_maker
//   wave_maker --type flap --depth 0.4 --period 1 --out out/flap
//   wave_maker --far-end sponge --until 20 --out out/sponge
//   examples/plot_wave_maker.py out/wave_maker
//
// The wave maker moves by S/2 sin(ω t) about x = 0, growing in the first two periods. The levels of
// the water at some places are those of SurfaceHeight.
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <CLI/CLI.hpp>

#include "support/command_line.hpp"
#include "support/findings.hpp"
#include "support/history.hpp"
#include "support/resume.hpp"
#include "support/sponge.hpp"
#include "support/tank_run.hpp"
#include "support/water_waves.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string>
#include <vector>

namespace {

using namespace silt;

struct Options : support::TankOptions {
  std::string type = "piston";
  double stroke = 0.02;  // S [m]; of a flap at the still surface
  double period = 1.2;   // [s]
  std::string far_end = "wall";
  double far_length = 2;  // of the beach or the sponge [m]

  support::LinearWave wave() const { return {.period = period, .depth = depth}; }
  double far_begin() const { return far_end == "wall" ? length : length - far_length; }
};

struct Scheme : mps::Recommended {
  support::Sponge friction{};
};

void describe(CLI::App& app, Options& o) {
  using support::add_option, support::positive;
  add_option(app, "--type", o.type, "piston, or flap", CLI::IsMember({"piston", "flap"}));
  add_option(app, "--stroke", o.stroke,
             "whole way of the wave maker [m], of a flap at the still "
             "surface",
             positive());
  add_option(app, "--period", o.period, "of the waves [s]", positive());
  add_option(app, "--far-end", o.far_end,
             "what is at the right end of the tank: wall, beach (a "
             "slope from the floor to the top of the wall) or sponge (water without waves)",
             CLI::IsMember({"wall", "beach", "sponge"}));
  add_option(app, "--far-length", o.far_length, "length of the beach or the sponge [m]",
             positive());
  support::describe_tank(app, o, "wave_maker.csv, frames.pvd, walls.pvd and summary.json");
}

template <int Dim>
AnyRigidMotion<Dim> motion(const Options& o) {
  const support::WaveMakerShift shift{.stroke = o.stroke, .period = o.period};
  if (o.type == "piston") {
    return MotionFunction<Dim>{[=](double t) {
      Pose<Dim> pose;
      pose.shift[0] = shift(t);
      return pose;
    }};
  }
  // About the floor at x = 0.
  return MotionFunction<Dim>{[=, depth = o.depth](double t) {
    const double lean = std::asin(shift(t) / depth);
    if constexpr (Dim == 2) {
      return Pose<2>{.rotation = rotation_by(-lean)};
    } else {
      return Pose<3>{.rotation = rotation_about(Vec<3>(Vec<3>::UnitY()), lean)};
    }
  }};
}

// The tank goes on behind the wave maker, which is a wall without thickness.
template <int Dim>
void set_walls(const Options& o, auto& tank) {
  const double high = o.wall_height(), behind = -2 * o.stroke - 4 * o.spacing;
  Vec<Dim> lower = Vec<Dim>::Zero(), upper = Vec<Dim>::Constant(o.thickness);
  upper[0] = o.length;
  upper[Dim - 1] = high;
  Sides<Dim> left{};
  left.lower[0] = true;
  const auto board = faces_of(Box<Dim>{.lower = lower, .upper = upper}, left);
  support::set_moving<Dim>(tank.walls, {.faces = {{.faces = board, .motion = motion<Dim>(o)}}});
  lower[0] = behind;
  auto sides = Sides<Dim>::open();
  sides.lower[0] = false;
  tank.walls.template faces<Dim>() = faces_of(Box<Dim>{.lower = lower, .upper = upper}, sides);
  if (o.far_end != "beach") return;

  const double begin = o.far_begin(), slope = high / o.far_length;
  auto& faces = tank.walls.template faces<Dim>();
  if constexpr (Dim == 2) {
    faces.push_back({{Vec<2>(begin, 0), Vec<2>(o.length, high)}});
  } else {
    const double y = o.thickness;
    faces.push_back({{Vec<3>(begin, 0, 0), Vec<3>(o.length, 0, high), Vec<3>(o.length, y, high)}});
    faces.push_back({{Vec<3>(begin, 0, 0), Vec<3>(o.length, y, high), Vec<3>(begin, y, 0)}});
  }
  const auto x = tank.particles[position];
  tank.particles.remove_if([&](Index i) {
    return x[i][Dim - 1] - slope * (x[i][0] - begin) < 0.45 * o.spacing * std::hypot(1, slope);
  });
}

// Of the levels [m]: three depths away from the wave maker, whose evanescent waves are gone there.
std::vector<double> gauges(const Options& o) {
  return support::gauges_from(3 * o.depth, o.wave().length());
}

std::vector<support::Finding> evaluate(const Options& o, const support::History& history) {
  const auto wave = o.wave();
  const auto x = gauges(o);
  const auto& t = history["t"];
  constexpr int least_periods = 2;
  // Of whole periods; none if there is no time.
  const auto waves_within = [&](double begin, double end) -> support::Waves {
    const double periods = std::floor((end - begin) / o.period + 1e-9);
    if (!(periods >= least_periods)) return {};
    std::vector<std::complex<double>> amplitudes;
    for (std::size_t g = 1; g <= x.size(); ++g) {
      amplitudes.push_back(support::amplitude_of(t, history["level_" + std::to_string(g)],
                                                 wave.frequency(),
                                                 {end - periods * o.period, end}));
    }
    return support::separate(x, amplitudes, wave.wave_number());
  };
  // One period after the ramp has passed the last gauge, until the far end is heard there; and one
  // period after that is so everywhere.
  const double speed = wave.group_speed();
  const auto first = waves_within(3 * o.period + x.back() / speed,
                                  std::min(t.back(), (2 * o.far_begin() - x.back()) / speed));
  const auto last = waves_within(3 * o.period + (2 * o.length - x.front()) / speed, t.back());
  const bool absorbs = o.far_end != "wall";
  return {{.quantity = "wave height over stroke, before the reflection [-]",
           .reference = o.type == "piston" ? wave.height_by_piston() : wave.height_by_flap(),
           .measured = 2 * first.incident / o.stroke,
           .allowed = 0.03},
          {.quantity = "wave against it over wave, then [-]",
           .measured = first.reflected / first.incident,
           .allowed = support::stated,
           .scale = 1},
          {.quantity = "reflection of the far end, later [-]",
           .reference = absorbs ? 0 : support::no_reference,
           .measured = last.reflected / last.incident,
           .allowed = absorbs ? 0.1 : support::stated,
           .scale = 1}};
}

template <int Dim>
void simulate(const Options& o) {
  auto tank = support::make_tank<Scheme, Dim>(o, 2 * o.stroke);
  set_walls<Dim>(o, tank);
  auto settings = support::flow_settings<Scheme, Dim>(o, o.depth);
  settings.walls = tank.walls;
  if (o.far_end == "sponge") {
    settings.friction = support::sponge_for(o.wave(), o.far_begin(), o.far_length);
  }
  const auto x = gauges(o);
  std::vector<std::string> names;
  for (std::size_t g = 1; g <= x.size(); ++g) names.push_back("level_" + std::to_string(g));
  std::vector<SurfaceHeight<Dim>> levels;
  for (const double at : x) {
    Vec<Dim> point = Vec<Dim>::Constant(o.thickness / 2);
    point[0] = at;
    levels.push_back({.point = point, .spacing = o.spacing});
  }
  const auto measure = [&](const auto& simulation) {
    std::vector<double> row;
    for (const auto& level : levels) row.push_back(level.read(simulation));
    return row;
  };
  support::run_tank(
      o, tank.particles, settings,
      support::Study{"wave_maker", names, measure,
                     [&](const support::History& history) { return evaluate(o, history); },
                     nlohmann::ordered_json{{"type", o.type},
                                            {"stroke", o.stroke},
                                            {"period", o.period},
                                            {"far_end", o.far_end},
                                            {"far_length", o.far_length},
                                            {"gauges", x}}});
}

void check(const Options& o) {
  const double last = gauges(o).back() + o.depth;
  if (!(o.far_begin() > last)) {
    throw support::OptionError("--length " + to_text(o.length) + " leaves " +
                               to_text(o.far_begin()) + " m before the far end; the gauges need " +
                               to_text(last) + " m");
  }
  if (!(o.stroke < o.depth)) {
    throw support::OptionError("--stroke " + to_text(o.stroke) + " must be below --depth");
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  options.spacing = 0.02;
  options.length = 6.6;
  options.depth = 0.2;
  options.until = 10;
  options.output_every = 0.05;
  options.out = "out/wave_maker";
  CLI::App app("A wave maker in a tank", "wave_maker");
  describe(app, options);
  return support::run(app, argc, argv, options.resume, [&] {
    check(options);
    options.dimension == 2 ? simulate<2>(options) : simulate<3>(options);
  });
}
