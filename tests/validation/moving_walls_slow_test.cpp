// SPDX-License-Identifier: MIT
// Walls that move and bodies that float against linear theory, Archimedes and Zhao and Faltinsen: the rows of
// docs/verification.md.
#include <silt/core/parallel.hpp>
#include <silt/geometry/close_faces.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::moving_walls_slow_test {
namespace {

constexpr double g = 9.81;  // [m/s²]
using Settings = mps::FlowSettings<2, mps::Recommended>;

std::vector<Face<2>> faces_of_box(const Vec<2>& lower, const Vec<2>& upper) {
  return polyline({lower, {upper[0], lower[1]}, upper, {lower[0], upper[1]}, lower});
}
mps::Fluid<2> water_in(const Vec<2>& lower, const Vec<2>& upper, double spacing) {
  mps::Fluid<2> fluid{Box<2>{.lower = lower - Vec<2>(0.5, 0.5),
                             .upper = upper + Vec<2>(0.5, 3),
                             .on_escape = OnEscape::remove}};
  for (const auto& x : lattice<2>({.lower = lower, .upper = upper}, spacing)) {
    mps::add_particle(fluid, x, mps::Kind::fluid);
  }
  return fluid;
}
auto simulation_of(mps::Fluid<2> fluid, const Settings& settings) {
  return Simulation{std::move(fluid), UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                    SemiImplicit<>{}};
}

// A body that is held along x sinks or rises to its draught; a damper on it takes the energy away.
TEST(FloatingBox, ComesToRestAtItsDraught) {
  constexpr double l0 = 0.01, side = 0.2, length = 0.6, depth = 0.3;
  for (const double offset : {0.02, -0.02}) {
    Settings settings{.spacing = l0, .speed_scale = 2};
    settings.walls.segments = polyline({{0, 0.9}, {0, 0}, {length, 0}, {length, 0.9}});
    const Vec<2> lower(length / 2 - side / 2, depth - side / 2 + offset);
    const auto box = faces_of_box(lower, lower + Vec<2>(side, side));
    settings.walls.moving_2d = mps::MovingWalls<2>{
        .bodies = {{.faces = box,
                    .density = 500,
                    .is_held = {true, false},
                    .keeps_orientation = true,
                    .load = [](const BodyState<2>& body, double) {
                      return BodyLoad<2>{.force = {0, -300 * body.velocity[1]}};
                    }}}};
    auto fluid = water_in({0, 0}, {length, depth}, l0);
    mps::remove_inside(fluid, box, l0);
    const double level = (double(fluid.size()) * l0 * l0 + side * side / 2) / length;
    auto sim = simulation_of(std::move(fluid), settings);
    double sum = 0, duration = 0;
    while (sim.time() < 5) {
      sim.step();
      if (sim.time() < 3) continue;
      sum += sim.interaction().walls().bodies()[0].state().position[1] * sim.last_time_step();
      duration += sim.last_time_step();
    }
    EXPECT_NEAR(sum / duration, level, 0.1 * l0) << offset;  // its middle, half of it below water
  }
}

// Twice as wide as high, released 0.02 m above its draught. Linear potential theory, by boundary
// elements at 36 frequencies and Cummins' equation, has zeros at 0.3195 and 0.793 s, half a period
// apart, and the first extremum at −0.477 of the offset.
TEST(FloatingBox, HeavesAsInPotentialFlow) {
  constexpr double l0 = 0.01, width = 0.4, height = 0.2, length = 4, depth = 0.4, offset = 0.02;
  Settings settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 0.9}, {0, 0}, {length, 0}, {length, 0.9}});
  const Vec<2> lower(length / 2 - width / 2, depth - height / 2 + offset);
  const auto box = faces_of_box(lower, lower + Vec<2>(width, height));
  settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = {{.faces = box,
                                                             .density = 500,
                                                             .is_held = {true, false},
                                                             .keeps_orientation = true}}};
  auto fluid = water_in({0, 0}, {length, depth}, l0);
  mps::remove_inside(fluid, box, l0);
  auto sim = simulation_of(std::move(fluid), settings);
  std::vector<double> zeros;
  double last = offset, lowest = 0;
  while (sim.time() < 0.95) {
    sim.step();
    const double now = sim.interaction().walls().bodies()[0].state().position[1] - depth;
    if (now * last < 0) zeros.push_back(sim.time());
    lowest = std::min(lowest, now);
    last = now;
  }
  ASSERT_GE(zeros.size(), 2u);
  EXPECT_NEAR(zeros[0], 0.3195, 0.05 * 0.3195);
  EXPECT_NEAR(zeros[1] - zeros[0], 0.474, 0.05 * 0.474);
  EXPECT_NEAR(lowest / offset, -0.477, 0.08);
}

// The only one of a body that turns freely: half as dense as water, floating upright at rest, it
// gets a push, with a damper on its spin. It is stable if it is wider than √(6 s (1 − s)) = 1.22
// heights; narrower, by Archimedes it comes to rest at tan² φ = 12 s (1 − s)/(w/h)² − 2.
TEST(FloatingBox, TurnsOverIfItIsATenthNarrowerThanItsKnownWidth) {
  constexpr double l0 = 0.01, height = 0.2, depth = 0.3, gap = 0.2;
  for (const double width : {0.22, 0.27}) {
    const double length = width + 2 * gap;
    Settings settings{.spacing = l0, .speed_scale = 2};
    settings.walls.segments = polyline({{0, 0.9}, {0, 0}, {length, 0}, {length, 0.9}});
    const Vec<2> lower(gap, depth - height / 2);
    const auto box = faces_of_box(lower, lower + Vec<2>(width, height));
    settings.walls.moving_2d = mps::MovingWalls<2>{
        .bodies = {{.faces = box,
                    .density = 500,
                    .is_held = {true, false},
                    .load = [](const BodyState<2>& body, double t) {
                      return BodyLoad<2>{.torque = (t < 0.2 ? 1 : 0) - body.spin};
                    }}}};
    auto fluid = water_in({0, 0}, {length, depth}, l0);
    mps::remove_inside(fluid, box, l0);
    auto sim = simulation_of(std::move(fluid), settings);
    double sum = 0, duration = 0;
    while (sim.time() < 6) {
      sim.step();
      if (sim.time() < 4) continue;
      sum += sim.interaction().walls().bodies()[0].state().orientation.angle * sim.last_time_step();
      duration += sim.last_time_step();
    }
    const double tan2 = 3 / squared(width / height) - 2;
    const double expected = tan2 > 0 ? std::atan(std::sqrt(tan2)) : 0;
    EXPECT_NEAR(std::abs(sum / duration), expected, 0.05) << width;
  }
}

// The only one of many bodies that touch: ten boxes that a dam break throws over keep their
// distance, and where they end is the same on any threads.
TEST(PileOfBoxes, IsHitByADamBreak) {
  constexpr double l0 = 0.01, side = 0.08, density = 300, depth = 0.4;
  std::vector<mps::FloatingBody<2>> boxes;
  for (int row = 0; row < 4; ++row) {
    for (int k = 0; k < 4 - row; ++k) {
      const Vec<2> lower(1 + (side + l0) * (k + row / 2.0), l0 + (side + l0) * row);
      boxes.push_back({.faces = faces_of_box(lower, lower + Vec<2>(side, side)),
                       .density = density,
                       .friction = 0.2});
    }
  }
  const auto end_of = [&](int threads) {
    use_threads(threads);
    Settings settings{.spacing = l0, .speed_scale = 3};
    settings.walls.segments = polyline({{0, 0.8}, {0, 0}, {2, 0}, {2, 0.8}});
    settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = boxes};
    mps::Fluid<2> water = water_in({0, 0}, {depth, depth}, l0);
    water.set_box({.lower = {-0.5, -0.5}, .upper = {2.5, 3}});
    auto sim = simulation_of(std::move(water), settings);
    const auto& walls = sim.interaction().walls();
    double closest = 1;
    while (sim.time() < 0.7) {
      sim.step();
      const auto& faces = walls.faces();
      for (std::uint32_t box = 1; box <= boxes.size(); ++box) {
        for_each_close_pair(faces, box, 2 * l0, [&](std::uint32_t own, std::uint32_t other) {
          for_each_closest_points(faces[own].face, faces[other].face,
                                  [&](const Vec<2>& x, const Vec<2>& y) {
                                    closest = std::min(closest, (x - y).norm());
                                  });
        });
      }
    }
    EXPECT_GT(closest, l0 - 0.01 * side);
    std::vector<double> end;
    for (const auto& box : walls.bodies()) {
      const BodyState<2> state = box.state();
      end.insert(end.end(), {state.position[0], state.position[1], state.orientation.angle});
    }
    return end;
  };
  const std::vector<double> end = end_of(1);
  EXPECT_GT(*std::max_element(end.begin(), end.end()), 1.8) << "the boxes were not washed away";
  EXPECT_EQ(end, end_of(2));
  use_threads(1);
}

// The only one of a body in waves: a box of a ninth of the wave length, before waves return from
// the far end. Its drift is compared with that of water at the surface by Stokes, c (k a)² cosh
// 2kh/(2 sinh² kh), with the amplitude a of its heave: a body of this size, which rolls by 0.5, may
// be faster.
TEST(FloatingBox, DriftsWithTheWave) {
  constexpr double l0 = 0.01, depth = 0.2, period = 0.7, amplitude = 0.01, length = 3, at = 0.9;
  constexpr double omega = 2 * std::numbers::pi / period;
  double k = omega * omega / g;
  for (int n = 0; n < 200; ++n) k = omega * omega / (g * std::tanh(k * depth));
  Settings settings{.spacing = l0, .speed_scale = 1.4};
  settings.walls.segments = polyline({{-0.5, 0}, {length, 0}, {length, 0.8}});
  const auto box = faces_of_box({at - 0.04, depth - 0.02}, {at + 0.04, depth + 0.02});
  const auto shift = [=](double t) {
    const double s = std::min(1.0, t / (2 * period));
    return amplitude * s * s * (3 - 2 * s) * std::sin(omega * t);
  };
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = polyline({{0, 0.8}, {0, 0}}), .motion = MotionFunction<2>{[=](double t) {
                                                          return Pose<2>{.shift = {shift(t), 0}};
                                                        }}}},
      .bodies = {{.faces = box, .density = 500}}};
  auto fluid = water_in({0, 0}, {length, depth}, l0);
  mps::remove_inside(fluid, box, l0);
  auto sim = simulation_of(std::move(fluid), settings);
  double early = 0, late = 0, lowest = 1, highest = 0;  // means over a period
  while (sim.time() < 7 * period) {
    sim.step();
    const Vec<2> x = sim.interaction().walls().bodies()[0].state().position;
    const double share = sim.last_time_step() / period;
    if (sim.time() > 4 * period && sim.time() < 5 * period) early += share * x[0];
    if (sim.time() < 6 * period) continue;
    late += share * x[0];
    lowest = std::min(lowest, x[1]);
    highest = std::max(highest, x[1]);
  }
  const double a = (highest - lowest) / 2;
  const double stokes =
      omega / k * squared(k * a) * std::cosh(2 * k * depth) / (2 * squared(std::sinh(k * depth)));
  const double drift = (late - early) / (2 * period);
  RecordProperty("drift_over_Stokes", std::to_string(drift / stokes));
  EXPECT_GT(drift, 0.5 * stokes);
  EXPECT_LT(drift, 5 * stokes);
}

// The only one of the torque of water on a body over time: a box twice as wide as high, held in
// sway and heave, after a push. Linear potential theory (tests/reference/roll_of_a_box.py) has
// zeros at 0.611 and 1.171 s.
TEST(FloatingBox, RollsAsInPotentialFlow) {
  constexpr double l0 = 0.01, width = 0.4, height = 0.2, length = 4, depth = 0.4;
  Settings settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 0.9}, {0, 0}, {length, 0}, {length, 0.9}});
  const Vec<2> lower(length / 2 - width / 2, depth - height / 2);
  const auto box = faces_of_box(lower, lower + Vec<2>(width, height));
  const auto push = [](const BodyState<2>&, double t) {
    return BodyLoad<2>{.torque = t < 0.1 ? 10 * squared(std::sin(std::numbers::pi * t / 0.1)) : 0};
  };
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .bodies = {{.faces = box, .density = 500, .is_held = {true, true}, .load = push}}};
  auto fluid = water_in({0, 0}, {length, depth}, l0);
  mps::remove_inside(fluid, box, l0);
  auto sim = simulation_of(std::move(fluid), settings);
  std::vector<double> zeros;
  double last = 0;
  while (sim.time() < 1.5 && zeros.size() < 2) {
    sim.step();
    const double now = sim.interaction().walls().bodies()[0].state().orientation.angle;
    if (now * last < 0) zeros.push_back(sim.time());
    last = now;
  }
  ASSERT_EQ(zeros.size(), 2u);
  EXPECT_NEAR(zeros[0], 0.611, 0.05 * 0.611);
  EXPECT_NEAR(zeros[1] - zeros[0], 0.560, 0.05 * 0.560);
}

// A wedge with a deadrise of 30° at constant speed V into water at rest, without gravity:
// [ZhaoFaltinsen1993] have a force of 14.14 ρ V³ t. Its impulse; in a tank of 4 m × 1.5 m, its
// walls add 3 %.
TEST(Wedge, HasTheForceOfASelfSimilarEntry) {
  constexpr double l0 = 0.01, half_length = 3, depth = 3, speed = 1, half_width = 1.8;
  const double slope = std::tan(std::numbers::pi / 6);
  Settings settings{.spacing = l0, .gravity = {0, 0}, .speed_scale = 2};
  settings.walls.segments =
      polyline({{-half_length, 3}, {-half_length, -depth}, {half_length, -depth}, {half_length, 3}});
  constexpr double gap = 0.36 * l0;  // particles keep 0.35
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = polyline({{-half_width, half_width * slope + gap},
                                    {0, gap},
                                    {half_width, half_width * slope + gap}}),
                 .motion = Translation<2>{{0, -speed}}}}};
  auto sim = simulation_of(water_in({-half_length, -depth}, {half_length, 0}, l0), settings);
  double impulse = 0;
  while (sim.time() < 0.15) {
    sim.step();
    const auto& flow = sim.interaction();
    const mps::LoadOnGroup<2> on_wedge(
        flow.walls().faces(), 1, sim.particles().box(), {0, 0},
        {.density = 1000, .spacing = l0, .time_step = sim.last_time_step()});
    const auto own = [](const Vec<6>& numbers) { return numbers; };
    impulse += on_wedge.sum(flow.momentum_changes(), own).force[1] * sim.last_time_step();
  }
  const double t = sim.time() - gap / speed;
  EXPECT_NEAR(impulse / (0.5 * 1000 * t * t), 14.14, 0.05 * 14.14);
}

// A tank that sways near its resonance, and the same in its own frame, for two periods. After that
// small differences grow: at 4 s, two tanks in one frame differ as much if one has its acceleration
// a third of a step later, see verification.md.
TEST(SwayedTank, IsTheSameInItsOwnFrame) {
  constexpr double l0 = 0.01, amplitude = 0.01, length = 0.6;
  const double omega = 2 * std::numbers::pi / 1.2;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {length, 0.2}, .size = {.length = length, .height = 0.5}, .spacing = l0});
  const auto displacement = [=](double t) { return amplitude * (1 - std::cos(omega * t)); };
  Settings moving{.spacing = l0, .speed_scale = 1.4};
  moving.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = tank.walls.segments, .motion = MotionFunction<2>{[=](double t) {
                   return Pose<2>{.shift = {displacement(t), 0}};
                 }}}}};
  Settings in_frame{.spacing = l0, .speed_scale = 1.4, .walls = tank.walls};
  in_frame.body_force = [=](const Vec<2>&, double t) -> Vec<2> {
    return {-amplitude * omega * omega * std::cos(omega * t), 0};
  };
  auto one = simulation_of(water_in({0, 0}, {length, 0.2}, l0), moving);
  auto other = simulation_of(water_in({0, 0}, {length, 0.2}, l0), in_frame);
  const auto centre_of = [](const auto& sim) {
    const auto particles = sim.snapshot();
    double sum = 0;
    for (const auto& x : particles[position]) sum += x[0];
    return sum / double(particles.size());
  };
  double largest_difference = 0, largest_motion = 0;
  for (double t = 0.05; t < 2.45; t += 0.05) {
    one.run({.until = t, .end_exactly = true});
    other.run({.until = t, .end_exactly = true});
    const double relative = centre_of(one) - displacement(t);
    largest_difference = std::max(largest_difference, std::abs(relative - centre_of(other)));
    largest_motion = std::max(largest_motion, std::abs(centre_of(other) - length / 2));
  }
  EXPECT_GT(largest_motion, 0.02);
  EXPECT_LT(largest_difference, 0.01 * largest_motion);
}

// With the same steps, and with the acceleration of the mean velocities of the walls in them, which
// begins with half of it in the first step. Without the latter the difference is 0.16 %.
TEST(SwayedTank, IsTheSameInItsOwnFrameWithTheAccelerationOfItsSteps) {
  constexpr double l0 = 0.02, amplitude = 0.002, length = 0.4, time_step = 0.002;
  constexpr double omega = 2 * std::numbers::pi / 0.7474;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {length, 0.2}, .size = {.length = length, .height = 0.5}, .spacing = l0});
  const auto displacement = [=](double t) {
    return t > 0 ? amplitude * (1 - std::cos(omega * t)) : 0;
  };
  Settings moving{.spacing = l0, .speed_scale = 1.4};
  moving.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = tank.walls.segments, .motion = MotionFunction<2>{[=](double t) {
                                                 return Pose<2>{.shift = {displacement(t), 0}};
                                               }}}}};
  Settings in_frame{.spacing = l0, .speed_scale = 1.4, .walls = tank.walls};
  in_frame.body_force = [=](const Vec<2>&, double t) -> Vec<2> {
    const double second_difference =
        displacement(t + time_step) - 2 * displacement(t) + displacement(t - time_step);
    return {-second_difference / squared(time_step), 0};
  };
  auto one = simulation_of(water_in({0, 0}, {length, 0.2}, l0), moving);
  auto other = simulation_of(water_in({0, 0}, {length, 0.2}, l0), in_frame);
  const auto centre_of = [](const auto& sim) {
    double sum = 0;
    for (const auto& x : sim.particles()[position]) sum += x[0];
    return sum / double(sim.particles().size());
  };
  double largest_difference = 0, largest_motion = 0;
  while (one.time() < 1.49) {
    one.step(time_step);
    other.step(time_step);
    const double relative = centre_of(one) - displacement(one.time());
    largest_difference = std::max(largest_difference, std::abs(relative - centre_of(other)));
    largest_motion = std::max(largest_motion, std::abs(centre_of(other) - length / 2));
  }
  EXPECT_GT(largest_motion, 0.005);
  EXPECT_LT(largest_difference, 5e-4 * largest_motion);
}

// A piston in water of 0.2 m depth, of which the wave passes a gauge before it returns from the far end: the
// height over the stroke of linear theory [Biesel1951].
TEST(Piston, MakesTheWavesOfLinearTheory) {
  constexpr double l0 = 0.01, depth = 0.2, amplitude = 0.01, length = 5, at = 1;
  for (const double period : {0.8, 1.2}) {
    const double omega = 2 * std::numbers::pi / period;
    double k = omega * omega / g;
    for (int n = 0; n < 200; ++n) k = omega * omega / (g * std::tanh(k * depth));
    const double expected =
        2 * (std::cosh(2 * k * depth) - 1) / (std::sinh(2 * k * depth) + 2 * k * depth);
    Settings settings{.spacing = l0, .speed_scale = 1.4};
    settings.walls.segments = polyline({{-0.5, 0}, {length, 0}, {length, 0.6}});
    settings.walls.moving_2d = mps::MovingWalls<2>{
        .faces = {{.faces = polyline({{0, 0.6}, {0, 0}}), .motion = MotionFunction<2>{[=](double t) {
                     const double begun = std::min(1.0, t / period);
                     return Pose<2>{.shift = {begun * amplitude * (1 - std::cos(omega * t)), 0}};
                   }}}}};
    auto sim = simulation_of(water_in({0, 0}, {length, depth}, l0), settings);
    const double arrived = at / (omega / k / 2) + 2 * period;
    double lowest = 1, highest = 0;
    for (double t = 0.02; t < arrived + 2 * period; t += 0.02) {
      sim.run({.until = t});
      if (t < arrived) continue;
      // The mean level below a triangle, which is lower than the crest by the square of sin(x)/x.
      const auto particles = sim.snapshot();
      constexpr double half = 8 * l0;
      double volume = 0;
      for (const auto& x : particles[position]) {
        volume += l0 * l0 * std::max(0.0, 1 - std::abs(x[0] - at) / half);
      }
      const double smeared = std::sin(k * half / 2) / (k * half / 2);
      const double level = (volume / half - depth) / (smeared * smeared);
      lowest = std::min(lowest, level);
      highest = std::max(highest, level);
    }
    EXPECT_NEAR((highest - lowest) / (2 * amplitude) / expected, 1, 0.03) << period;
  }
}

// The only one of torques in a flow, those of a cross of blades and of the walls of its round tank
// of 48 sides, without gravity: the angular momentum of the fluid is their sum over time.
TEST(Paddle, AndItsTankGiveTheFluidItsAngularMomentum) {
  constexpr double l0 = 0.01, radius = 0.2, half = 0.12, spin = 3, begin = 0.5;
  constexpr int sides = 48;
  const double angle = 2 * std::numbers::pi / sides;
  Settings settings{.spacing = l0, .gravity = {0, 0}, .speed_scale = 1.5 * spin * half};
  std::vector<Vec<2>> corners;
  for (int k = 0; k <= sides; ++k) {
    corners.push_back(rotation_by((k % sides + 0.5) * angle) *
                      Vec<2>(radius / std::cos(angle / 2), 0));
  }
  settings.walls.segments = polyline(corners);
  auto blades = polyline({{-half, 0}, {0, 0}, {half, 0}});
  for (const auto& face : polyline({{0, -half}, {0, 0}, {0, half}})) blades.push_back(face);
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = blades, .motion = MotionFunction<2>{[=](double t) {
                                    const double s =
                                        std::min(1.0, t / begin);  // its velocity is s² (3 − 2 s)
                                    const double turn =
                                        begin * s * s * s * (1 - s / 2) + std::max(0.0, t - begin);
                                    return Pose<2>{.rotation = rotation_by(spin * turn)};
                                  }}}}};
  mps::Fluid<2> fluid{Box<2>{.lower = {-0.4, -0.4}, .upper = {0.4, 0.4}}};
  for (const auto& x : lattice<2>({.lower = {-radius, -radius}, .upper = {radius, radius}}, l0)) {
    double from_wall = radius;
    for (int k = 0; k < sides; ++k) {
      from_wall = std::min(from_wall, radius - x.dot(rotation_by(k * angle) * Vec<2>(1, 0)));
    }
    if (from_wall > 0.45 * l0) mps::add_particle(fluid, x, mps::Kind::fluid);
  }
  auto sim = simulation_of(std::move(fluid), settings);
  const WallLoad<2> on_blades(WallGroup::moving_faces(0)), on_tank(WallGroup{});
  double by_blades = 0, by_tank = 0;
  while (sim.time() < 1) {
    sim.step();
    by_blades -= on_blades.read(sim, Vec<2>(0, 0)).torque * sim.last_time_step();
    by_tank -= on_tank.read(sim, Vec<2>(0, 0)).torque * sim.last_time_step();
    double momentum = 0;
    for (Index i = 0; i < sim.particles().size(); ++i) {
      momentum += 1000 * l0 * l0 *
                  cross(Vec<2>(sim.particles()[position][i]), Vec<2>(sim.particles()[velocity][i]));
    }
    if (sim.time() < 0.2) continue;
    EXPECT_NEAR((by_blades + by_tank) / momentum, 1, 0.01) << sim.time();
  }
  EXPECT_GT(by_blades, 0.9);
}

}  // namespace
}  // namespace silt::test::moving_walls_slow_test
