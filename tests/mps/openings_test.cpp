// SPDX-License-Identifier: MIT
// Fluid that enters and leaves through openings.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/extraction.hpp>
#include <silt/mps/setup/inflow.hpp>
#include <silt/mps/setup/outflow.hpp>
#include <silt/mps/setup/pressure_opening.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/fluid.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace silt::test::openings_test {
namespace {

constexpr double l0 = 0.02;  // [m]
// Layers [-]: one, and what the piston moves in a step.
constexpr double most_under_way = 1.2;

/// A duct along x without gravity, of this length and width, in 3D square, full of fluid with a
/// velocity.
template <int Dim>
struct Duct {
  double length = 0.3, width = 0.1;  // [m]
  double speed = 0;                  // [m/s]

  /// Beyond both ends by two spacings.
  std::vector<Face<Dim>> walls() const {
    Box<Dim> box{.lower = Vec<Dim>::Zero(), .upper = Vec<Dim>::Constant(width)};
    box.lower[0] = -2 * l0;
    box.upper[0] = length + 2 * l0;
    std::vector<Face<Dim>> faces;
    for (const auto& face : faces_of(box)) {
      if (std::abs(normal_of(face)[0]) < 0.5) faces.push_back(face);
    }
    return faces;
  }
  /// Its section at x, as faces.
  std::vector<Face<Dim>> section(double x) const {
    if constexpr (Dim == 2) {
      return polyline({{x, 0}, {x, width}});
    } else {
      const Vec<3> a(x, 0, 0), b(x, width, 0), c(x, width, width), d(x, 0, width);
      return {{{a, b, c}}, {{a, c, d}}};
    }
  }
  auto settings() const {
    mps::FlowSettings<Dim, mps::Recommended> flow{.spacing = l0, .speed_scale = 1};
    flow.gravity.setZero();
    flow.walls.template faces<Dim>() = walls();
    return flow;
  }
  auto water() const {
    Box<Dim> box{.lower = Vec<Dim>::Zero(), .upper = Vec<Dim>::Constant(width)};
    box.upper[0] = length;
    auto fluid = fluid_at(lattice<Dim>(box, l0));
    for (auto& u : fluid[velocity]) u[0] = speed;
    return fluid;
  }
};

template <int Dim>
mps::AnyMovingWalls<Dim>& moving(mps::ImageWalls& walls) {
  if constexpr (Dim == 2) return walls.moving_2d;
  if constexpr (Dim == 3) return walls.moving_3d;
}
template <int Dim, class Settings, class Fluid>
auto simulation_of(const Fluid& fluid, const Settings& settings) {
  return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                    SemiImplicit<>{}};
}

/// A flow from an inflow to an extraction, along x.
template <int Dim>
void expect_uniform_flow() {
  const double speed = 0.5;
  const Duct<Dim> duct{.speed = speed};
  Vec<Dim> along = Vec<Dim>::Zero();
  along[0] = speed;
  mps::Inflow<Dim> in({.faces = duct.section(0), .velocity = along, .spacing = l0});
  mps::Extraction<Dim> out({.faces = duct.section(duct.length), .velocity = along, .spacing = l0});
  auto settings = duct.settings();
  moving<Dim>(settings.walls) = mps::MovingWalls<Dim>{.faces = {in.piston(), out.piston()}};
  auto simulation = simulation_of<Dim>(duct.water(), settings);
  const Index number = simulation.particles().size();

  simulation.run({.until = 0.5}, in, out);
  const double area = std::pow(duct.width, Dim - 1);
  EXPECT_DOUBLE_EQ(in.flow_at(0.2), speed * area);
  EXPECT_NEAR(in.volume(), in.flow_at(0) * simulation.time(), most_under_way * area * l0);
  EXPECT_EQ(in.number(), out.number());
  EXPECT_EQ(simulation.particles().size(), number);
  double largest_error = 0;
  for (const auto& u : simulation.particles()[velocity]) {
    largest_error = std::max(largest_error, (u - along).norm());
  }
  EXPECT_LT(largest_error, 1e-4 * speed);
  const auto& energy = simulation.interaction().energy();
  EXPECT_NEAR(energy.imbalance(), 0, 1e-12 * energy.total());
}

// The only test that a piston which goes back is, for the fluid, one that goes on: what no wall
// that moves to and fro shows.
TEST(Openings, OfGivenVelocityKeepAUniformFlowUniformIn2D) { expect_uniform_flow<2>(); }
TEST(Openings, OfGivenVelocityKeepAUniformFlowUniformIn3DSlow) { expect_uniform_flow<3>(); }

// The only test of a lattice in faces that are no rectangle along the axes, and of its volume.
TEST(Openings, OfAnyShapeLetInTheVolumeOfTheirArea) {
  std::vector<Face<3>> disc;  // of 16 sides, oblique
  const double radius = 0.1, speed = 1.6, spacing = 0.04;
  const Vec<3> normal = Vec<3>(1, 2, 2) / 3, first = Vec<3>(0, 1, -1).normalized();
  const Vec<3> second = cross(normal, first), centre(0.3, 0.1, 0);
  const auto corner = [&](int k) {
    const double angle = k * std::numbers::pi / 8;
    return Vec<3>(centre + radius * (std::cos(angle) * first + std::sin(angle) * second));
  };
  for (int k = 0; k < 16; ++k) disc.push_back({{centre, corner(k), corner(k + 1)}});
  const mps::Inflow<3> in(
      {.faces = disc, .velocity = speed * normal, .spacing = spacing, .ramp = 0.1});
  const double area = 8 * squared(radius) * std::sin(std::numbers::pi / 8);
  EXPECT_NEAR(in.flow_at(1), speed * area, 1e-12);
  EXPECT_NEAR(in.flow_at(0.05), speed * area / 2, 1e-12);

  auto settings = Duct<3>{}.settings();
  settings.spacing = spacing;
  settings.walls.triangles.clear();
  settings.walls.moving_3d = mps::MovingWalls<3>{.faces = {in.piston()}};
  auto simulation = simulation_of<3>(mps::Fluid<3>{}, settings);
  mps::Inflow<3> inflow = in;
  simulation.run({.until = 0.2}, inflow);
  EXPECT_NEAR(inflow.volume(), speed * area * (simulation.time() - 0.05), 1.5 * area * spacing);
  EXPECT_GE(inflow.volume(), 4 * 0.75 * area * spacing);
}

/// Fluid between two pressures in a duct.
template <int Dim>
void expect_acceleration_by_pressures() {
  const Duct<Dim> duct;
  const double drop = 300;  // [Pa]
  const auto opening = [&](double x, double inwards, double value) {
    typename mps::PressureOpening<Dim>::Settings settings{
        .faces = duct.section(x), .spacing = l0, .pressure = [=](const Vec<Dim>&, double) {
          return value;
        }};
    settings.inwards[0] = inwards;
    return mps::PressureOpening<Dim>(settings);
  };
  auto high = opening(0, 1, 2 * drop), low = opening(duct.length, -1, drop);
  auto settings = duct.settings();
  settings.surface_pressure = mps::surface_pressure_of(high, low);
  auto simulation = simulation_of<Dim>(duct.water(), settings);
  simulation.run({.until = 0.6}, high, low);
  const double speed = drop / 1000 / duct.length * simulation.time();
  for (const auto& u : simulation.particles()[velocity]) EXPECT_NEAR(u[0], speed, 1e-3 * speed);
  const double area = std::pow(duct.width, Dim - 1);
  EXPECT_NEAR(high.volume(), area * speed * simulation.time() / 2, area * l0);
  EXPECT_EQ(high.volume(), -low.volume());
}

// The only test of a pressure that drives a flow: u = Δp t/(ρ L), and the volume that enters.
TEST(Openings, OfGivenPressureAccelerateFluidByTheirDifferenceIn2D) {
  expect_acceleration_by_pressures<2>();
}
TEST(Openings, OfGivenPressureAccelerateFluidByTheirDifferenceIn3DSlow) {
  expect_acceleration_by_pressures<3>();
}

// The only test of a pressure that varies along an opening, and of the edge between it and the
// surface of water: with the pressure at the centres of the particles, water there churned at 0.1
// m/s.
TEST(Openings, OfHydrostaticPressureKeepWaterAtRest) {
  const Duct<2> channel{.length = 0.4, .width = 0.16};
  const auto opening = [&](double x, double inwards) {
    return mps::PressureOpening<2>({.faces = channel.section(x),
                                    .inwards = {inwards, 0},
                                    .spacing = l0,
                                    .pressure = mps::HydrostaticPressure{.level = channel.width}});
  };
  auto left = opening(0, 1), right = opening(channel.length, -1);
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = polyline({{-2 * l0, 0}, {channel.length + 2 * l0, 0}});
  settings.surface_pressure = mps::surface_pressure_of(left, right);
  auto simulation = simulation_of<2>(channel.water(), settings);
  simulation.run({.until = 0.4}, left, right);
  EXPECT_EQ(left.number_in() + left.number_out() + right.number_in() + right.number_out(), 0u);
  for (const auto& u : simulation.particles()[velocity]) EXPECT_LT(u.norm(), 2e-5);
}

/// Supercritical water from an inflow, over a brink.
struct Channel {
  mps::Inflow<2> in{{.faces = polyline({{0, 0}, {0, 0.3}}),
                     .velocity = {2, 0},
                     .spacing = l0,
                     .level = 0.1,
                     .from = 0.01,
                     .ramp = 0.02}};
  mps::Outflow<2> out{Box<2>{.lower = {0.5, -inf}}};

  auto simulation() const {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 2};
    settings.walls.segments = polyline({{-2 * l0, 0}, {0.4, 0}});
    settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {in.piston()}};
    return simulation_of<2>(mps::Fluid<2>{}, settings);
  }
};

// The only test that begins without fluid, and of what a ramp, a level and a free outflow add up
// to.
TEST(Openings, FillADryChannelWithTheVolumeOfTheInflow) {
  Channel channel;
  auto simulation = channel.simulation();
  simulation.run({.until = 0.5}, channel.in, channel.out);
  const double layer = 0.1 * l0;
  EXPECT_NEAR(channel.in.volume(), 0.1 * 2 * (simulation.time() - 0.02), most_under_way * layer);
  EXPECT_EQ(channel.in.number() - channel.out.number(), simulation.particles().size());
  EXPECT_GT(channel.out.number(), 100u);
  const auto& energy = simulation.interaction().energy();
  EXPECT_NEAR(energy.imbalance(), 0, 1e-11 * energy.total());
  // Without the observers, the water would stand still before a piston that goes to and fro.
  EXPECT_TRUE(refuses([&] { simulation.run({.until = 1}); },
                      {"mps::Inflow", "pass it to run()", "before_step(simulation)"}));
}

TEST(Openings, HaveTheSameBitsAfterRestarts) {
  const Folder folder;
  const auto make = [] {
    Channel channel;
    return RunWith(channel.simulation(), channel.in, channel.out);
  };
  const auto measured = [](const auto& run) {
    return std::vector<double>{double(std::get<0>(run.observers).number()),
                               double(std::get<1>(run.observers).number()),
                               run.simulation.interaction().energy().added};
  };
  expect_the_same_bits_after_restarts(folder.path, {.steps = 120, .number = 10}, make, measured);
}

TEST(Openings, RefuseWhatTheyCannotBe) {
  using Velocity = mps::VelocityOpening<2>;
  const Velocity good{.faces = polyline({{0, 0}, {0, 0.1}}), .velocity = {1, 0}, .spacing = l0};
  const auto refuses_change = [&](auto change, const std::vector<std::string>& fragments) {
    Velocity opening = good;
    change(opening);
    return refuses([&] { mps::Inflow<2>{opening}; }, fragments);
  };
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.faces.clear(); }, {"there are no faces"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.velocity = {0, 0}; },
                             {"velocity = (0, 0)", "no direction"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.velocity = {nan, 0}; }, {"velocity"}));
  EXPECT_TRUE(
      refuses_change([](Velocity& o) { o.velocity = {1, 1}; }, {"(1, 1)", "not normal to face 0"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.spacing = 0; }, {"spacing", "0"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.level = 0; }, {"level = 0", "raise it"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.level = nan; }, {"level", "not a number"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.level = 0.005; }, {"0.005 m", "make it wider"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.ramp = -1; }, {"ramp", "-1"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.from = inf; }, {"from"}));
  EXPECT_TRUE(refuses_change([](Velocity& o) { o.spacing = 1e-9; },
                             {"1e6 times spacing", "increase the spacing"}));
  EXPECT_TRUE(
      refuses_change([](Velocity& o) { o.faces.push_back({{Vec<2>(0.1, 0.1), Vec<2>(0.1, 0.2)}}); },
                     {"face 1", "off the plane", "its own opening"}));
  EXPECT_TRUE(refuses(
      [&] {
        Velocity opening = good;
        opening.level = 0.05;
        mps::Extraction<2>{opening};
      },
      {"level = 0.05", "Extraction", "remove it"}));
  EXPECT_TRUE(
      refuses([] { mps::Outflow<2>{Box<2>{.lower = {1, 0}, .upper = {0, 1}}}; }, {"lower = 1"}));
  EXPECT_TRUE(refuses([] { mps::Outflow<2>{Box<2>{}}; }, {"infinite on all sides", "finite side"}));

  using Pressure = mps::PressureOpening<2>;
  EXPECT_TRUE(refuses([&] { Pressure({.faces = good.faces, .inwards = {1, 0}, .spacing = l0}); },
                      {"no pressure"}));
  EXPECT_TRUE(refuses(
      [&] {
        Pressure({.faces = good.faces, .spacing = l0, .pressure = mps::HydrostaticPressure{}});
      },
      {"inwards", "no direction"}));
  EXPECT_TRUE(refuses(
      [&] {
        Pressure({.faces = good.faces,
                  .inwards = {1, 0},
                  .spacing = l0,
                  .pressure = mps::HydrostaticPressure{.level = 0.1, .density = -1000}});
      },
      {"HydrostaticPressure: density = -1000"}));
}

TEST(Openings, RefuseFlowsThatAreNotTheirs) {
  const Duct<2> duct;
  // Of another spacing.
  mps::Inflow<2> coarse({.faces = duct.section(0), .velocity = {1, 0}, .spacing = 2 * l0});
  auto settings = duct.settings();
  settings.walls.moving_2d = mps::MovingWalls<2>{.faces = {coarse.piston()}};
  auto simulation = simulation_of<2>(duct.water(), settings);
  EXPECT_TRUE(refuses([&] { simulation.run({.until = 1}, coarse); },
                      {"spacing = 0.04", "not that of the flow, 0.02"}));
  // Without its piston.
  mps::Inflow<2> open({.faces = duct.section(0), .velocity = {1, 0}, .spacing = l0});
  mps::Extraction<2> open_end({.faces = duct.section(0.3), .velocity = {1, 0}, .spacing = l0});
  auto unbounded = simulation_of<2>(duct.water(), duct.settings());
  EXPECT_TRUE(refuses([&] { unbounded.run({.until = 1}, open); },
                      {"mps::Inflow: its piston() is none of the walls", "moving_2d"}));
  EXPECT_TRUE(refuses([&] { unbounded.run({.until = 1}, open_end); },
                      {"mps::Extraction: its piston() is none of the walls", "moving_2d"}));
  // One that has missed steps.
  Channel channel;
  auto late = channel.simulation();
  late.run({.until = 0.1}, channel.in, channel.out);
  Channel other;
  EXPECT_TRUE(
      refuses([&] { late.run({.until = 1}, other.in); }, {"layers are due", "but 0 were made"}));
  // Without the pressure of the opening.
  mps::PressureOpening<2> opening({.faces = duct.section(0),
                                   .inwards = {1, 0},
                                   .spacing = l0,
                                   .pressure = mps::HydrostaticPressure{.level = 1}});
  auto without = simulation_of<2>(duct.water(), duct.settings());
  EXPECT_TRUE(
      refuses([&] { without.run({.until = 1}, opening); }, {"no FlowSettings::surface_pressure"}));
  // A pressure that is none, and a scheme that would ignore it.
  auto broken = duct.settings();
  broken.surface_pressure = [](const Vec<2>&, double) { return nan; };
  auto flow = simulation_of<2>(duct.water(), broken);
  EXPECT_TRUE(refuses([&] { flow.step(); }, {"surface_pressure = ", "not finite"}));
  mps::FlowSettings<2, mps::Case10> ignored{.spacing = l0};
  ignored.surface_pressure = [](const Vec<2>&, double) { return 1.0; };
  EXPECT_TRUE(refuses([&] { ignored.check(); }, {"surface_pressure is set", "OuterSurface"}));
}

}  // namespace
}  // namespace silt::test::openings_test
