// SPDX-License-Identifier: MIT
// A flow with walls that move and bodies keeps its promises: the same bits on any number of threads, and
// after steps that fail in their middle.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <atomic>
#include <vector>

namespace silt::test::walls_that_move_test {
namespace {

constexpr double l0 = 0.02;  // [m]

std::vector<Face<2>> box(const Vec<2>& centre, const Vec<2>& half) {
  const auto at = [&](double a, double b) { return Vec<2>(centre + Vec<2>(a * half[0], b * half[1])); };
  return polyline({at(-1, -1), at(1, -1), at(1, 1), at(-1, 1), at(-1, -1)});
}

/// A piston, a stirrer, a box that falls into water and one that lies on the floor.
auto splash(double length, double depth, const std::atomic<bool>& fails) {
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{-0.1, 0}, {length, 0}, {length, 2 * depth}});
  const std::vector<mps::FloatingBody<2>> bodies{
      {.faces = box({0.3, depth + 0.07}, {0.1, 0.06}), .density = 300, .velocity = {0.5, -2}, .spin = 3},
      {.faces = box({length - 0.12, 0.05}, {0.05, 0.03}), .density = 3000}};
  settings.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = polyline({{0, 0}, {0, 2 * depth}}), .motion = Vibration<2>{{0.02, 0}, 2}},
                {.faces = polyline({{0.2, 0.07}, {0.24, 0.12}}),
                 .motion = Rotation<2>{.about = {0.2, 0.1}, .spin = 4}}},
      .bodies = bodies};
  settings.surface_pressure = [&fails](const Vec<2>&, double) { return fails ? nan : 0.0; };
  auto fluid = fluid_at(lattice<2>({{0, 0}, {length, depth}}, l0));
  for (const auto& body : bodies) mps::remove_inside(fluid, body.faces, l0);
  return Simulation{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
}
template <class Sim>
Bytes state_with_bodies(const Sim& simulation) {
  Bytes bytes = state_of(simulation.particles());
  for (const auto& body : simulation.interaction().walls().bodies()) {
    const auto state = body.state();
    append(bytes, std::vector{state.position[0], state.position[1], state.orientation.angle,
                              state.velocity[0], state.velocity[1], state.spin, body.momentum()[1]});
  }
  return bytes;
}

// The only test of walls that move with enough particles for several threads.
TEST(WallsThatMove, HaveTheSameBitsOnAnyNumberOfThreads) {
  const std::atomic<bool> fails = false;
  const auto run = [&] {
    auto simulation = splash(1.8, 0.8, fails);
    EXPECT_GT(simulation.particles().size(), 3 * chunk_size);
    for (int k = 0; k < 2; ++k) simulation.step();
    return state_with_bodies(simulation);
  };
  const Bytes alone = with_threads(1, run);
  for (const int number : {2, 3}) {
    EXPECT_TRUE(with_threads(number, run) == alone) << number << " threads";
  }
}

// The only test of a step that fails after the walls have moved and the bodies met them.
TEST(WallsThatMove, AreAsBeforeAStepThatFailsInItsMiddle) {
  std::atomic<bool> fails = false;
  auto whole = splash(0.6, 0.2, fails);
  auto interrupted = whole;
  for (int k = 0; k < 30; ++k) {
    whole.step();
    if (k % 3 == 0) {
      fails = true;
      const Bytes before = state_with_bodies(interrupted);
      EXPECT_TRUE(refuses([&] { interrupted.step(1e-4); }, {"surface_pressure", "not finite"}));
      EXPECT_TRUE(state_with_bodies(interrupted) == before) << k;
      fails = false;
    }
    interrupted.step();
  }
  EXPECT_TRUE(state_with_bodies(whole) == state_with_bodies(interrupted));
}

}  // namespace
}  // namespace silt::test::walls_that_move_test
