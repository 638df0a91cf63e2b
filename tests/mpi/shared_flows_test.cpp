// SPDX-License-Identifier: MIT
// Flows that processes share, against the same flow in one process. Started by mpirun with any number
// of processes.
#include <silt/io/checkpoint.hpp>
#include <silt/mpi.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include "../support/slow_types.hpp"
#include "processes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::test::shared_flows_test {
namespace {

template <class Scheme, int Dim>
using SerialFlow = mps::Flow<Scheme, Dim>;
template <class Scheme, int Dim>
using SharedFlow = mpi::Flow<Scheme, Dim>;

template <class Flow, class P, class Settings>
auto simulation_of(P particles, const Settings& settings) {
  const SolveSettings exact{.tolerance = 1e-12};
  const auto flow = [&] {
    if constexpr (Shared<P>) {
      return Flow{settings, mpi::PressureSolver<P::dimension>{exact}};
    } else {
      return Flow{settings, mps::PressureSolver<P::dimension>{exact}};
    }
  };
  return Simulation{std::move(particles), UniformGrid<P::dimension>{}, flow(), SemiImplicit<>{}};
}

// Largest difference of the positions [m], by ids.
template <class P, class Q>
double difference(const P& all, const Q& own) {
  double most = 0;
  for (Index i = 0; i < own.size(); ++i) {
    const Index j = all.index_of(own.id(i));
    if (j == no_index) return 1e300;
    most = std::max(most, double((own[position][i] - all[position][j]).norm()));
  }
  return world->max(most);
}

template <class Scheme, int Dim>
void expect_same(const auto& tank, const mps::FlowSettings<Dim, Scheme>& settings, int steps,
                 double tolerance) {
  auto serial = simulation_of<SerialFlow<Scheme, Dim>>(tank, settings);
  auto shared = simulation_of<SharedFlow<Scheme, Dim>>(mpi::distribute(tank, *world), settings);
  for (int k = 0; k < steps; ++k) {
    if (k % 37 == 36) shared.particles().repartition();
    serial.step();
    shared.step(serial.last_time_step());
    const double found = difference(serial.particles(), shared.particles());
    ASSERT_LT(found, tolerance) << k;
    ASSERT_EQ(world->sum(double(shared.particles().size())), double(serial.particles().size()));
  }
  EXPECT_NEAR(serial.interaction().energy().kinetic, shared.interaction().energy().kinetic,
              1e-6 * std::abs(serial.interaction().energy().kinetic));
  EXPECT_LE(double(shared.interaction().last_solve().iterations),
            1.2 * double(serial.interaction().last_solve().iterations));
}

TEST(SharedFlows, AreAsInOneProcess) {
  constexpr double l0 = 0.04;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = l0});
  expect_same<mps::Recommended, 2>(
      tank.particles,
      {.spacing = l0, .density = 1000, .speed_scale = 2.8, .walls = tank.walls},
      SILT_SLOW_TESTS ? 50 : 40, 1e-9);
}

// All processes move all walls and bodies; loads are sums over processes.
TEST(SharedFlows, WithBodiesAreAsInOneProcess) {
  constexpr double l0 = 0.04;
  auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.8, 0.4}, .size = {.length = 1.2, .height = 0.8}, .spacing = l0});
  const auto box = polyline({{0.3, 0.24}, {0.5, 0.24}, {0.5, 0.44}, {0.3, 0.44}, {0.3, 0.24}});
  tank.walls.moving_2d = mps::MovingWalls<2>{
      .faces = {{.faces = polyline({{0.8, 0}, {0.8, 0.6}}), .motion = Translation<2>{{0, 1.5}}}},
      .bodies = {{.faces = box, .density = 500, .velocity = {0.1, 0}, .spin = 0.5}}};
  mps::remove_inside(tank.particles, box, l0);
  expect_same<mps::Recommended, 2>(
      tank.particles, {.spacing = l0, .speed_scale = 2.8, .walls = tank.walls}, 40, 1e-9);
}

#if SILT_SLOW_TESTS
TEST(SharedFlows, AreAsInOneProcessIn3D) {
  constexpr double l0 = 0.08;
  const auto tank = mps::make_tank<mps::Recommended, 3>(
      {.column = {0.4, 0.4},
       .size = {.length = 0.8, .height = 0.8, .depth = 0.4},
       .spacing = l0});
  expect_same<mps::Recommended, 3>(
      tank.particles,
      {.spacing = l0, .density = 1000, .speed_scale = 2, .walls = tank.walls}, 20, 1e-9);
}

TEST(SharedFlows, WithWallsOfParticlesAreAsInOneProcess) {
  constexpr double l0 = 0.04;
  const auto tank = mps::make_tank(mps::Tank<2>{
      .column = {0.4, 0.8}, .size = {.length = 1.0, .height = 1.0}, .spacing = l0});
  expect_same<mps::Case10, 2>(tank, {.spacing = l0, .density = 1000, .speed_scale = 2.8}, 40, 1e-9);
  expect_same<mps::RecommendedForWallParticles, 2>(
      tank, {.spacing = l0, .density = 1000, .speed_scale = 2.8}, 40, 1e-9);
  // Particles are moved, and searched for, twice in a step.
  expect_same<mps::Case00, 2>(tank, {.spacing = l0, .density = 1000, .speed_scale = 2.8}, 20, 1e-9);
}

// Parts of the closed bodies are in several processes.
TEST(SharedFlows, WithoutAFreeSurfaceAreAsInOneProcess) {
  constexpr double l0 = 0.04;
  const auto full = mps::make_tank(mps::Tank<2>{.column = {0.4, 0.4},
                                                .size = {.length = 0.4, .height = 0.4},
                                                .spacing = l0,
                                                .lid = true});
  expect_same<mps::Case10, 2>(full, {.spacing = l0, .max_time_step = 1e-3}, 20, 1e-9);

  constexpr double k = 2 * std::numbers::pi;
  constexpr int along = 20;
  mps::Fluid<2> vortices;
  vortices.set_box({.lower = {0, 0}, .upper = {1, 1}, .periodic = {true, true}});
  for (const auto& x : lattice<2>({{0, 0}, {1, 1}}, 1.0 / along)) {
    mps::add_particle(vortices, x, mps::Kind::fluid);
    vortices[velocity][vortices.size() - 1] = {-std::cos(k * x[0]) * std::sin(k * x[1]),
                                               std::sin(k * x[0]) * std::cos(k * x[1])};
  }
  expect_same<mps::Case10, 2>(vortices,
                              {.spacing = 1.0 / along,
                               .viscosity = 0.01,
                               .gravity = Vec<2>::Zero(),
                               .max_time_step = 1e-3,
                               .source = {.gamma = 0},
                               .collision = {.distance = 0}},
                              20, 1e-9);
}

// Fails in one process, when asked, in each phase of a step in turn.
struct Trouble {
  enum Phase { none, friction, collision, source, solve, gradient, shifting, number_of_phases };
  static inline int phase = none;
  static inline int process = 0;

  static void in(Phase here) {
    if (here == phase && world->rank() == process) fail("trouble in phase " + std::to_string(here));
  }
};
struct TroubledFriction : mps::PairFriction {
  template <int Dim, class Real>
  struct InFlow : mps::PairFriction::InFlow<Dim, Real> {
    using Base = mps::PairFriction::InFlow<Dim, Real>;
    explicit InFlow(const TroubledFriction& friction) : Base(friction) {}
    template <class Step>
    void find(const Step& step) {
      Trouble::in(Trouble::friction);
      Base::find(step);
    }
  };
};
template <class Base>
struct TroubledCollision : Base {
  auto velocity_change(const auto& pair) const {
    Trouble::in(Trouble::collision);
    return Base::velocity_change(pair);
  }
};
template <class Base>
struct TroubledSource : Base {
  double value(const auto& at) const {
    Trouble::in(Trouble::source);
    return Base::value(at);
  }
};
template <class Base>
struct TroubledGradient : Base {
  template <class T, class Real, class Neighbours>
  static auto evaluate(const T& stencil, Real phi_i, Neighbours&& for_each) {
    Trouble::in(Trouble::gradient);
    return Base::evaluate(stencil, phi_i, for_each);
  }
};
struct TroubledShifting : mps::ParticleShifting {
  template <class View>
  auto displacement(const View& at) const {
    Trouble::in(Trouble::shifting);
    return mps::ParticleShifting::displacement(at);
  }
};
struct Troubled : mps::Recommended {
  TroubledFriction friction;
  TroubledSource<mps::BalancedSource> source;
  TroubledCollision<mps::KeepApart> collision{mps::KeepApart{.image_distance = 0.7}};
  TroubledShifting shifting;
};
struct TroubledCase00 : mps::Case00 {
  TroubledSource<mps::DensitySource> source;
  TroubledCollision<mps::Collision> collision{{.distance = 0.5, .restitution = 0.2}};
  TroubledGradient<mps::MinimumGradient> gradient;
};
struct TroubledCase10 : mps::Case10 {
  TroubledSource<mps::DivergenceSource> source;
  TroubledCollision<mps::Collision> collision{{.distance = 1.0, .restitution = 0.2}};
  TroubledGradient<mps::ConservingGradient> gradient;
};
class TroubledMultigrid : public CellMultigrid<2, mpi::SharedCellCycle<2>> {
 public:
  void prepare(const LinearSystem& system) {
    Trouble::in(Trouble::solve);
    CellMultigrid<2, mpi::SharedCellCycle<2>>::prepare(system);
  }
};

template <class Scheme, class P>
void expect_as_before(const P& tank, const mps::FlowSettings<2, Scheme>& settings) {
  const auto flow_of = [&] {
    return Simulation{
        mpi::distribute(tank, *world), UniformGrid<2>{},
        mps::Flow<Scheme, 2, double, ConjugateGradient<TroubledMultigrid>>{settings},
        SemiImplicit<>{}};
  };
  auto calm = flow_of();
  auto troubled = flow_of();
  std::array<int, Trouble::number_of_phases> refused{};
  for (int k = 0; k < 24; ++k) {
    calm.step();
    Trouble::phase = 1 + k % (Trouble::number_of_phases - 1);
    Trouble::process = (k + k / (Trouble::number_of_phases - 1)) % world->size();
    try {
      troubled.step(calm.last_time_step());
    } catch (const Error& error) {
      ++refused[Index(Trouble::phase)];
      const std::string message = error.what();
      EXPECT_NE(message.find("trouble in phase " + std::to_string(Trouble::phase)),
                std::string::npos)
          << message;
      Trouble::phase = Trouble::none;
      troubled.step(calm.last_time_step());
    }
    Trouble::phase = Trouble::none;
    ASSERT_EQ(calm.steps(), troubled.steps());
    double most = 0;
    for (Index i = 0; i < troubled.particles().size(); ++i) {
      const Index j = calm.particles().index_of(troubled.particles().id(i));
      ASSERT_LT(j, calm.particles().size());
      most = std::max(most, (calm.particles()[position][j] - troubled.particles()[position][i])
                                .norm());
    }
    ASSERT_EQ(most, 0) << k;
  }
  const auto expect_refused = [&](bool is_in_scheme, Trouble::Phase phase) {
    if (!is_in_scheme) return;
    EXPECT_GE(refused[Index(phase)], 1) << phase;
  };
  constexpr bool has_wall_particles = std::is_base_of_v<mps::Case00, Scheme>;
  expect_refused(true, Trouble::source);
  expect_refused(true, Trouble::solve);
  expect_refused(has_wall_particles, Trouble::gradient);
  expect_refused(!has_wall_particles, Trouble::friction);
  expect_refused(!has_wall_particles, Trouble::shifting);
}

TEST(SharedFlows, AreAsBeforeInAllProcessesIfOneFailsInAnyPhase) {
  constexpr double l0 = 0.04;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.0, .height = 1.0}, .spacing = l0});
  expect_as_before<Troubled>(
      tank.particles,
      {.spacing = l0, .density = 1000, .speed_scale = 2.8, .walls = tank.walls});
  const auto with_particles = mps::make_tank(mps::Tank<2>{
      .column = {0.4, 0.8}, .size = {.length = 1.0, .height = 1.0}, .spacing = l0});
  expect_as_before<TroubledCase00>(with_particles,
                                   {.spacing = l0, .density = 1000, .speed_scale = 2.8});
  expect_as_before<TroubledCase10>(with_particles,
                                   {.spacing = l0, .density = 1000, .speed_scale = 2.8});
}

#endif  // SILT_SLOW_TESTS

TEST(SharedFlows, ContinueFromCheckpointsOnAnyNumberOfProcesses) {
  constexpr double l0 = 0.04;
  const std::filesystem::path file = "shared_flows_" + std::to_string(world->size()) + ".silt";
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.0, .height = 1.0}, .spacing = l0});
  const mps::FlowSettings<2, mps::Recommended> settings{
      .spacing = l0, .density = 1000, .speed_scale = 2.8, .walls = tank.walls};
  auto serial = simulation_of<SerialFlow<mps::Recommended, 2>>(tank.particles, settings);
  for (int k = 0; k < 10; ++k) serial.step();
  if (world->is_first()) write_checkpoint(file, serial);
  world->sum(0.0);
  auto shared = simulation_of<SharedFlow<mps::Recommended, 2>>(
      mpi::distribute(tank.particles, *world), settings);
  read_checkpoint(file, shared);
  for (int k = 0; k < 10; ++k) {
    serial.step();
    shared.step(serial.last_time_step());
  }
  EXPECT_LT(difference(serial.particles(), shared.particles()), 1e-9);
  write_checkpoint(file, shared);
  auto again = simulation_of<SerialFlow<mps::Recommended, 2>>(tank.particles, settings);
  world->sum(0.0);
  read_checkpoint(file, again);
  for (int k = 0; k < 10; ++k) {
    serial.step();
    again.step(serial.last_time_step());
  }
  EXPECT_LT(difference(serial.particles(), again.particles()), 1e-9);
  EXPECT_NEAR(serial.interaction().energy().by_pressure, again.interaction().energy().by_pressure,
              1e-6 * serial.interaction().energy().kinetic);
  world->sum(0.0);
  if (world->is_first()) std::filesystem::remove(file);
}

}  // namespace
}  // namespace silt::test::shared_flows_test
