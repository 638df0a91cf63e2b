// SPDX-License-Identifier: MIT
// Bodies that a viscous fluid resolves settle in it: rows of docs/verification.md.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/filling/fill.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::settling_bodies_slow_test {
namespace {

struct Sticky : mps::Recommended {
  mps::NoSlip wall_stress{};
};

// A polygon with the area of a disc.
std::vector<Face<2>> disc(const Vec<2>& centre, double diameter, int sides) {
  const double step = 2 * std::numbers::pi / sides;
  const double radius = diameter / 2 * std::sqrt(step / std::sin(step));
  std::vector<Vec<2>> corners;
  for (int k = 0; k <= sides; ++k) {
    const double angle = step * (k % sides);
    corners.push_back(centre + radius * Vec<2>(std::cos(angle), std::sin(angle)));
  }
  return polyline(corners);
}

// The only one of bodies in a viscous fluid, and of two that meet in it: in the wake of the lower
// disc the upper one is faster (drafting), touches it (kissing), and both turn until they are side
// by side and part (tumbling). The case of Feng and Michaelides (2004), of discs of 2 mm and 1.01
// times the density of water in a closed tank of 20 mm × 80 mm. Weight less buoyancy acts on the
// discs, instead of gravity on both: with it, the load would be the small difference of large ones.
TEST(TwoDiscs, DraftKissAndTumble) {
  constexpr double d = 2e-3, width = 20e-3, height = 80e-3, rho = 1000, ratio = 1.01, g = 9.81;
  constexpr double l0 = d / 8;
  mps::FlowSettings<2, Sticky> settings{
      .spacing = l0, .density = rho, .viscosity = 1e-6, .gravity = {0, 0}, .speed_scale = 0.05};
  settings.walls.segments = polyline({{0, 0}, {width, 0}, {width, height}, {0, height}, {0, 0}});
  settings.walls.let_fluid_fall = true;
  mps::MovingWalls<2> discs;
  const auto weight = [=](const BodyState<2>&, double) {
    return BodyLoad<2>{.force = {0, -(ratio - 1) * rho * std::numbers::pi * d * d / 4 * g}};
  };
  for (const Vec<2>& centre : {Vec<2>(0.00999, 0.072), Vec<2>(0.01, 0.068)}) {
    discs.bodies.push_back({.faces = disc(centre, d, 25), .density = ratio * rho, .load = weight});
  }
  settings.walls.moving_2d = discs;
  mps::Fluid<2> fluid;
  mps::fill(fluid, settings.walls,
            {.inside = {width / 2, height / 4}, .level = 2 * height, .spacing = l0});
  Simulation sim{std::move(fluid), UniformGrid<2>{},
                 mps::Flow<Sticky>{mps::without_free_surface(settings)}, SemiImplicit<>{}};
  const auto& bodies = sim.interaction().walls().bodies();
  const auto apart = [&]() -> Vec<2> {
    return bodies[0].state().position - bodies[1].state().position;
  };
  double alike = 0, kissed = 0, closest = 1;
  while (sim.time() < 3.5 && !(kissed > 0 && apart().norm() > 2 * d)) {
    sim.step();
    const double gap = apart().norm() - d;
    closest = std::min(closest, gap);
    if (sim.time() < 0.3) alike = std::max(alike, std::abs(gap - d));
    if (kissed == 0 && gap < 1.05 * l0) kissed = sim.time();
  }
  std::printf("kissing from %.3f s on, parted at %.3f s; closest %.3f l0\n", kissed, sim.time(),
              closest / l0);
  EXPECT_LT(alike, 0.01 * d);  // before the wake is there
  EXPECT_NEAR(kissed, 1.1, 0.1);
  EXPECT_GT(closest, 0.9 * l0);
  EXPECT_LT(apart()[1], 0) << "the upper disc has not passed the lower one";
  EXPECT_GT(apart().norm(), 2 * d) << "the discs have not parted";
}

}  // namespace
}  // namespace silt::test::settling_bodies_slow_test
