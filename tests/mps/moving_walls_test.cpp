// SPDX-License-Identifier: MIT
// That walls of faces which move do with the fluid what they would do in their own frame.
#include <silt/geometry/given_motions.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/fluid.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace silt::test::moving_walls_test {
namespace {

constexpr double l0 = 0.02;  // [m]
constexpr double g = 9.81;   // [m/s²]

template <int Dim>
using Motion = AnyRigidMotion<Dim>;

std::vector<Face<2>> tank_of(const Vec<2>& size, bool is_closed) {
  std::vector<Vec<2>> corners{{0, size[1]}, {0, 0}, {size[0], 0}, size};
  if (is_closed) corners.push_back(corners.front());
  return polyline(corners);
}
std::vector<Face<3>> tank_of(const Vec<3>& size, bool is_closed) {
  auto faces = faces_of(Box<3>{.lower = {0, 0, 0}, .upper = size});
  if (is_closed) return faces;
  std::erase_if(faces, [&](const Face<3>& face) {
    return std::ranges::all_of(face.corners,
                               [&](const Vec<3>& x) { return x[2] > 0.99 * size[2]; });
  });
  return faces;
}

template <int Dim>
void set(mps::ImageWalls& walls, std::vector<mps::MovingFaces<Dim>> faces) {
  const mps::MovingWalls<Dim> moving{.faces = std::move(faces)};
  if constexpr (Dim == 2) {
    walls.moving_2d = moving;
  } else {
    walls.moving_3d = moving;
  }
}

// g++ 12 has failed at lists like that of the call below.
mps::AnyMovingWalls<2> as_given(const mps::MovingWalls<2>& walls) { return walls; }

/// Water in a tank that moves, with it at first.
template <int Dim>
auto water_in(const std::vector<Face<Dim>>& tank, const Motion<Dim>& motion, const Vec<Dim>& filled,
              mps::FlowSettings<Dim, mps::Recommended> settings = {}) {
  settings.spacing = l0;
  settings.speed_scale = 2;
  set<Dim>(settings.walls, {{.faces = tank, .motion = motion}});
  mps::Fluid<Dim> fluid;
  for (const auto& x : lattice<Dim>({.lower = Vec<Dim>::Zero(), .upper = filled}, l0)) {
    const Index i = mps::add_particle(fluid, motion.pose_at(0).x_of(x), mps::Kind::fluid);
    fluid[velocity][i] = motion.velocity_at(0).at(x);
    fluid[mps::pressure][i] = 1000 * g * (filled[Dim - 1] - x[Dim - 1]);
  }
  return Simulation{fluid, UniformGrid<Dim>{}, mps::Flow<mps::Recommended, Dim>{settings},
                    SemiImplicit<>{}};
}

// A tank at constant velocity is an inertial frame: hydrostatics, and nothing else.
template <int Dim>
void expect_rest_in_a_moving_tank() {
  Vec<Dim> size = Vec<Dim>::Constant(8 * l0), along = Vec<Dim>::Constant(0.3);
  size[Dim - 1] = 20 * l0;
  Vec<Dim> filled = size;
  filled[Dim - 1] = 8 * l0;
  along[Dim - 1] = -0.2;
  auto sim = water_in<Dim>(tank_of(size, false), Translation<Dim>{along}, filled);
  while (sim.time() < 0.06) sim.step();
  double fastest = 0;
  for (const auto& u : sim.particles()[velocity]) fastest = std::max(fastest, (u - along).norm());
  EXPECT_LT(fastest, 1e-5);
  for (Index i = 0; i < sim.particles().size(); ++i) {
    const double depth =
        filled[Dim - 1] + along[Dim - 1] * sim.time() - sim.particles()[position][i][Dim - 1];
    EXPECT_NEAR(sim.particles()[mps::pressure][i], 1000 * g * depth, 0.02 * 1000 * g * l0);
  }
}
TEST(MovingWalls, KeepWaterAtRestInATankAtConstantVelocity) {
  expect_rest_in_a_moving_tank<2>();
  expect_rest_in_a_moving_tank<3>();
}

// A closed tank that is accelerated: the water moves as a solid, with the pressure's slope −ρ a,
// and the walls have done the work ½ m V².
template <int Dim>
void expect_a_solid_in_an_accelerated_tank() {
  const Vec<Dim> size = Vec<Dim>::Constant(8 * l0);
  Vec<Dim> a = Vec<Dim>::Zero();
  a[0] = 3;
  const MotionFunction<Dim> motion{[=](double t) { return Pose<Dim>{.shift = a * t * t / 2}; }};
  mps::FlowSettings<Dim, mps::Recommended> settings;
  settings.gravity.setZero();
  auto sim = water_in<Dim>(tank_of(size, true), motion, size, settings);
  while (sim.time() < 0.05) sim.step(1e-3);
  const Vec<Dim> reached = a * (sim.time() - 0.5e-3);  // of the step's middle
  const auto u = sim.particles()[velocity];
  const auto p = sim.particles()[mps::pressure];
  const auto x = sim.particles()[position];
  const Vec<Dim> first = x[0];
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_LT((u[i] - reached).norm(), 1e-4);
    EXPECT_NEAR(p[i] - p[0], -1000 * a.dot(Vec<Dim>(x[i] - first)), 0.01 * 1000 * a[0] * size[0]);
  }
  const mps::FlowEnergy& energy = sim.interaction().energy();
  // With the velocity at the end of each of the 50 steps, and not with the mean one.
  EXPECT_NEAR(energy.by_walls, (1 + 1.0 / 50) * energy.kinetic, 1e-3 * energy.kinetic);
  EXPECT_NEAR(energy.imbalance(), 0, 1e-12 * energy.kinetic);
}
TEST(MovingWalls, AccelerateWaterAsASolid) {
  expect_a_solid_in_an_accelerated_tank<2>();
  expect_a_solid_in_an_accelerated_tank<3>();
}

// A lid that moves drags the fluid, over a wall at rest and in a cavity.
struct Sticking : mps::Recommended {
  mps::NoSlip wall_stress{};
};
constexpr double of_lid = 0.1;  // [m/s]
auto below_a_lid(bool is_cavity) {
  constexpr double height = 10 * l0;
  mps::FlowSettings<2, Sticking> settings{.spacing = l0, .viscosity = 1e-2, .speed_scale = 1};
  settings.gravity.setZero();
  settings.walls.segments = is_cavity ? polyline({{0, height}, {0, 0}, {0.2, 0}, {0.2, height}})
                                      : polyline({{-0.2, 0}, {0.4, 0}});
  set<2>(settings.walls,
         {{.faces = polyline({{-9, height}, {9, height}}), .motion = Translation<2>{{of_lid, 0}}}});
  Box<2> box{.lower = {0, -1}, .upper = {0.2, 1}};
  box.periodic[0] = !is_cavity;
  mps::Fluid<2> fluid{box};
  for (const auto& x : lattice<2>({{0, 0}, {0.2, height}}, l0)) {
    mps::add_particle(fluid, x, mps::Kind::fluid);
  }
  return Simulation{fluid, UniformGrid<2>{}, mps::Flow<Sticking>{settings}, SemiImplicit<>{}};
}
// Couette flow: the velocity, and the stress on both walls, μU/h.
TEST(MovingWalls, DragFluidThatSticksToThem) {
  auto sim = below_a_lid(false);
  while (sim.time() < 4) sim.step();  // the slowest part decays by exp(−π² ν t/h²) = 5e-5
  const auto x = sim.particles()[position];
  const auto u = sim.particles()[velocity];
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_NEAR(u[i][0], of_lid * x[i][1] / 0.2, 0.02 * of_lid);
  }
  const double drag = 1000 * 1e-2 * of_lid / 0.2 * 0.2;
  EXPECT_NEAR(WallLoad<2>{WallGroup::moving_faces(0)}.read(sim)[0], -drag, 0.02 * drag);
  EXPECT_NEAR(WallLoad<2>{WallGroup{}}.read(sim)[0], drag, 0.02 * drag);
}
// The load of all walls, with their viscous stress, is all that changes the momentum.
TEST(MovingWalls, ChangeTheMomentumByTheirLoadAlone) {
  auto sim = below_a_lid(true);
  const auto momentum = [&] {
    Vec<2> sum = Vec<2>::Zero();
    for (const Vec<2>& u : sim.particles()[velocity]) sum += 1000 * l0 * l0 * u;
    return sum;
  };
  for (int k = 0; k < 20; ++k) {
    const Vec<2> before = momentum();
    sim.step();
    const Vec<2> impulse = -sim.last_time_step() * WallLoad<2>::of_all_walls().read(sim);
    EXPECT_LT((momentum() - before - impulse).norm(), 1e-10 * impulse.norm()) << k;
  }
}

// A swaying tank with a paddle of its own motion, and what it does in a run that is stopped.
using MovingWallsRestarted = FileTest;

TEST_F(MovingWallsRestarted, KeepTheBits) {
  const auto make = [] {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 2};
    set<2>(settings.walls,
           {{.faces = tank_of(Vec<2>(0.4, 0.5), false), .motion = Vibration<2>{{0.02, 0}, 1.5}},
            {.faces = polyline({{0.25, 0.06}, {0.3, 0.12}}),
             .motion = Rotation<2>{.about = {0.25, 0.1}, .spin = 2}}});
    mps::Fluid<2> fluid;
    for (const auto& x : lattice<2>({{0, 0}, {0.16, 0.3}}, l0)) {
      mps::add_particle(fluid, x, mps::Kind::fluid);
    }
    return RunWith{Simulation{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                              SemiImplicit<>{}}};
  };
  expect_the_same_bits_after_restarts(
      path, {.steps = 60, .number = 6, .further = 8, .to_the_end = 1}, make, [](const auto& run) {
        return std::vector<double>{run.simulation.interaction().energy().by_walls};
      });
}

// --- what is refused -----------------------------------------------------------------------------

TEST(MovingWalls, RefuseWhatCannotMove) {
  const auto step = [](std::vector<mps::MovingFaces<2>> moving, int steps = 1) {
    mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .speed_scale = 2};
    settings.walls.segments = tank_of(Vec<2>(0.2, 0.4), false);
    set<2>(settings.walls, std::move(moving));
    mps::Fluid<2> fluid;
    for (const auto& x : lattice<2>({{0, 0}, {0.2, 0.1}}, l0)) {
      mps::add_particle(fluid, x, mps::Kind::fluid);
    }
    Simulation sim{fluid, UniformGrid<2>{}, mps::Flow<mps::Recommended>{settings},
                   SemiImplicit<>{}};
    for (int k = 0; k < steps; ++k) {
      const auto before = state_of(sim.particles());
      try {
        sim.step();
      } catch (const Error&) {
        EXPECT_EQ(before, state_of(sim.particles()));
        throw;
      }
    }
  };
  const auto plate = polyline({{0.05, 0.2}, {0.15, 0.2}});
  const auto refuses_motion = [&](const AnyRigidMotion<2>& motion,
                                  const std::vector<std::string>& fragments) {
    return refuses([&] { step({{.faces = plate, .motion = motion}}); }, fragments);
  };
  EXPECT_TRUE(refuses_motion(Translation<2>{{0, nan}}, {"Translation: velocity", "nan"}));
  EXPECT_TRUE(refuses_motion(Rotation<2>{.spin = inf}, {"Rotation: spin", "inf"}));
  EXPECT_TRUE(refuses_motion(Vibration<2>{{0, 0.1}, -2}, {"Vibration: frequency", "-2"}));
  EXPECT_TRUE(refuses_motion(MotionFunction<2>{}, {"MotionFunction: pose is empty"}));
  EXPECT_TRUE(refuses_motion(TabulatedMotion<2>{{0}, {{0, 0}}}, {"times = 1 values"}));
  EXPECT_TRUE(
      refuses_motion(TabulatedMotion<2>{{0, 1, 1}, {}}, {"times[2] = 1 s is not after 1 s"}));
  EXPECT_TRUE(refuses_motion(TabulatedMotion<2>{{0, 1}}, {"neither shifts nor turns"}));
  EXPECT_TRUE(refuses_motion(TabulatedMotion<2>{{0, 1}, {{0, 0}}}, {"shifts = 1 values for 2"}));
  EXPECT_TRUE(refuses_motion(
      MotionFunction<2>{[](double t) { return Pose<2>{.shift = {0, t > 0 ? nan : 0}}; }},
      {"moving wall 0 has no finite position at 0 s"}));
  EXPECT_TRUE(refuses([&] { step({{.faces = polyline({{0, 0}, {0, 0}}), .motion = {}}}); },
                      {"moving wall 0: face 0"}));
  // The end of a plate that goes down, into the floor.
  EXPECT_TRUE(refuses(
      [&] {
        step({{.faces = polyline({{0.1, 0.15}, {0.1, 0.4}}), .motion = Translation<2>{{0, -2}}}},
             500);
      },
      {"moving wall 0 goes into a wall at rest at (0.1"}));
  // Across the floor from the beginning, and across each other.
  EXPECT_TRUE(refuses([&] { step({{.faces = polyline({{0.1, -0.1}, {0.1, 0.4}})}}); },
                      {"moving wall 0 and a wall at rest go through each other at (0.1, 0) m",
                       "so that they touch at most"}));
  EXPECT_TRUE(refuses(
      [&] {
        step({{.faces = polyline({{0.05, 0.2}, {0.15, 0.3}})},
              {.faces = polyline({{0.05, 0.3}, {0.15, 0.2}})}});
      },
      {"moving wall 0 and moving wall 1 go through each other at (0.1, 0.25) m"}));
  // So fast that the fluid would need ten thousand steps for one of its own.
  for (const AnyRigidMotion<2>& motion : {Motion<2>(Translation<2>{{0, 1e6}}),
                                          Motion<2>(Vibration<2>{{0, 1e-6}, 1e9})}) {
    EXPECT_TRUE(refuses_motion(motion, {"the speed or the period of a moving wall",
                                        "less than a ten-thousandth", "frequency"}));
  }
  // One that slides along the walls it touches may move.
  EXPECT_NO_THROW(
      step({{.faces = polyline({{0.1, 0}, {0.1, 0.4}}), .motion = Translation<2>{{0.2, 0}}}}, 20));
}

// A given step that would not resolve a vibration. MovingWalls without any are none.
TEST(MovingWalls, RefuseAStepLongerThanATenthOfTheirPeriod) {
  const Vibration<2> fast{{0, 1e-5}, 100};
  const auto tank = tank_of(Vec<2>(8 * l0, 8 * l0), false);
  auto sim = water_in<2>(tank, fast, Vec<2>(8 * l0, 4 * l0));
  EXPECT_TRUE(refuses([&] { sim.step(1.1e-3); },
                      {"moving wall 0: a time step of 0.0011 s", "a tenth of the period", "0.01 s"}));
  sim.step(0.9e-3);
  mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0, .gravity = {0, 0}};
  settings.walls.moving_2d = mps::MovingWalls<2>{};
  settings.walls.let_fluid_fall = true;
  Simulation drop{fluid_at<2, double>({{0, 0}}), UniformGrid<2>{},
                  mps::Flow<mps::Recommended>{settings}, SemiImplicit<>{}};
  drop.step(1e-3);
  EXPECT_EQ(as_given({.faces = {{.faces = tank}}}).groups().size(), 1u);
}

// A source that moves the particles with u* does not know of walls.
TEST(MovingWalls, AreNamedIfAParticleGoesThrough) {
  struct Moved : mps::RecommendedForWallParticles {
    mps::ImageWalls walls{};
    mps::DensitySource source{};
    mps::Collision collision{.distance = 0};
  };
  mps::FlowSettings<2, Moved> settings{.spacing = l0, .gravity = {0, 0}};
  set<2>(settings.walls,
         {{.faces = polyline({{-1, 0}, {1, 0}}), .motion = Translation<2>{{0, 0.1}}}});
  mps::Fluid<2> drop;
  mps::add_particle(drop, {0, 0.3 * l0}, mps::Kind::fluid);
  drop[velocity][0] = {0, -1};
  Simulation sim{drop, UniformGrid<2>{}, mps::Flow<Moved>{settings}, SemiImplicit<>{}};
  EXPECT_TRUE(refuses([&] { sim.step(0.5 * l0); },
                      {"a particle went through moving wall 0", "particle 0"}));
}

}  // namespace
}  // namespace silt::test::moving_walls_test
