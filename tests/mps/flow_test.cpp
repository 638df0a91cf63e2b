// SPDX-License-Identifier: MIT
// The step of a flow: limits, failures, conservation and rejected input.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <silt/core/forces.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::flow_test {
namespace {

using mps::Case10;
using mps::Flow;
using mps::Kind;
using Settings = mps::FlowSettings<2, Case10>;

static_assert(PressureInteraction<Flow<Case10>, mps::Fluid<2>, UniformGrid<2>>);
static_assert(
    PressureInteraction<Flow<Case10, 3, float>, mps::Fluid<3, float>, BruteForce<3, float>>);
static_assert(!PressureInteraction<Flow<Case10>, Particles<2, double, velocity_t>, UniformGrid<2>>);
static_assert(!PressureInteraction<Gravity<2>, mps::Fluid<2>, UniformGrid<2>>);
static_assert(Integrator<SemiImplicit<>, mps::Fluid<2>, UniformGrid<2>, Flow<Case10>>);
static_assert(!Integrator<SemiImplicit<>, mps::Fluid<2>, UniformGrid<2>, Gravity<2>>);
static_assert(ChoosesTimeStep<Flow<Case10>, mps::Fluid<2>>);
static_assert(mps::FluidParticles<mps::Fluid<3, float>>);
static_assert(!mps::FluidParticles<Particles<2, double>>);

// Case 10 with settings of its solver.
using SolvedFlow = Flow<Case10, 2, double, ConjugateGradient<>>;

template <class P>
auto simulation(P particles, const Settings& settings, const SolveSettings& solve = {}) {
  return Simulation{std::move(particles), UniformGrid<2>{},
                    SolvedFlow(settings, ConjugateGradient<>(solve)), SemiImplicit{}};
}

auto dam(const SolveSettings& solve = {}) {
  return simulation(small_dam<2>(), {.spacing = 0.02, .max_time_step = 1e-3}, solve);
}

// --- time step -----------------------------------------------------------------------------------

TEST(FlowTimeStep, HasTheCourantNumberForTheMaximumSpeed) {
  auto sim = simulation(blob<2, double>(6, 0.02), {.spacing = 0.02, .courant = 0.3});
  sim.particles()[velocity][7] = {3, -4};
  EXPECT_NEAR(sim.time_step() * 5, 0.3 * 0.02, 1e-15);
  for (int k = 0; k < 20; ++k) {
    const double dt = sim.time_step();
    double max_speed = 0;
    for (const auto& u : sim.particles()[velocity]) max_speed = std::max(max_speed, u.norm());
    EXPECT_LE(dt * max_speed, 0.3 * 0.02 * (1 + 1e-12));
    sim.step();
    EXPECT_EQ(sim.last_time_step(), dt);
  }
}

TEST(FlowTimeStep, OfFluidAtRestFollowsFromTheExpectedSpeed) {
  auto sim = simulation(blob<2, double>(6, 0.02), {.spacing = 0.02, .speed_scale = 2});
  EXPECT_DOUBLE_EQ(sim.time_step(), 0.2 * 0.02 / 2);
}

TEST(FlowTimeStep, DoesNotExceedMaxTimeStep) {
  auto sim = simulation(blob<2, double>(6, 0.02), {.spacing = 0.02, .max_time_step = 1e-4});
  EXPECT_EQ(sim.time_step(), 1e-4);
}

TEST(FlowTimeStep, IsProportionalToSpacingSquaredOverViscosity) {
  const auto chosen = [](double spacing, double viscosity) {
    return simulation(blob<2, double>(6, spacing), {.spacing = spacing, .viscosity = viscosity})
        .time_step();
  };
  EXPECT_NEAR(chosen(0.02, 2) / chosen(0.02, 1), 0.5, 1e-12);
  EXPECT_NEAR(chosen(0.01, 1) / chosen(0.02, 1), 0.25, 1e-12);
}

TEST(FlowTimeStep, IsRequiredForFluidWithoutSpeedGravityAndViscosity) {
  auto sim = simulation(blob<2, double>(6, 0.02),
                        {.spacing = 0.02, .viscosity = 0, .gravity = Vec<2>::Zero()});
  EXPECT_TRUE(refuses([&] { sim.step(); }, {"chooses no time step"}));
}

TEST(FlowTimeStep, WithinTheViscousLimitAmplifiesNoVelocity) {
  // On a full periodic lattice, with the maximum accepted step, velocities of the shortest
  // wavelengths decay.
  auto particles = full_box<2, double>(10, 0.02);
  const Settings settings{.spacing = 0.02, .viscosity = 1, .gravity = Vec<2>::Zero()};
  Flow<Case10> flow(settings);
  UniformGrid<2> search({.radius = flow.reach(particles)});
  search.update(particles);
  for (Index i = 0; i < particles.size(); ++i) {
    particles[velocity][i] = {(i + i / 10) % 2 == 0 ? 1e-3 : -1e-3, 1e-3 * std::sin(double(i))};
  }
  const auto energy = [&] {
    double sum = 0;
    for (const auto& u : particles[velocity]) sum += u.squaredNorm();
    return sum;
  };
  const double limit = 2 * flow.time_step(particles);  // the default is half the limit
  for (int k = 0; k < 50; ++k) {
    const double before = energy();
    flow.predict(particles, search, limit * 0.999);
    EXPECT_LE(energy(), before * (1 + 1e-12));
  }
  EXPECT_TRUE(refuses([&] { flow.predict(particles, search, limit * 1.001); },
                      {"time_step = ", "exceeds the viscous limit ", "lower it"}));
}

// --- failed steps --------------------------------------------------------------------------------

// fail_a_step throws an error with the given message, and the step is rolled back: after repair,
// the run continues as if the step had not been attempted.
template <class Break, class Repair>
void expect_rollback(Break&& fail_a_step, Repair&& repair,
                     const std::vector<std::string>& message) {
  auto undisturbed = dam();
  auto sim = dam();
  for (int k = 0; k < 10; ++k) {
    undisturbed.step();
    sim.step();
  }
  const auto before = state_of(sim.particles());
  EXPECT_TRUE(refuses([&] { fail_a_step(sim); }, message));
  EXPECT_TRUE(state_of(sim.particles()) == before);
  EXPECT_EQ(sim.steps(), 10u);
  EXPECT_EQ(sim.time(), undisturbed.time());
  repair(sim);
  for (int k = 0; k < 10; ++k) {
    undisturbed.step();
    sim.step();
  }
  EXPECT_TRUE(state_of(sim.particles()) == state_of(undisturbed.particles()));
  EXPECT_EQ(sim.time(), undisturbed.time());
}

TEST(FailedFlowStep, DueToThePressureSolveReportsTheResidualAndIsRolledBack) {
  const SolvedFlow good = dam().interaction();
  expect_rollback(
      [](auto& sim) {
        sim.interaction() =
            SolvedFlow(sim.interaction().settings(),
                       ConjugateGradient<>({.tolerance = 1e-12, .max_iterations = 2}));
        sim.step();
      },
      [&](auto& sim) { sim.interaction() = good; },
      {"pressure solve", "residual ", "after 2 iterations", "unknowns", "step 10", "t = "});
}

TEST(FailedFlowStep, ReportsTheSolveThatFailed) {
  auto sim = dam({.tolerance = 1e-12, .max_iterations = 2});
  EXPECT_THROW(sim.step(), Error);
  EXPECT_EQ(sim.interaction().last_solve().reason, SolveReport::Reason::not_converged);
  EXPECT_EQ(sim.interaction().last_solve().iterations, 2);
  EXPECT_GT(sim.interaction().last_solve().residual, 1e-12);
}

TEST(FailedFlowStep, DueToATooLargeTimeStepIsRolledBack) {
  expect_rollback(
      [](auto& sim) { sim.step(1.0); }, [](auto&) {},
      {"mps::Flow: time_step = 1 s", "spacing", "use at most ", "particle ", "id "});
}

TEST(FailedFlowStep, DueToAnInvalidTimeStepIsRolledBack) {
  expect_rollback([](auto& sim) { sim.step(0); }, [](auto&) {}, {"time_step = 0 "});
  expect_rollback([](auto& sim) { sim.step(nan); }, [](auto&) {}, {"time_step = nan"});
}

TEST(FailedFlowStep, DueToCoincidentParticlesNamesOneOfThem) {
  auto fluid = blob<2, double>(5, 0.02);
  fluid[position][13] = fluid[position][12];
  auto sim = simulation(fluid, {.spacing = 0.02, .max_time_step = 1e-3});
  EXPECT_TRUE(refuses([&] { sim.step(); }, {"same position", "id 12"}));
}

TEST(FailedFlowStep, DueToANonFinitePressureNamesTheParticleAndIsRolledBack) {
  for (const double bad : {nan, inf, -inf}) {
    auto sim = dam();
    sim.particles()[mps::pressure][21] = bad;
    const auto before = state_of(sim.particles());
    EXPECT_TRUE(refuses([&] { sim.step(); },
                        {"the pressure ", "Pa is not finite", "id 21", "step 0"}));
    EXPECT_TRUE(state_of(sim.particles()) == before);
    EXPECT_EQ(sim.steps(), 0u);
    sim.particles()[mps::pressure][21] = 0;
    sim.step();
  }
}

TEST(Flow, SolvesWithinTheTolerance) {
  for (const double tolerance : {1e-4, 1e-9}) {
    auto sim = dam({.tolerance = tolerance});
    for (int k = 0; k < 5; ++k) {
      sim.step();
      const SolveReport& report = sim.interaction().last_solve();
      EXPECT_EQ(report.reason, SolveReport::Reason::converged);
      EXPECT_LE(report.residual, tolerance * 1.001);
      EXPECT_GT(report.unknowns, 100u);
    }
  }
}

// --- physics of small bodies ---------------------------------------------------------------------

TEST(Flow, HasNoPressureInAFallingBlock) {
  const double dt = 1e-3;
  auto sim = simulation(blob<2, double>(12, 0.02), {.spacing = 0.02, .viscosity = 1e-3});
  const auto start = sim.particles();
  for (int k = 0; k < 200; ++k) sim.step(dt);
  const double t = sim.time();
  for (Index i = 0; i < start.size(); ++i) {
    const Vec<2> fallen = sim.particles()[position][i] - start[position][i];
    EXPECT_NEAR(fallen[0], 0, 1e-9);
    EXPECT_NEAR(fallen[1], -9.81 * t * t / 2, 9.81 * t * dt);  // first order in Δt
    EXPECT_NEAR(sim.particles()[velocity][i][1], -9.81 * t, 1e-8);
    EXPECT_NEAR(sim.particles()[mps::pressure][i], 0, 1e-3) << "at rest: 2354 Pa at the bottom";
  }
}

TEST(Flow, DampsAShearWaveWithAnyRadiusOfTheLaplacian) {
  constexpr double l0 = 0.02;
  constexpr double k = 2 * std::numbers::pi / (20 * l0);
  constexpr double dt = 1e-3;
  for (const double radius : {2.1, 3.1, 4.1}) {
    auto sim = simulation(
        full_box<2, double>(20, l0),
        {.spacing = l0, .viscosity = 0.01, .gravity = Vec<2>::Zero(), .laplacian_radius = radius});
    const auto start = sim.particles();
    for (Index i = 0; i < start.size(); ++i) {
      sim.particles()[velocity][i] = {0.01 * std::sin(k * start[position][i][1]), 0};
    }
    const auto before = sim.particles();
    sim.step(dt);
    for (Index i = 0; i < start.size(); ++i) {
      const Vec<2> change = sim.particles()[velocity][i] - before[velocity][i];
      // (1 − O((k l0)²)) of that of the Navier–Stokes equations.
      EXPECT_NEAR(change[0], -dt * 0.01 * k * k * before[velocity][i][0],
                  0.07 * 0.01 * dt * 0.01 * k * k);
      EXPECT_NEAR(change[1], 0, 1e-12);
    }
  }
}

TEST(Flow, ExpandsACompressedBlobByItsPressure) {
  // The lattice is compressed by 2 %.
  auto sim = simulation(blob<2, double>(16, 0.0196),
                        {.spacing = 0.02, .gravity = Vec<2>::Zero(), .max_time_step = 1e-3});
  const auto size = [](const auto& particles) {
    double sum = 0;
    const Vec<2> centre = Vec<2>::Constant(8 * 0.0196);
    for (const auto& x : particles[position]) sum += (x - centre).squaredNorm();
    return sum;
  };
  const double before = size(sim.particles());
  sim.step();
  double max_pressure = 0;
  for (const double p : sim.particles()[mps::pressure]) {
    EXPECT_GE(p, 0);
    max_pressure = std::max(max_pressure, p);
  }
  EXPECT_GT(max_pressure, 0);
  EXPECT_GT(size(sim.particles()), before);
}

template <class S>
class Blobs : public ::testing::Test {};
TYPED_TEST_SUITE(Blobs, Spaces);

TYPED_TEST(Blobs, ConserveMomentumInCase10) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  for (const bool periodic : {false, true}) {
    auto fluid = periodic ? full_box<dim, Real>(8, Real(0.02), Real(0.1))
                          : blob<dim, Real>(8, Real(0.0195), Real(0.1));
    give_random_velocities(fluid, Real(0.5), 11);
    const auto before = velocity_sum(fluid);
    Simulation sim{std::move(fluid), UniformGrid<dim, Real>{},
                   Flow<Case10, dim, Real>({.spacing = 0.02,
                                            .viscosity = 1e-3,
                                            .gravity = Vec<dim>::Zero(),
                                            .max_time_step = 1e-3}),
                   SemiImplicit{}};
    for (int k = 0; k < 20; ++k) sim.step();
    EXPECT_GT(sim.interaction().last_solve().unknowns, 10u);
    EXPECT_LE((velocity_sum(sim.particles()) - before).norm(),
              double(TypeParam::rounding) * 20 * speed_sum(sim.particles()))
        << (periodic ? "periodic" : "free");
  }
}

TEST(Flow, WithoutFreeSurfaceHasASolutionWithMinimumPressureZero) {
  struct Closed : Case10 {
    NoSurface surface{};
  };
  auto fluid = full_box<2, double>(12, 0.02, 0.05);
  give_random_velocities(fluid, 0.1, 3);
  Simulation sim{std::move(fluid), UniformGrid<2>{},
                 Flow<Closed>({.spacing = 0.02, .gravity = Vec<2>::Zero(), .max_time_step = 1e-3}),
                 SemiImplicit{}};
  for (int k = 0; k < 10; ++k) {
    sim.step();
    EXPECT_EQ(sim.interaction().last_solve().unknowns, 144u);
    EXPECT_EQ(sim.interaction().last_solve().reason, SolveReport::Reason::converged);
    const auto p = sim.particles()[mps::pressure];
    EXPECT_EQ(*std::min_element(p.begin(), p.end()), 0);
    EXPECT_GT(*std::max_element(p.begin(), p.end()), 0);
  }
}

TEST(Flow, WithoutParticlesCanBeStepped) {
  auto sim = simulation(mps::Fluid<2>{}, {.spacing = 0.02});
  sim.step(1e-3);
  EXPECT_EQ(sim.interaction().last_solve().reason, SolveReport::Reason::nothing_to_solve);
}

TEST(Flow, ExcludesAnIsolatedParticleFromThePressureEquation) {
  auto sim = simulation(fluid_at<2, double>({{0, 0}}), {.spacing = 0.02});
  for (int k = 0; k < 10; ++k) sim.step(1e-3);
  EXPECT_NEAR(sim.particles()[velocity][0][1], -9.81e-2, 1e-12);
  EXPECT_EQ(sim.particles()[mps::pressure][0], 0);
}

// --- bad input -----------------------------------------------------------------------------------

template <class Fluid>
auto first_step_of(const Fluid& fluid, double spacing) {
  return [=] {
    Simulation sim{fluid, UniformGrid<Fluid::dimension, typename Fluid::Real>{},
                   Flow<Case10, Fluid::dimension, typename Fluid::Real>(
                       {.spacing = spacing, .speed_scale = 2}),
                   SemiImplicit{}};
    sim.step();
  };
}

TYPED_TEST(Blobs, OfAnotherSpacingThanTheFlowAreRejected) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  const auto tank = small_dam<dim, Real>(0.02);
  const std::string message = "FlowSettings: spacing = ";
  EXPECT_TRUE(refuses(first_step_of(tank, 0.04), {"0.02 m apart", message + "0.04 m", "step 0"}));
  EXPECT_TRUE(refuses(first_step_of(tank, 0.01), {"0.02 m apart", message + "0.01 m"}));
  EXPECT_NO_THROW(first_step_of(tank, 0.02)());
}

TYPED_TEST(Blobs, ThatAreRandomOrHaveTheirDensityAreNotTakenForAnotherSpacing) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  const auto box = cube<dim, Real>(0, Real(0.2));
  const Index number = dim == 2 ? 100 : 1000;
  EXPECT_NO_THROW(first_step_of(fluid_at(random_points(number, box, 5)), 0.02)());
  EXPECT_NO_THROW(first_step_of(blob<dim, Real>(8, Real(0.018)), 0.02)());
  EXPECT_NO_THROW(first_step_of(blob<dim, Real>(8, Real(0.022)), 0.02)());
  EXPECT_NO_THROW(first_step_of(fluid_at(random_points(number / 4, box, 5)), 0.02)());
  // A row of particles.
  auto thin = box;
  thin.upper[1] = Real(0.02);
  EXPECT_NO_THROW(first_step_of(fluid_at(lattice<dim, Real>(thin, Real(0.02))), 0.02)());
}

TYPED_TEST(Blobs, ThatDoNotFitIntoAPeriodicBoxAreRejected) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  auto box = cube<dim, Real>(0, Real(0.16));
  box.upper[1] = Real(0.17);
  box.periodic[1] = true;
  const auto filled = fluid_at(lattice<dim, Real>(box, Real(0.02)), box);
  EXPECT_TRUE(refuses(first_step_of(filled, 0.02), {"periodic side 0.17 m along axis 1",
                                                    "8.5 spacings", "integer number", "step 0"}));
  box.upper[1] = Real(0.16);
  EXPECT_NO_THROW(first_step_of(fluid_at(lattice<dim, Real>(box, Real(0.02)), box), 0.02)());
  // Random points, and a body that does not reach around the box, fit into any.
  box.upper[1] = Real(0.17);
  auto wide = cube<dim, Real>(-1, 1);
  wide.periodic[1] = true;
  wide.lower[1] = 0;
  wide.upper[1] = Real(0.17);
  const Index number = dim == 2 ? 68 : 544;
  EXPECT_NO_THROW(first_step_of(fluid_at(random_points(number, box, 5), wide), 0.02)());
  wide.upper[1] = Real(0.33);
  const auto body = lattice<dim, Real>(cube<dim, Real>(0, Real(0.16)), Real(0.02));
  EXPECT_NO_THROW(first_step_of(fluid_at(body, wide), 0.02)());
}

TYPED_TEST(Blobs, AreNotCheckedAfterTheFirstStep) {
  using Real = typename TypeParam::Real;
  constexpr int dim = TypeParam::dimension;
  Simulation sim{blob<dim, Real>(6, Real(0.02)), UniformGrid<dim, Real>{},
                 Flow<Case10, dim, Real>({.spacing = 0.02, .speed_scale = 2}), SemiImplicit{}};
  sim.step();
  for (auto& x : sim.particles()[position]) x *= 2;
  EXPECT_NO_THROW(sim.step());
}

TEST(FlowSettings, AreRejectedByNameAndValue) {
  const auto rejected = [](const std::function<void(Settings&)>& modify,
                           const std::string& message) {
    Settings settings{.spacing = 0.01};
    modify(settings);
    return refuses([&] { Flow<Case10> flow(settings); }, {"FlowSettings: " + message});
  };
  EXPECT_TRUE(refuses([] { Flow<Case10> flow({}); }, {"FlowSettings: spacing = 0 "}));
  EXPECT_TRUE(rejected([](auto& s) { s.spacing = -1; }, "spacing = -1 "));
  EXPECT_TRUE(rejected([](auto& s) { s.spacing = nan; }, "spacing = nan "));
  EXPECT_TRUE(rejected([](auto& s) { s.density = 0; }, "density = 0 "));
  EXPECT_TRUE(rejected([](auto& s) { s.density = inf; }, "density = inf "));
  EXPECT_TRUE(rejected([](auto& s) { s.viscosity = -1e-6; }, "viscosity = -1e-06 "));
  EXPECT_TRUE(rejected([](auto& s) { s.viscosity = nan; }, "viscosity = nan "));
  EXPECT_TRUE(rejected([](auto& s) { s.gravity[1] = nan; }, "gravity = nan "));
  EXPECT_TRUE(rejected([](auto& s) { s.radius = 1; }, "radius = 1 must be above 1 and at most 10"));
  EXPECT_TRUE(rejected([](auto& s) { s.radius = 31; }, "radius = 31 "));
  EXPECT_TRUE(rejected([](auto& s) { s.laplacian_radius = 0.5; }, "laplacian_radius = 0.5 "));
  EXPECT_TRUE(rejected([](auto& s) { s.laplacian_radius = nan; }, "laplacian_radius = nan "));
  EXPECT_TRUE(rejected([](auto& s) { s.courant = 0; }, "courant = 0 must be above 0 and at most"));
  EXPECT_TRUE(rejected([](auto& s) { s.courant = 3; }, "courant = 3 must be above 0 and at most"));
  EXPECT_TRUE(rejected([](auto& s) { s.speed_scale = -2; }, "speed_scale = -2 "));
  EXPECT_TRUE(rejected([](auto& s) { s.max_time_step = 0; }, "max_time_step = 0 "));
  EXPECT_TRUE(rejected([](auto& s) { s.max_time_step = nan; }, "max_time_step = nan "));
}

TEST(FlowSettings, AreRejectedForInvalidParametersOfPolicies) {
  const auto rejected = [](const std::function<void(Settings&)>& modify,
                           const std::string& message) {
    Settings settings{.spacing = 0.01};
    modify(settings);
    return refuses([&] { Flow<Case10> flow(settings); }, {message});
  };
  EXPECT_TRUE(rejected([](auto& s) { s.source.gamma = -1; }, "DivergenceSource: gamma = -1 "));
  EXPECT_TRUE(rejected([](auto& s) { s.surface.first.beta = 2; }, "DensitySurface: beta = 2 "));
  EXPECT_TRUE(rejected([](auto& s) { s.surface.second.beta = 2; }, "CountSurface: beta = 2 "));
  EXPECT_TRUE(rejected([](auto& s) { s.collision.restitution = 2; }, "restitution = 2 "));
}

TEST(FlowSeconds, BeginAtZero) {
  const mps::Flow<mps::Case10> water{{.spacing = 0.01}};
  const mps::FlowSeconds& seconds = water.seconds();
  EXPECT_EQ(seconds.neighbours, 0);
  EXPECT_EQ(seconds.assembly, 0);
  EXPECT_EQ(seconds.solve, 0);
  EXPECT_EQ(seconds.pressure, 0);
}

}  // namespace
}  // namespace silt::test::flow_test
