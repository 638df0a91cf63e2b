// SPDX-License-Identifier: MIT
// Steady flows through openings against their theories.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/extraction.hpp>
#include <silt/mps/setup/inflow.hpp>
#include <silt/mps/setup/outflow.hpp>
#include <silt/mps/setup/pressure_opening.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace silt::test::openings_slow_test {
namespace {

constexpr double g = 9.81;        // [m/s²]
constexpr double density = 1000;  // [kg/m³]
constexpr double inf = std::numeric_limits<double>::infinity();

auto simulation_of(const mps::Fluid<2>& fluid,
                   const mps::FlowSettings<2, mps::Recommended>& settings) {
  return Simulation{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                    SemiImplicit<>{}};
}
void fill(mps::Fluid<2>& fluid, const Box<2>& box, double spacing, double speed = 0) {
  for (const auto& x : lattice<2>(box, spacing)) {
    const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
    fluid[velocity][i] = {speed, 0};
    fluid[mps::pressure][i] = density * g * (box.upper[1] - x[1]);
  }
}
void append(std::vector<Face<2>>& faces, const std::vector<Vec<2>>& points) {
  const auto more = polyline(points);
  faces.insert(faces.end(), more.begin(), more.end());
}

/// Averages over time from `from` [s] on: the fluid in boxes.
struct Averages {
  struct Part {
    Box<2> box;
    double area = 0;      // of the fluid [m²]
    double speed = 0;     // its sum over the particles [m/s]
    double momentum = 0;  // Σ (P + ρ u_x²) l0² [N]
    double particles = 0;
  };
  double from = 0;
  double spacing = 0;
  std::vector<Part> parts = {};
  int outputs = 0;

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (simulation.time() < from) return;
    ++outputs;
    const auto& fluid = simulation.particles();
    for (Part& part : parts) {
      for (Index i = 0; i < fluid.size(); ++i) {
        if (!part.box.contains(fluid[position][i])) continue;
        const Vec<2> u = fluid[velocity][i];
        part.particles += 1;
        part.speed += u.norm();
        part.momentum += squared(spacing) * (fluid[mps::pressure][i] + density * squared(u[0]));
      }
      part.area = part.particles * squared(spacing) / outputs;
    }
  }
  /// Over the length of its box [m].
  double depth(std::size_t k) const {
    return parts[k].area / (parts[k].box.upper[0] - parts[k].box.lower[0]);
  }
};

// The only test of a jet that separates from an edge: half of the slot, beside a wall as plane of
// symmetry. 20 spacings across the slot.
TEST(SlotInTheFloor, ContractsAsAFreeJetWithTheSpeedOfTorricelli) {
  const double l0 = 0.005, b = 0.1, width = 0.3, head = 0.6, inlet = 0.3;  // [m]
  const double flow = std::numbers::pi / (std::numbers::pi + 2) * b / 2 * std::sqrt(2 * g * head);
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0,
                                                  .speed_scale = std::sqrt(2 * g * head)};
  auto& walls = settings.walls.segments;
  append(walls, {{0, -1}, {0, 1.5 * head}});
  append(walls, {{b / 2, 0}, {width + 3 * l0, 0}});
  append(walls, {{width + 3 * l0, inlet}, {width, inlet}, {width, 1.5 * head}});
  settings.walls.let_fluid_fall = true;
  mps::Inflow<2> in({.faces = polyline({{width + 2 * l0, 0}, {width + 2 * l0, inlet}}),
                     .velocity = {-flow / inlet, 0},
                     .spacing = l0,
                     .ramp = 0.1});
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {in.piston()}};
  mps::Outflow<2> out(Box<2>{.upper = {inf, -0.6}});
  mps::Fluid<2> water;
  fill(water, {{0, 0}, {width, head}}, l0);
  fill(water, {{width, 0}, {width + 2 * l0, inlet}}, l0);

  Averages averages{.from = 0.4, .spacing = l0, .parts = {{.box = {{b, 0}, {width, inf}}}}};
  for (int k = 0; k < 4; ++k) {  // of the jet
    averages.parts.push_back({.box = {{0, -b * (k + 2) / 2}, {0.75 * b, -b * (k + 1) / 2}}});
  }
  auto simulation = simulation_of(water, settings);
  simulation.run({.until = 1, .output_every = 0.02}, in, out, averages);

  const double h = averages.depth(0);
  double contraction = 0, torricelli = 0;
  for (std::size_t k = 1; k <= 4; ++k) {
    const auto& part = averages.parts[k];
    const double fallen = h + b * (double(k) + 1) / 2 - b / 4;
    contraction += part.area / (b / 2) / (b / 2) * std::sqrt(fallen / h) / 4;
    torricelli += part.speed / part.particles / std::sqrt(2 * g * fallen) / 4;
  }
  RecordProperty("contraction", std::to_string(contraction));
  RecordProperty("torricelli", std::to_string(torricelli));
  EXPECT_NEAR(contraction / (std::numbers::pi / (std::numbers::pi + 2)), 1, 0.05);
  EXPECT_NEAR(torricelli, 1, 0.02);
}

// The only test of a flow whose level follows from its discharge: critical on the crest.
TEST(BroadCrestedWeir, HasTheDischargeOfItsCriticalDepth) {
  const double l0 = 0.01, head = 0.15, height = 0.15, pool = 0.6, crest = 0.5, edge = 0.06;  // [m]
  const double flow = std::sqrt(g) * std::pow(2 * head / 3, 1.5);
  std::vector<Vec<2>> line{{-3 * l0, 0}, {pool, 0}};
  for (int k = 0; k <= 8; ++k) {
    const double a = k * std::numbers::pi / 16;
    line.push_back({pool + edge * (1 - std::cos(a)), height + edge * (std::sin(a) - 1)});
  }
  line.push_back({pool + crest, height});
  line.push_back({pool + crest, -0.3});
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1.5};
  settings.walls.segments = polyline(line);
  const double level = height + head;
  mps::Inflow<2> in({.faces = polyline({{0, 0}, {0, 2 * level}}),
                     .velocity = {flow / level, 0},
                     .spacing = l0,
                     .level = level,
                     .ramp = 0.5});
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {in.piston()}};
  mps::Outflow<2> out(Box<2>{.upper = {inf, -0.1}});
  mps::Fluid<2> water;
  fill(water, {{0, 0}, {pool, level}}, l0);

  Averages averages{
      .from = 4, .spacing = l0, .parts = {{.box = {{0.3 * pool, 0}, {0.6 * pool, inf}}}}};
  auto simulation = simulation_of(water, settings);
  simulation.run({.until = 4}, in, out);
  const double before = out.volume();
  simulation.run({.until = 8, .output_every = 0.1}, in, out, averages);
  const double depth = averages.depth(0);
  const double measured = depth - height + squared(flow / depth) / (2 * g);
  EXPECT_NEAR(flow / (std::sqrt(g) * std::pow(2 * measured / 3, 1.5)), 1, 0.05);
  EXPECT_NEAR((out.volume() - before) / 4 / flow, 1, 0.01);
}

/// A jump at rest between an inflow and an extraction: depths 5 l0 before it.
void expect_hydraulic_jump(double froude, double length) {
  const double l0 = 0.01, depth = 0.05, begin = 0.8;  // [m]
  const double speed = froude * std::sqrt(g * depth);
  const double ratio = (std::sqrt(1 + 8 * squared(froude)) - 1) / 2;  // Bélanger
  const double tail = ratio * depth;
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = speed};
  settings.walls.segments = polyline({{-3 * l0, 0}, {length + 3 * l0, 0}});
  mps::Inflow<2> in({.faces = polyline({{0, 0}, {0, 6 * depth}}),
                     .velocity = {speed, 0},
                     .spacing = l0,
                     .level = depth});
  mps::Extraction<2> out({.faces = polyline({{length, 0}, {length, 3 * tail}}),
                          .velocity = {speed / ratio, 0},
                          .spacing = l0});
  mps::Outflow<2> spray(Box<2>{.upper = {inf, -depth}});
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {in.piston(), out.piston()}};
  mps::Fluid<2> water;
  fill(water, {{0, 0}, {begin, depth}}, l0, speed);
  fill(water, {{begin, 0}, {length, std::round(tail / l0) * l0}}, l0, speed / ratio);

  const Box<2> measured{{0.7 * length, 0}, {0.93 * length, inf}};
  Averages averages{.from = 3, .spacing = l0, .parts = {{.box = measured}}};
  auto simulation = simulation_of(water, settings);
  simulation.run({.until = 6, .output_every = 0.1}, in, out, spray, averages);
  EXPECT_NEAR(averages.depth(0) / tail, 1, 0.05);
  const double momentum =
      averages.parts[0].momentum / averages.outputs / (measured.upper[0] - measured.lower[0]);
  EXPECT_NEAR(momentum / (density * (g * squared(depth) / 2 + squared(speed) * depth)), 1, 0.03);
  EXPECT_EQ(spray.number(), 0u);
}

// The only tests of the momentum of a flow that breaks, and of an extraction from disordered fluid.
TEST(HydraulicJump, HasTheDepthOfBelangerAtAFroudeNumberOf2) { expect_hydraulic_jump(2, 2.4); }
TEST(HydraulicJump, HasTheDepthOfBelangerAtAFroudeNumberOf3) { expect_hydraulic_jump(3, 3); }

}  // namespace
}  // namespace silt::test::openings_slow_test
