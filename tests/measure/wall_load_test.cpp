// SPDX-License-Identifier: MIT
#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/vtk_walls.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace silt::test::wall_load_test {
namespace {

constexpr double l0 = 0.02;  // [m]
constexpr double g = 9.81;   // [m/s²]

Face<2> segment(const Vec<2>& a, const Vec<2>& b) { return {{a, b}}; }

// Water at rest in a tank of eight spacings.
template <int Dim>
auto still_tank() {
  constexpr double side = 8 * l0;
  mps::Tank<Dim> tank{.column = {side, side}, .size = {.length = side, .height = 1.5 * side},
                      .spacing = l0};
  tank.size.depth = side;
  const auto made = mps::make_tank<mps::Recommended, Dim>(tank);
  Simulation still{made.particles, UniformGrid<Dim>{},
                   mps::Flow<mps::Recommended, Dim>{
                       {.spacing = l0, .speed_scale = 1, .walls = made.walls}},
                   SemiImplicit<>{}};
  for (int k = 0; k < 5; ++k) still.step();
  return still;
}

TEST(WallLoad, IsTheHydrostaticForce) {
  constexpr double H = 8 * l0, force = 1000 * g * H * H / 2;
  const auto tank = still_tank<2>();
  const WallLoad<2> right{{segment({H, 0}, {H, H})}};
  const WallLoad<2> floor{{segment({0, 0}, {H, 0})}};
  EXPECT_NEAR(right.read(tank)[0] / force, 1, 0.02);
  EXPECT_EQ(right.read(tank)[1], 0);
  EXPECT_NEAR(floor.read(tank)[1] / (-2 * force), 1, 1e-5);
}

// Half of the floor has half of the load.
TEST(WallLoad, IsThatOfAPartOfAWall) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H;
  const auto tank = still_tank<2>();
  const WallLoad<2> half{{segment({0, 0}, {H / 2, 0})}};
  EXPECT_NEAR(half.read(tank)[1] / -weight, 0.5, 1e-5);
}

// Divided between the particles of a column, whose line passes through the common end.
TEST(WallLoad, IsDividedAmongPartsOfAWall) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H;
  const auto tank = still_tank<2>();
  const Vec<2> a{0, 0}, b{2.5 * l0, 0}, c{H, 0};
  const double left = WallLoad<2>{{segment(a, b)}}.read(tank)[1];
  const double right = WallLoad<2>{{segment(b, c)}}.read(tank)[1];
  EXPECT_NEAR((left + right) / -weight, 1, 1e-5);
}

// Corners in single precision, of which the flow takes the faces to be in one plane.
TEST(WallLoad, DoesNotDependOnTheOrderOfFaces) {
  constexpr double side = 8 * l0;
  const auto rounded = [](double x, double y) { return Vec<2>(double(float(x)), double(float(y))); };
  const auto slope = [&](double x) { return rounded(10 + x, 10.1 - 0.3 * x); };
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = polyline({{10, 10.5}, {10, 10.1}, slope(0.05), slope(0.11), slope(side),
                                      slope(side) + Vec<2>(0, 0.5)});
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({{10, 10.1}, {10 + side, 10.2}}, l0)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  sim.step();
  auto faces = settings.walls.segments;
  const Vec<2> all = WallLoad<2>(faces).read(sim);
  Vec<2> sum = Vec<2>::Zero();
  for (const auto& face : faces) sum += WallLoad<2>{{face}}.read(sim);
  std::ranges::reverse(faces);
  EXPECT_NEAR((WallLoad<2>(faces).read(sim) - all).norm() / all.norm(), 0, 1e-9);
  EXPECT_NEAR((sum - all).norm() / all.norm(), 0, 1e-9);
}

TEST(WallLoad, IsThatOfTheLastStepThatSucceeded) {
  auto tank = still_tank<2>();
  const WallLoad<2> walls{tank.interaction().settings().walls.segments};
  const Vec<2> before = walls.read(tank);
  EXPECT_THROW(tank.step(1), Error);
  EXPECT_EQ(walls.read(tank), before);
  checkpoint::Writer writer;
  auto copy = tank;
  checkpoint::transfer_all(writer, copy);
  checkpoint::restore({.file = "memory"}, std::move(writer).finish(), tank);
  EXPECT_EQ(walls.read(tank), (Vec<2>::Zero()));  // of a step that it knows nothing of
}

TEST(WallLoad, IsTheHydrostaticForceIn3D) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H * H;
  const auto tank = still_tank<3>();
  // Particles are below the diagonal of the floor, which both triangles have.
  const Vec<3> a{0, 0, 0}, b{H, 0, 0}, c{H, H, 0}, d{0, H, 0};
  const WallLoad<3> floor{std::vector<Face<3>>{{{a, b, c}}, {{a, c, d}}}};
  EXPECT_NEAR(floor.read(tank)[2] / -weight, 1, 1e-5);
}

TEST(WallLoad, IsOfTheSideOfTheNormalsOnly) {
  constexpr double H = 8 * l0;
  const auto tank = still_tank<2>();
  const WallLoad<2> outside{{segment({H, H}, {H, 0})}};
  EXPECT_EQ(outside.read(tank)[0], 0);
}

// A drop that a wall stops by collisions has no pressure. Above the common edge of two triangles, it
// counts once.
TEST(WallLoad, IncludesCollisions) {
  const double dt = 1e-3;
  mps::FlowSettings<3, mps::Recommended> settings{
      .spacing = l0, .viscosity = 0, .gravity = Vec<3>::Zero()};
  const Vec<3> a{0, 0, 0}, b{1, 0, 0}, c{1, 1, 0}, d{0, 1, 0};
  settings.walls.triangles = {{{a, b, c}}, {{a, c, d}}};
  mps::Fluid<3> drop;
  mps::add_particle(drop, {0.5, 0.5, 0.5 * l0}, mps::Kind::fluid);
  drop[velocity][0] = {0, 0, -5};
  Simulation impact{drop, UniformGrid<3>{}, mps::Flow<mps::Recommended, 3>{settings},
                    SemiImplicit<>{}};
  const WallLoad<3> wall(settings.walls.triangles);
  EXPECT_EQ(wall.read(impact), (Vec<3>::Zero()));
  impact.step(dt);
  const double stopped = impact.particles()[velocity][0][2] + 5;
  EXPECT_GT(stopped, 1);
  EXPECT_NEAR(wall.read(impact)[2] * dt / (-1000 * l0 * l0 * l0 * stopped), 1, 1e-12);
}

// Walls oblique to each other and to the axes, a block, and a periodic channel with a block: all that
// changes the momentum of the fluid, apart from gravity, is the load of the walls.
template <int Dim>
void expect_all_momentum(mps::FlowSettings<Dim, mps::Recommended> settings,
                         const mps::Fluid<Dim>& fluid) {
  settings.viscosity = 0;
  Simulation water{fluid, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                   SemiImplicit<>{}};
  const WallLoad<Dim> load(settings.walls.template faces<Dim>());
  const auto momentum = [&] {
    Vec<Dim> sum = Vec<Dim>::Zero();
    for (const auto& u : water.particles()[velocity]) sum += 1000 * std::pow(l0, Dim) * u;
    return sum;
  };
  const double mass = 1000 * std::pow(l0, Dim) * double(fluid.size());
  double largest = 0;
  for (int k = 0; k < 40; ++k) {
    const Vec<Dim> before = momentum();
    water.step();
    const Vec<Dim> force = (momentum() - before) / water.last_time_step() - mass * settings.gravity;
    EXPECT_LT((load.read(water) + force).norm(), 1e-9 * mass * g) << k;
    largest = std::max(largest, force.norm());
  }
  EXPECT_GT(largest, 0.1 * mass * g);
}
TEST(WallLoad, OfAllWallsIsAllThatChangesTheMomentum) {
  mps::FlowSettings<2, mps::Recommended> valley{.spacing = l0, .speed_scale = 1};
  valley.walls.segments = polyline({{-0.4, 0.4}, {-0.1, 0}, {0.1, 0}, {0.3, 0.6}});
  for (const auto& face : polyline({{-0.03, 0.1}, {0, 0.2}, {0.04, 0.12}, {-0.03, 0.1}})) {
    valley.walls.segments.push_back(face);
  }
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({{-0.08, 0.01}, {0.1, 0.09}}, l0)) {
    mps::add_particle(water, x, mps::Kind::fluid);
  }
  expect_all_momentum<2>(valley, water);

  mps::FlowSettings<2, mps::Recommended> channel{.spacing = l0, .gravity = {2, -g}, .speed_scale = 1};
  channel.walls.segments =
      polyline({{-0.1, 0}, {0.2, 0}, {0.2, 0.4}, {0.24, 0.4}, {0.24, 0}, {0.5, 0}});
  mps::Fluid<2> stream;
  stream.set_box({.lower = {0, -1}, .upper = {0.4, 1}, .periodic = {true, false}});
  for (const auto& x : lattice<2>({{0.24, 0}, {0.4, 0.12}}, l0)) {
    mps::add_particle(stream, x, mps::Kind::fluid);
  }
  expect_all_momentum<2>(channel, stream);

  mps::FlowSettings<3, mps::Recommended> tank{.spacing = l0, .speed_scale = 1};
  tank.walls.triangles = faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {0.24, 0.12, 0.3}});
  mps::Fluid<3> column;
  for (const auto& x : lattice<3>({{0, 0, 0}, {0.12, 0.12, 0.16}}, l0)) {
    mps::add_particle(column, x, mps::Kind::fluid);
  }
  expect_all_momentum<3>(tank, column);
}

// The torque of a known pressure, which no other test has: the resultant is at a third of the
// height.
TEST(WallLoad, HasTheTorqueOfTheHydrostaticPressure) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H;
  const auto tank = still_tank<2>();
  const WallLoad<2> right{{segment({H, 0}, {H, H})}};
  EXPECT_NEAR(right.read(tank, {H, 0}).torque / (-weight * H / 6), 1, 0.02);
  EXPECT_NEAR(right.read(tank, {H, H / 3}).torque / (-weight * H / 6), 0, 0.02);
  const WallLoad<2> floor{{segment({0, 0}, {H, 0})}};
  EXPECT_NEAR(floor.read(tank, {0, 0}).torque / (-weight * H / 2), 1, 1e-5);
  EXPECT_NEAR(floor.read(tank, {H / 2, 0}).torque / (-weight * H / 2), 0, 1e-5);
}
TEST(WallLoad, HasTheTorqueOfTheHydrostaticPressureIn3D) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H * H;
  const auto tank = still_tank<3>();
  const WallLoad<3> floor{
      faces_of(Box<3>{.lower = {0, 0, 0}, .upper = {H, H, H}},
               {.lower = {false, false, true}, .upper = {false, false, false}})};
  const auto load = floor.read(tank, {0, 0, 0});
  EXPECT_NEAR(load.torque[0] / (-weight * H / 2), 1, 1e-5);
  EXPECT_NEAR(load.torque[1] / (weight * H / 2), 1, 1e-5);
  EXPECT_NEAR(load.torque[2] / weight / H, 0, 1e-9);
}

// The load of walls that move, given as a group or as faces where they are defined.
TEST(WallLoad, IsThatOfWallsThatMove) {
  constexpr double H = 8 * l0, weight = 1000 * g * H * H;
  auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {H, H}, .size = {.length = H, .height = 2 * H}, .spacing = l0});
  const auto faces = std::exchange(tank.walls.segments, {});
  const double speed = 0.7;
  tank.walls.moving_2d = mps::MovingWalls<2>{.faces = {{.faces = faces, .motion = Translation<2>{{speed, 0}}}}};
  for (Index i = 0; i < tank.particles.size(); ++i) tank.particles[velocity][i] = {speed, 0};
  Simulation sim{
      tank.particles, UniformGrid<2>{},
      mps::Flow<mps::Recommended>{{.spacing = l0, .speed_scale = 1, .walls = tank.walls}},
      SemiImplicit<>{}};
  while (sim.time() < 0.1) sim.step();
  const auto all = WallLoad<2>::of_all_walls().read(sim);
  const auto group = WallGroup::moving_faces(0);
  EXPECT_NEAR(all[1] / -weight, 1, 1e-4);
  EXPECT_EQ(WallLoad<2>{group}.read(sim), all);
  EXPECT_NEAR((WallLoad<2>(faces, group).read(sim) - all).norm() / weight, 0, 1e-9);
  const WallLoad<2> right{{segment({H, 0}, {H, H})}, group};
  EXPECT_NEAR(right.read(sim)[0] / (weight / 2), 1, 0.02);
  const double shift = speed * (sim.time() - sim.last_time_step());
  EXPECT_NEAR(right.read(sim, {H + shift, 0}).torque / (-weight * H / 6), 1, 0.02);
  EXPECT_EQ(WallLoad<2>{WallGroup{}}.read(sim), (Vec<2>::Zero()));  // there are none at rest
}
// What a body gains is the load that is read.
TEST(WallLoad, OfABodyIsWhatMovesIt) {
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = polyline({{0, 0.6}, {0, 0}, {0.4, 0}, {0.4, 0.6}});
  const Box<2> box{.lower = {0.14, 0.14}, .upper = {0.26, 0.26}};
  auto faces = faces_of(box);
  for (auto& face : faces) face = reversed(face);
  settings.walls.moving_2d = mps::MovingWalls<2>{.bodies = {{.faces = faces, .density = 500}}};
  mps::Fluid<2> water;
  for (const auto& x : lattice<2>({{0, 0}, {0.4, 0.2}}, l0)) {
    if (!box.contains(x)) mps::add_particle(water, x, mps::Kind::fluid);
  }
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  const double mass = 500 * 0.12 * 0.12;
  for (int k = 0; k < 20; ++k) {
    const auto body_of = [&]() -> const auto& { return sim.interaction().walls().bodies()[0]; };
    const Vec<2> before = body_of().momentum();
    sim.step();
    const Vec<2> force =
        (body_of().momentum() - before) / sim.last_time_step() - mass * Vec<2>(0, -g);
    const auto group = WallGroup::body(0);
    EXPECT_LT((WallLoad<2>{group}.read(sim) - force).norm(), 1e-9 * mass * g);
    EXPECT_LT((WallLoad<2>{faces, group}.read(sim) - force).norm(), 1e-9 * mass * g);
    const Vec<2> all = WallLoad<2>::of_all_walls().read(sim);
    EXPECT_LT((all - force - WallLoad<2>{WallGroup{}}.read(sim)).norm(), 1e-9 * mass * g);
    // The same in frames for ParaView.
    const auto loads =
        sim.interaction().loads_on_moving_walls(sim.particles(), sim.last_time_step());
    ASSERT_EQ(loads.size(), 1u);
    EXPECT_LT((loads[0].force - force).norm(), 1e-9 * mass * g);
    EXPECT_NE(vtk_frame_of_walls(sim.interaction().walls(), loads).find("Name=\"torque\""),
              std::string::npos);
  }
}

TEST(WallLoad, RefusesGroupsThatAreNone) {
  const auto tank = still_tank<2>();
  EXPECT_TRUE(refuses([&] { WallLoad<2>{WallGroup::body(0)}.read(tank); },
                      {"WallLoad", "body(0)", "0 bodies"}));
  EXPECT_TRUE(refuses([&] { WallLoad<2>{WallGroup::moving_faces(3)}.read(tank); },
                      {"WallLoad", "moving_faces(3)", "0 groups"}));
  EXPECT_TRUE(refuses([&] { WallLoad<2>::of_all_walls().read(tank, {nan, 0}); },
                      {"WallLoad: about", "nan"}));
}

TEST(WallLoad, RefusesFacesThatAreNoWalls) {
  const auto tank = still_tank<2>();
  EXPECT_TRUE(refuses([&] { WallLoad<2>{std::vector<Face<2>>{}}; }, {"WallLoad: no faces"}));
  EXPECT_TRUE(refuses([&] { WallLoad<2>{{segment({1, 1}, {1, 1})}}; }, {"WallLoad: face 0"}));
  const WallLoad<2> inside{{segment({0, 3.6 * l0}, {8 * l0, 3.6 * l0})}};
  EXPECT_TRUE(refuses([&] { inside.read(tank); }, {"WallLoad: a face is not on a wall"}));
}

}  // namespace
}  // namespace silt::test::wall_load_test
