// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/flux.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

namespace silt::test::flux_test {
namespace {

constexpr double l0 = 0.02;  // [m]

template <int Dim>
auto collapse() {
  mps::Tank<Dim> tank{
      .column = {8 * l0, 12 * l0}, .size = {.length = 24 * l0, .height = 16 * l0}, .spacing = l0};
  tank.size.depth = 2 * l0;
  const auto made = mps::make_tank<mps::Recommended, Dim>(tank);
  return Simulation{
      made.particles, UniformGrid<Dim>{},
      mps::Flow<mps::Recommended, Dim>{{.spacing = l0, .speed_scale = 2, .walls = made.walls}},
      SemiImplicit<>{}};
}
template <int Dim, class Sim>
double volume_beyond(const Sim& sim, double x) {
  double number = 0;
  for (const auto& each : sim.particles()[position]) number += each[0] > x;
  return number * std::pow(l0, Dim);
}

// What has passed is what is beyond, in every step, also through a section of several faces.
template <int Dim>
void expect_volume(const std::vector<Face<Dim>>& faces, double x, double sign) {
  auto sim = collapse<Dim>();
  Flux<Dim> flux{{.faces = faces, .spacing = l0}};
  double sum = 0, time = 0;
  for (int k = 0; k < 45; ++k) {
    flux.before_step(sim);
    sim.step();
    flux.after_step(sim);
    EXPECT_NEAR(sign * flux.volume(), volume_beyond<Dim>(sim, x), 1e-9) << k;
    if (k % 7 > 0) continue;
    sum += flux.row(sim)[0] * (sim.time() - time);  // the rate is that since the last row
    time = sim.time();
    EXPECT_NEAR(sum, flux.volume(), 1e-12);
  }
  EXPECT_GT(sign * flux.volume(), 5 * std::pow(l0, Dim));
}
TEST(Flux, IsTheVolumeThatIsBeyond) {
  const double x = 8.9 * l0;
  expect_volume<2>(polyline({{x, 1}, {x, 0.05}, {x, 0.02}, {x, -0.1}}), x, 1);
  expect_volume<2>(polyline({{x, -0.1}, {x, 1}}), x, -1);
  const Vec<3> a{x, -1, -1}, b{x, 1.1, -1}, c{x, 1.1, 1.1}, d{x, -1, 1.1};
  expect_volume<3>({{{a, b, c}}, {{a, c, d}}}, x, 1);
}

// A lattice that moves through two triangles, many particles exactly through their common edge.
TEST(Flux, CountsOnceWhatPassesAnEdge) {
  mps::FlowSettings<3, mps::Recommended> settings{.spacing = l0, .gravity = Vec<3>::Zero()};
  settings.walls.let_fluid_fall = true;
  mps::Fluid<3> block;
  for (const auto& x : lattice<3>({{0, 0, 0}, {2 * l0, 4 * l0, 4 * l0}}, l0)) {
    mps::add_particle(block, x, mps::Kind::fluid);
  }
  for (auto& u : block[velocity]) u = {0.5, 0, 0};
  Simulation sim{block, UniformGrid<3>{}, mps::Flow<mps::Recommended, 3>{settings},
                 SemiImplicit<>{}};
  const double x = 2 * l0, L = 4 * l0;
  const Vec<3> a{x, 0, 0}, b{x, L, 0}, c{x, L, L}, d{x, 0, L};
  const std::vector<Face<3>> faces{{{a, b, c}}, {{a, c, d}}};
  Flux<3> flux{{.faces = faces, .spacing = l0}};
  while (sim.time() < 0.15) {
    flux.before_step(sim);
    sim.step(4e-3);
    flux.after_step(sim);
  }
  EXPECT_NEAR(flux.volume(), double(block.size()) * l0 * l0 * l0, 1e-12);
}

// At the side of a periodic channel, on whichever of its ends it is given.
TEST(Flux, CountsWhatPassesAPeriodicSide) {
  for (const double x : {0.0, 0.16}) {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .gravity = Vec<2>::Zero()};
    settings.walls.let_fluid_fall = true;
    mps::Fluid<2> stream;
    stream.set_box({.lower = {0, -1}, .upper = {0.16, 1}, .periodic = {true, false}});
    for (const auto& at : lattice<2>({{0, 0}, {0.16, 0.08}}, l0)) {
      mps::add_particle(stream, at, mps::Kind::fluid);
    }
    for (auto& u : stream[velocity]) u = {-1, 0};
    Simulation sim{stream, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                   SemiImplicit<>{}};
    Flux<2> flux{{.faces = polyline({{x, 1}, {x, -1}}), .spacing = l0}};
    while (sim.time() < 0.155) {
      flux.before_step(sim);
      sim.step(4e-3);
      flux.after_step(sim);
    }
    EXPECT_NEAR(flux.volume() / (l0 * l0), -32, 1e-9);  // eight columns of four, once around
  }
}

TEST(Flux, MovesWithWalls) {
  constexpr double speed = 0.7;
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {{.faces = polyline({{0, 1}, {0, 0}, {8 * l0, 0}, {8 * l0, 1}}),
                                     .motion = Translation<2>{{speed, 0}}}}};
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({{0, 0}, {8 * l0, 6 * l0}}, l0)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  for (auto& u : water[velocity]) u = {speed, 0};
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  const auto faces = polyline({{4 * l0, 1}, {4 * l0, -1}});
  Flux<2> at_rest{{.faces = faces, .spacing = l0}};
  Flux<2> on_tank{{.faces = faces, .spacing = l0, .moves_with = WallGroup::moving_faces(0)}};
  while (sim.time() < 0.11) {
    at_rest.before_step(sim), on_tank.before_step(sim);
    sim.step();
    at_rest.after_step(sim), on_tank.after_step(sim);
  }
  EXPECT_EQ(on_tank.volume(), 0);
  EXPECT_NEAR(at_rest.volume() / (l0 * l0), 6 * std::floor(speed * sim.time() / l0 + 0.5), 1e-9);
}

TEST(Flux, RefusesWhatIsNoSection) {
  const auto faces = polyline({{0, 1}, {0, 0}});
  EXPECT_TRUE(refuses([&] { Flux<2>{{.faces = {}, .spacing = l0}}; }, {"Flux: no faces"}));
  EXPECT_TRUE(refuses([&] { Flux<2>{{.faces = faces, .spacing = 0}}; }, {"Flux: spacing", "0"}));
  EXPECT_TRUE(refuses([&] { Flux<2>{{.faces = polyline({{0, 0}, {0, 0}}), .spacing = l0}}; },
                      {"Flux: face 0", "both ends"}));
  const auto sim = collapse<2>();
  Flux<2> flux{{.faces = faces, .spacing = l0, .moves_with = WallGroup::body(0)}};
  EXPECT_TRUE(refuses([&] { flux.before_step(sim); }, {"Flux", "body(0)", "0 bodies"}));
}

}  // namespace
}  // namespace silt::test::flux_test
