// SPDX-License-Identifier: MIT
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include <Eigen/Geometry>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/fluid.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace silt::test::image_walls_test {
namespace {

struct Mirrored : mps::RecommendedForWallParticles {
  mps::ImageWalls walls{};
};
using Settings2D = mps::FlowSettings<2, Mirrored>;
using Settings3D = mps::FlowSettings<3, Mirrored>;
static_assert(mps::WallModel<mps::ImageWalls>);
static_assert(mps::AddsImages<mps::ImageWalls::InFlow<3, float>>);
static_assert(mps::HidesNeighbours<mps::ImageWalls::InFlow<2, double>>);
static_assert(!mps::HidesNeighbours<mps::SmoothWalls::InFlow<2, double>>);
static_assert(mps::ContinuesFlow<mps::ImageWalls::InFlow<3, float>>);
static_assert(!mps::ContinuesFlow<mps::SmoothWalls::InFlow<2, double>>);

constexpr double l0 = 0.02;  // [m]
constexpr double g = 9.81;   // [m/s²]

std::vector<Face<2>>& faces_of(mps::ImageWalls& walls, const Vec<2>&) { return walls.segments; }
std::vector<Face<3>>& faces_of(mps::ImageWalls& walls, const Vec<3>&) { return walls.triangles; }

/// Water and its walls, to be turned together with gravity.
template <int Dim>
struct Scene {
  std::vector<Face<Dim>> walls;
  std::vector<Vec<Dim>> water;
  double surface;  // height [m]

  /// At rest, with the pressure of its depth, after a turn.
  template <class Turn>
  auto simulation(double spacing, const Turn& turn) const {
    mps::FlowSettings<Dim, Mirrored> settings{.spacing = spacing, .speed_scale = 2};
    settings.gravity = turn(settings.gravity);
    auto& faces = faces_of(settings.walls, Vec<Dim>());
    faces = walls;
    for (auto& face : faces) {
      for (auto& corner : face.corners) corner = turn(corner);
    }
    mps::Fluid<Dim> fluid;
    for (const auto& x : water) {
      const Index i = mps::add_particle(fluid, turn(x), mps::Kind::fluid);
      fluid[mps::pressure][i] = 1000 * g * (surface - spacing / 2 - x[Dim - 1]);
    }
    return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<Mirrored, Dim>{settings},
                      SemiImplicit<>{}};
  }
};

Scene<2> tank_with_a_block() {
  Scene<2> scene{
      .walls = polyline(
          {{0, 1}, {0, 0}, {0.2, 0}, {0.2, 0.1}, {0.3, 0.1}, {0.3, 0}, {0.4, 0}, {0.4, 1}}),
      .water = {},
      .surface = 0.2};
  for (const auto& x : lattice<2>({{0, 0}, {0.4, 0.2}}, l0)) {
    if (x[0] < 0.2 || x[0] > 0.3 || x[1] > 0.1) scene.water.push_back(x);
  }
  return scene;
}

Scene<3> tank_in_3d(double spacing) {
  const Box<3> box{.lower = {0, 0, 0}, .upper = {6 * spacing, 5 * spacing, 6 * spacing}};
  return {.walls = silt::faces_of(Box<3>{.lower = box.lower, .upper = 2 * box.upper - box.lower},
                                  Sides<3>{.lower = {true, true, true}, .upper = {}}),
          .water = lattice<3>(box, spacing),
          .surface = box.upper[2]};
}

template <int Dim, class Sim>
void expect_rest(Sim sim, double spacing, double height) {
  for (int k = 0; k < 50; ++k) sim.step();
  const auto& water = sim.particles();
  const Vec<Dim> up = -sim.interaction().settings().gravity / g;
  for (Index i = 0; i < water.size(); ++i) {
    EXPECT_LT(water[velocity][i].norm(), 1e-9);
    const double depth = height - spacing / 2 - up.dot(water[position][i]);
    EXPECT_NEAR(water[mps::pressure][i], 1000 * g * depth, 1e-6);
  }
}

TEST(ImageWalls, KeepWaterAtRestBesideABlockAtAnyAngle) {
  for (const double angle : {0.0, 0.3, 2.5}) {
    const Eigen::Rotation2Dd rotation(angle);
    const auto turn = [&](const Vec<2>& x) -> Vec<2> { return rotation * x; };
    expect_rest<2>(tank_with_a_block().simulation(l0, turn), l0, 0.2);
  }
}

TEST(ImageWalls, KeepWaterAtRestInATankIn3D) {
  const Eigen::AngleAxisd rotation(0.7, Vec<3>(1, 2, 3).normalized());
  auto scene = tank_in_3d(l0);
  const Box<3> box{.lower = {0, 0, 0}, .upper = {6 * l0, 5 * l0, 1}};
  scene.walls = silt::faces_of(box, Sides<3>::open());
  for (const bool is_turned : {false, true}) {
    const auto turn = [&](const Vec<3>& x) -> Vec<3> { return is_turned ? rotation * x : x; };
    expect_rest<3>(scene.simulation(l0, turn), l0, scene.surface);
  }
}

// The plate hides particles whose images in the floor are seen below its end.
TEST(ImageWalls, ShowImagesOfHiddenParticles) {
  Settings2D settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.4, 0}, {0.4, 1}});
  settings.walls.segments.push_back({{Vec<2>(0.2, 0.4 * l0), Vec<2>(0.2, 1)}});
  Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.4, 0.2}}, l0)), UniformGrid<2>{},
                 mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  sim.step(1e-6);
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    if (water[position][i][1] > 6 * l0) continue;
    EXPECT_NEAR(water[mps::number_density][i] / sim.interaction().stencil().n0, 1, 1e-6);
  }
}

// Two sides of a wall without thickness, with water at different heights.
TEST(ImageWalls, SeparateWaterOnTheirTwoSides) {
  mps::Fluid<2> fluid;
  const auto fill = [&](const Box<2>& box) {
    for (const auto& x : lattice<2>(box, l0)) {
      const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
      fluid[mps::pressure][i] = 1000 * g * (box.upper[1] - l0 / 2 - x[1]);
    }
  };
  fill({{0, 0}, {0.1, 0.2}});
  fill({{0.1, 0}, {0.2, 0.1}});
  Settings2D settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.2, 0}, {0.2, 1}});
  settings.walls.segments.push_back({{Vec<2>(0.1, 0), Vec<2>(0.1, 1)}});
  Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step();
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_LT(sim.particles()[velocity][i].norm(), 1e-9);
  }
}

// Water that falls on a floor is stopped in one step. The upper rows are near the free surface.
TEST(ImageWalls, StopAnImpactInOneStep) {
  auto water = fluid_at(lattice<2>({{0, 0}, {0.4, 0.2}}, l0));
  for (Index i = 0; i < water.size(); ++i) water[velocity][i] = {0, -1};
  Settings2D settings{.spacing = l0, .gravity = {0, 0}, .speed_scale = 1};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.4, 0}, {0.4, 1}});
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  sim.step(5e-4);  // too short for collisions
  const auto& after = sim.particles();
  for (Index i = 0; i < after.size(); ++i) {
    if (after[position][i][1] > 7 * l0) continue;
    EXPECT_LT(std::abs(after[velocity][i][1]), 1e-3) << after[position][i].transpose();
  }
}

// The same across periodic sides, where particles have ghosts.
template <int Dim>
void expect_an_impact_in_a_periodic_box() {
  constexpr Index across = 8;
  Box<Dim> box{.lower = Vec<Dim>::Zero(), .upper = Vec<Dim>::Constant(across * l0)};
  const std::vector<Vec<Dim>> places = lattice<Dim>(box, l0);
  box.lower[Dim - 1] = -1;
  box.upper[Dim - 1] = 1;
  for (int k = 0; k + 1 < Dim; ++k) box.periodic[std::size_t(k)] = true;
  auto water = fluid_at(places, box);
  for (Index i = 0; i < water.size(); ++i) water[velocity][i] = -Vec<Dim>::Unit(Dim - 1);
  mps::FlowSettings<Dim, Mirrored> settings{.spacing = l0, .speed_scale = 1};
  settings.gravity.setZero();
  if constexpr (Dim == 2) {
    settings.walls.segments = polyline({{-1, 0}, {1, 0}});
  } else {
    settings.walls.triangles = {{{Vec<3>(-3, -2, 0), {3, -3, 0}, {3, 4, 0}}},
                                {{Vec<3>(-3, -2, 0), {3, 4, 0}, {-3, 3, 0}}}};
  }
  Simulation sim{water, UniformGrid<Dim>{}, mps::Flow<Mirrored, Dim>{settings}, SemiImplicit<>{}};
  sim.step(5e-4);
  for (Index i = 0; i < places.size(); ++i) {
    if (sim.particles()[position][i][Dim - 1] > 4 * l0) continue;
    EXPECT_LT(sim.particles()[velocity][i].norm(), 1e-2);
  }
}
TEST(ImageWalls, StopAnImpactInAPeriodicBox) {
  expect_an_impact_in_a_periodic_box<2>();
  expect_an_impact_in_a_periodic_box<3>();
}

// Near a stagnation point: what flows aside makes room for what comes.
TEST(ImageWalls, LetWaterComeThatFlowsAside) {
  const Eigen::Rotation2Dd rotation(0.4);
  const auto turn = [&](const Vec<2>& x) -> Vec<2> { return rotation * x; };
  const auto flow = [](const Vec<2>& x) -> Vec<2> { return {x[0], -x[1]}; };  // [m/s], x in m
  const auto places = lattice<2>({{-0.2, 0}, {0.2, 0.2}}, l0);
  auto water = fluid_at(std::vector<Vec<2>>{});
  for (const auto& x : places) {
    const Index i = mps::add_particle(water, turn(x), mps::Kind::fluid);
    water[velocity][i] = turn(flow(x));
  }
  Settings2D settings{.spacing = l0, .gravity = {0, 0}, .speed_scale = 1};
  settings.walls.segments = polyline({turn({-1, 0}), turn({1, 0})});
  Simulation sim{water, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  sim.step(1e-4);
  for (Index i = 0; i < places.size(); ++i) {
    if (std::abs(places[i][0]) > 0.1 || places[i][1] > 0.1) continue;
    EXPECT_LT((sim.particles()[velocity][i] - turn(flow(places[i]))).norm(), 1e-3);
  }
}

TEST(ImageWalls, LetWaterSlipAlongAnObliqueChannel) {
  const Eigen::Rotation2Dd rotation(0.4);
  const auto turn = [&](const Vec<2>& x) -> Vec<2> { return rotation * x; };
  mps::Fluid<2> fluid;
  for (const auto& x : lattice<2>({{0, 0}, {0.4, 0.1}}, l0)) {
    const Index i = mps::add_particle(fluid, turn(x), mps::Kind::fluid);
    fluid[velocity][i] = turn({1, 0});
  }
  Settings2D settings{.spacing = l0, .gravity = {0, 0}, .speed_scale = 1};
  settings.walls.segments = polyline({turn({-1, 0}), turn({2, 0})});
  settings.walls.segments.push_back({{turn({-1, 0.1}), turn({2, 0.1})}});
  Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  for (int k = 0; k < 30; ++k) sim.step();
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_LT((sim.particles()[velocity][i] - turn({1, 0})).norm(), 1e-9);
  }
}

Settings2D dam_break() {
  Settings2D settings{.spacing = l0, .speed_scale = 2};
  settings.walls.segments =
      polyline({{0, 1}, {0, 0}, {0.3, 0}, {0.3, 0.06}, {0.36, 0.06}, {0.36, 0}, {0.6, 0},
                {0.6, 1}});
  return settings;
}

// Over a block and against a wall: nothing is lost, energy does not grow, volume is kept.
TEST(ImageWalls, HoldADamBreakOverABlock) {
  Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.2, 0.3}}, l0)), UniformGrid<2>{},
                 mps::Flow<Mirrored>{dam_break()}, SemiImplicit<>{}};
  sim.step();
  const auto energy = [&] {
    const auto& now = sim.interaction().energy();
    return now.kinetic + now.potential;
  };
  const double first = energy();
  while (sim.time() < 0.8) {
    sim.step();
    ASSERT_LT(energy(), 1.01 * first) << sim.time();
  }
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    const Vec<2> x = water[position][i];
    EXPECT_TRUE(x[0] > 0 && x[0] < 0.6 && x[1] > 0) << x.transpose();
    EXPECT_FALSE(x[0] > 0.3 && x[0] < 0.36 && x[1] < 0.06) << x.transpose();
    // Single particles of the splash, in eight starts that differ by round-off: at most 1.44.
    EXPECT_LT(water[mps::number_density][i], 1.5 * sim.interaction().stencil().n0);
  }
}

TEST(ImageWalls, GiveTheSameBitsForAnyNumberOfThreads) {
  const auto run = [](auto sim) {
    for (int k = 0; k < 8; ++k) sim.step();
    return state_of(sim.particles());
  };
  Settings2D settings{.spacing = 0.004, .speed_scale = 2};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.6, 0.1}, {0.6, 1}});
  std::vector<Vec<2>> points;
  for (const auto& x : lattice<2>({{0, 0}, {0.3, 0.3}}, 0.004)) {
    if (x[1] > x[0] / 6 + 0.002) points.push_back(x);
  }
  const auto make = [&] {
    return Simulation{fluid_at(points), UniformGrid<2>{}, mps::Flow<Mirrored>{settings},
                      SemiImplicit<>{}};
  };
  const Bytes serial = with_threads(1, [&] { return run(make()); });
  EXPECT_TRUE(with_threads(2, [&] { return run(make()); }) == serial);
  EXPECT_TRUE(with_threads(3, [&] { return run(make()); }) == serial);
}

using ImageWallsRestarted = FileTest;

TEST_F(ImageWallsRestarted, KeepTheBits) {
  const auto make = [&] {
    return RunWith{Simulation{fluid_at(lattice<2>({{0, 0}, {0.2, 0.3}}, l0)), UniformGrid<2>{},
                              mps::Flow<Mirrored>{dam_break()}, SemiImplicit<>{}}};
  };
  const auto measured = [](const auto& run) {
    const mps::FlowEnergy& energy = run.simulation.interaction().energy();
    return std::vector{energy.kinetic, energy.by_pressure, energy.by_collision, energy.added};
  };
  expect_the_same_bits_after_restarts(path, {.steps = 60, .number = 10}, make, measured);
}

TEST(ImageWalls, HoldParticlesThatDoNotCollide) {
  struct WithoutCollisions : Mirrored {
    mps::Collision collision{.distance = 0};
  };
  mps::FlowSettings<2, WithoutCollisions> settings{.spacing = l0, .gravity = {0, 0}};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {1, 0}});
  auto drop = fluid_at(std::vector<Vec<2>>{{0.45 * l0, 0.45 * l0}});
  drop[velocity][0] = {-0.7, -1};
  Simulation sim{drop, UniformGrid<2>{}, mps::Flow<WithoutCollisions>{settings}, SemiImplicit<>{}};
  sim.step(0.5 * l0);
  const Vec<2> end(0.35 * l0, 0.35 * l0);
  EXPECT_LT((sim.particles()[position][0] - end).norm(), 1e-15);
}

// A source that moves the particles with u* does not know of walls.
TEST(ImageWalls, RefuseAParticleThatWentThroughThem) {
  struct Moved : Mirrored {
    mps::DensitySource source{};
    mps::Collision collision{.distance = 0};
  };
  mps::FlowSettings<2, Moved> settings{.spacing = l0, .gravity = {0, 0}};
  settings.walls.segments = polyline({{-1, 0}, {1, 0}});
  auto drop = fluid_at(std::vector<Vec<2>>{{0, 0.3 * l0}});
  drop[velocity][0] = {0, -1};
  Simulation sim{drop, UniformGrid<2>{}, mps::Flow<Moved>{settings}, SemiImplicit<>{}};
  const auto message = "ImageWalls: a particle went through a wall";
  EXPECT_TRUE(refuses([&] { sim.step(0.5 * l0); }, {message, "particle 0"}));
  EXPECT_EQ(sim.particles()[position][0], Vec<2>(0, 0.3 * l0));
  sim.step(0.1 * l0);

  // Ghosts, which are made anew within a step, change nothing of this.
  Box<2> box{.lower = {-4 * l0, -1}, .upper = {4 * l0, 1}};
  box.periodic[0] = true;
  auto in_box = fluid_at(std::vector<Vec<2>>{{0, 0.3 * l0}}, box);
  in_box[velocity][0] = {0, -1};
  Simulation periodic{in_box, UniformGrid<2>{}, mps::Flow<Moved>{settings}, SemiImplicit<>{}};
  EXPECT_TRUE(refuses([&] { periodic.step(0.5 * l0); }, {message, "particle 0"}));
}

// Water on a floor that is a million times as long as a spacing, and before walls at 45°.
TEST(ImageWalls, MayBeMuchLargerThanTheFluid) {
  Settings2D settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = polyline({{-1e5, 1e5}, {0, 0}, {1e5, 0}});
  mps::Fluid<2> fluid;
  for (const auto& x : lattice<2>({{l0, 0}, {6 * l0, 4 * l0}}, l0)) {
    mps::add_particle(fluid, x, mps::Kind::fluid);
  }
  Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  for (int k = 0; k < 20; ++k) sim.step();
  for (Index i = 0; i < fluid.size(); ++i) EXPECT_GT(sim.particles()[position][i][1], 0.2 * l0);
}

TEST(ImageWalls, RefuseFacesOfTheOtherDimension) {
  const Settings2D in_2d{.spacing = l0,
                         .walls = {.segments = {},
                                   .triangles = silt::faces_of(Box<3>{.lower = {0, 0, 0},
                                                                      .upper = {1, 1, 1}})}};
  EXPECT_TRUE(refuses([&] { mps::Flow<Mirrored>{in_2d}; },
                      {"ImageWalls: triangles = 12 faces in a flow in 2D", "are segments"}));
  const Settings3D in_3d{.spacing = l0,
                         .walls = {.segments = polyline({{0, 0}, {1, 0}}), .triangles = {}}};
  EXPECT_TRUE(refuses([&] { mps::Flow<Mirrored, 3>{in_3d}; },
                      {"ImageWalls: segments = 1 faces in a flow in 3D", "are triangles"}));
}

TEST(ImageWalls, RefuseWallParticlesAndInvalidFaces) {
  auto fluid = fluid_at(lattice<2>({{0, 0}, {0.1, 0.1}}, l0));
  mps::add_particle(fluid, {0.05, -0.01}, mps::Kind::wall);
  Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<Mirrored>{Settings2D{.spacing = l0}},
                 SemiImplicit<>{}};
  EXPECT_TRUE(refuses([&] { sim.step(); }, {"ImageWalls: a particle is of a wall", "remove"}));

  Settings2D settings{.spacing = l0};
  settings.walls.segments = polyline({{-1, 0}, {1, 0}});
  Simulation on_wall{fluid_at(std::vector<Vec<2>>{{0, 1e-4 * l0}}), UniformGrid<2>{},
                     mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  EXPECT_TRUE(refuses([&] { on_wall.step(1e-3); }, {"ImageWalls: a particle at", "from a wall"}));

  Box<2> box{.lower = {-1, -1}, .upper = {1, 1}};
  box.periodic[0] = true;
  Simulation at_side{fluid_at(lattice<2>({{0, 0}, {0.1, 0.1}}, l0), box), UniformGrid<2>{},
                     mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  EXPECT_TRUE(refuses([&] { at_side.step(1e-3); }, {"ImageWalls: a wall ends at", "periodic"}));

  settings.walls.segments = polyline({{0, 0}, {0, 0}});
  EXPECT_TRUE(refuses([&] { mps::Flow<Mirrored>{settings}; }, {"ImageWalls: face 0"}));
  Settings3D in_3d{.spacing = l0};
  in_3d.walls.triangles = {{{Vec<3>(0, 0, 0), {1, 1, 1}, {inf, 2, 2}}}};
  EXPECT_TRUE(refuses([&] { mps::Flow<Mirrored, 3>{in_3d}; }, {"ImageWalls: face 0", "inf"}));
}

// --- a start -------------------------------------------------------------------------------------

// Without gravity along the only axis that ends, nothing has to hold the fluid.
TEST(ImageWalls, MustBeGivenIfGravityPullsTheFluid) {
  const auto step = [](Settings2D settings, const Box<2>& box) {
    settings.spacing = l0;
    Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.2, 0.2}}, l0), box), UniformGrid<2>{},
                   mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
    sim.step(1e-4);
  };
  const Box<2> bounded{.lower = {0, -1}, .upper = {0.2, 1}};
  auto remove = bounded;
  remove.on_escape = OnEscape::remove;
  auto periodic = bounded;
  periodic.periodic = {true, false};
  for (const auto& box : {Box<2>{}, bounded, remove, periodic}) {
    EXPECT_TRUE(refuses([&] { step({}, box); },
                        {"ImageWalls: there are no faces", "gravity = (0, -9.81) m/s²",
                         "give FlowSettings::walls", "let_fluid_fall"}));
    EXPECT_NO_THROW(step({.walls = {.let_fluid_fall = true}}, box));
    EXPECT_NO_THROW(step({.gravity = {0, 0}}, box));
  }
  EXPECT_NO_THROW(step({.gravity = {2, 0}}, periodic));
  EXPECT_TRUE(refuses([&] { step({.gravity = {2, -1}}, periodic); }, {"there are no faces"}));
  // Walls of particles are no faces, and fluid without them may be meant to fall.
  Simulation drop{fluid_at(lattice<2>({{0, 0}, {0.2, 0.2}}, l0)), UniformGrid<2>{},
                  mps::Flow<mps::RecommendedForWallParticles>{{.spacing = l0}}, SemiImplicit<>{}};
  EXPECT_NO_THROW(drop.step(1e-4));
}

// Fluid beside a tank and below it, in the box and without one; and what may begin.
TEST(ImageWalls, RefuseFluidThatBeginsBehindThem) {
  const auto step = [](const std::vector<Vec<2>>& points, const Vec<2>& u = {0, 0},
                       bool let_fluid_fall = false) {
    auto water = fluid_at(lattice<2>({{0, 0}, {0.2, 0.2}}, l0),
                          Box<2>{.lower = {-1, -1}, .upper = {1, 1}});
    for (const auto& x : points) {
      const Index i = mps::add_particle(water, x, mps::Kind::fluid);
      water[velocity][i] = u;
    }
    Settings2D settings{.spacing = l0, .speed_scale = 1};
    settings.walls.segments = polyline({{0, 0.4}, {0, 0}, {0.4, 0}, {0.4, 0.4}});
    settings.walls.let_fluid_fall = let_fluid_fall;
    Simulation sim{water, UniformGrid<2>{}, mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
    sim.step(1e-4);
    sim.particles()[position][sim.particles().size() - 1] = {0.7, 0.7};
    EXPECT_NO_THROW(sim.step(1e-4)) << "later than in the first step";
  };
  const auto behind = lattice<2>({{0.4, 0}, {0.5, 0.2}}, l0);
  EXPECT_TRUE(refuses([&] { step(behind); },
                      {"ImageWalls: the fluid at (0.41, 0.01) m is at rest and has no wall below it",
                       "other side", "let_fluid_fall", "particle 100, id 100, step 0"}));
  EXPECT_TRUE(refuses([&] { step({{-l0 / 2, 0.3}}); }, {"(-0.01, 0.3) m", "id 100"}));
  EXPECT_TRUE(refuses([&] { step({{0.1, -l0 / 2}}); }, {"(0.1, -0.01) m"}));
  EXPECT_NO_THROW(step(behind, {-1, 1})) << "it is thrown";
  EXPECT_NO_THROW(step(behind, {0, 0}, true));
  EXPECT_NO_THROW(step({{0.3, 0.9}})) << "a drop above the tank";
  EXPECT_NO_THROW(step(lattice<2>({{0, 0.2}, {0.2, 0.5}}, l0))) << "above the rim";
}

// Below a hole, and over an edge, fluid is of one body with that which is held.
TEST(ImageWalls, LetFluidRunOutOfTheTank) {
  Settings2D settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = polyline({{0, 1}, {0, 0}, {0.1, 0}});
  settings.walls.segments.push_back({{Vec<2>(0.16, 0), Vec<2>(1, 0)}});
  Simulation sim{fluid_at(lattice<2>({{0, 0}, {0.2, 0.2}}, l0)), UniformGrid<2>{},
                 mps::Flow<Mirrored>{settings}, SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step();
  EXPECT_LT(sim.particles()[velocity][6][1], -0.1);
}

// A line that passes a common edge of two triangles to round-off, and slopes.
TEST(ImageWalls, AreFoundBelowFluidIn3D) {
  const Box<3> room{.lower = {0, 0, 0}, .upper = {0.2, 0.2, 0.4}};
  const auto step = [&](const Vec<3>& extra, const Vec<3>& gravity) {
    auto points = lattice<3>({.lower = room.lower, .upper = {0.2, 0.2, 0.1}}, l0);
    points.push_back(extra);
    Settings3D settings{.spacing = l0, .gravity = gravity, .speed_scale = 1};
    settings.walls.triangles = silt::faces_of(room, Sides<3>::open());
    Simulation sim{fluid_at(points), UniformGrid<3>{}, mps::Flow<Mirrored, 3>{settings},
                   SemiImplicit<>{}};
    sim.step(1e-4);
  };
  EXPECT_NO_THROW(step({0.1, 0.1, 0.3}, {0, 0, -g}));  // on the diagonal of the floor
  EXPECT_TRUE(refuses([&] { step({0.21, 0.1, 0.3}, {0, 0, -g}); }, {"(0.21, 0.1, 0.3) m"}));
  EXPECT_TRUE(refuses([&] { step({0.1, 0.1, -0.01}, {0, 0, -g}); }, {"(0.1, 0.1, -0.01) m"}));
  EXPECT_NO_THROW(step({0.21, 0.1, 0.3}, {-g, 0, -g}));  // above the slope of a side
  EXPECT_TRUE(refuses([&] { step({0.21, 0.1, 0.3}, {g, 0, -g}); }, {"(0.21, 0.1, 0.3) m"}));
}

// Water rests on the floor of a periodic box, whose faces go on beyond its sides, as they have to.
TEST(ImageWalls, MayBeTheSidesOfAPeriodicBox) {
  const Box<2> channel{
      .lower = {0.1, 0}, .upper = {0.1 + 8 * l0, 0.4}, .periodic = {true, false}};
  Settings2D settings{.spacing = l0, .speed_scale = 1};
  settings.walls.segments = silt::faces_of(channel);
  ASSERT_EQ(settings.walls.segments.size(), 2u) << "none across the periodic axis";
  for (const auto& face : settings.walls.segments) {
    EXPECT_NEAR((face.corners[1] - face.corners[0]).norm(), 3 * 8 * l0, 1e-15);
  }
  const auto water_in = [](auto box, double surface) {
    auto filled = box;
    filled.upper[filled.upper.size() - 1] = surface;
    auto water = fluid_at(lattice(filled, l0), box);
    for (Index i = 0; i < water.size(); ++i) {
      const double height = water[position][i][filled.upper.size() - 1];
      water[mps::pressure][i] = 1000 * g * (surface - l0 / 2 - height);
    }
    return water;
  };
  expect_rest<2>(Simulation{water_in(channel, 0.2), UniformGrid<2>{},
                            mps::Flow<Mirrored>{settings}, SemiImplicit<>{}},
                 l0, 0.2);

  // As narrow as a search allows: the fluid sees half a period far.
  const Box<3> shaft{.lower = {0, 0, 0},
                     .upper = {7 * l0, 5 * l0, 0.2},
                     .periodic = {true, false, false}};
  Settings3D in_3d{.spacing = l0, .speed_scale = 1};
  in_3d.walls.triangles = silt::faces_of(shaft, Sides<3>::open());
  ASSERT_EQ(in_3d.walls.triangles.size(), 2u * 3u);
  expect_rest<3>(Simulation{water_in(shaft, 0.1), UniformGrid<3>{},
                            mps::Flow<Mirrored, 3>{in_3d}, SemiImplicit<>{}},
                 l0, 0.1);
}

// It had no segments: a wall that is not there.
TEST(Polyline, NeedsTwoPoints) {
  EXPECT_TRUE(refuses([] { polyline({{0, 0}}); }, {"polyline: number of points = 1", "at least 2"}));
}

}  // namespace
}  // namespace silt::test::image_walls_test
