// SPDX-License-Identifier: MIT
// The limits of the time step of a flow, individually, and rejected steps. More in flow_test.cpp.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <silt/io/checkpoint.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>

namespace silt::test::time_step_test {
namespace {

using mps::Case10;
using Settings = mps::FlowSettings<2, Case10>;
using SolvedFlow = mps::Flow<Case10, 2, double, ConjugateGradient<>>;

template <class P>
auto simulation(P particles, const Settings& settings, const SolveSettings& solve = {}) {
  return Simulation{std::move(particles), UniformGrid<2>{},
                    SolvedFlow(settings, ConjugateGradient<>(solve)), SemiImplicit{}};
}

// A blob that is first fast and then nearly at rest: its step may grow.
auto slowed(const Settings& settings = {.spacing = 0.02}) {
  auto sim = simulation(blob<2, double>(6, 0.02), settings);
  for (auto& u : sim.particles()[velocity]) u = {20, 0};
  sim.step();
  for (auto& u : sim.particles()[velocity]) u = {0.01, 0};
  return sim;
}

TEST(TimeStepLimits, AreThoseOfTheDocumentation) {
  auto sim = simulation(blob<2, double>(6, 0.02),
                        {.spacing = 0.02, .viscosity = 0.5, .max_time_step = 0.7});
  sim.particles()[velocity][3] = {3, 4};
  const mps::TimeStepLimits limits = sim.interaction().time_step_limits(sim.particles());
  const mps::Stencil<2, double, mps::CubicKernel> stencil({.spacing = 0.02, .radius = 3.1});
  EXPECT_DOUBLE_EQ(limits.courant, 0.2 * 0.02 / 5);
  EXPECT_DOUBLE_EQ(limits.force, std::sqrt(0.2 * 0.02 / 9.81));
  EXPECT_DOUBLE_EQ(limits.viscous, stencil.lambda / (4 * 2 * 0.5));
  EXPECT_EQ(limits.growth, inf) << "no previous step";
  EXPECT_EQ(limits.max_time_step, 0.7);
  EXPECT_EQ(sim.time_step(), limits.viscous);
  EXPECT_EQ(sim.time_step(), limits.smallest());
}

TEST(TimeStepLimits, AreInfiniteWithoutSpeedGravityAndViscosity) {
  auto sim = simulation(blob<2, double>(6, 0.02),
                        {.spacing = 0.02, .viscosity = 0, .gravity = Vec<2>::Zero()});
  EXPECT_EQ(sim.interaction().time_step_limits(sim.particles()).smallest(), inf);
}

TEST(TimeStepLimits, RefuseInfiniteVelocities) {
  auto sim = simulation(blob<2, double>(6, 0.02), {.spacing = 0.02});
  for (const double u : {inf, 1e200}) {
    sim.particles()[velocity][9] = {0, u};
    EXPECT_TRUE(refuses([&] { sim.step(); }, {"mps::Flow: the velocity (0, ", "finite", "id 9"}));
  }
}

TEST(TimeStepLimits, NameTheSmallest) {
  const auto expect_name = [](const mps::TimeStepLimits& limits, const std::string& name) {
    const std::string text = limits.name_of_smallest();
    EXPECT_EQ(text.substr(0, name.size()), name);
    EXPECT_NE(text.find("1e-20 s"), std::string::npos) << text;
  };
  expect_name({.courant = 1e-20, .viscous = 1}, "the speed of the particles");
  expect_name({.courant = 1, .force = 1e-20}, "the acceleration");
  expect_name({.courant = 1, .viscous = 1e-20}, "FlowSettings: viscosity");
  expect_name({.courant = 1, .growth = 1e-20}, "FlowSettings: max_growth");
  expect_name({.courant = 1, .max_time_step = 1e-20}, "FlowSettings: max_time_step");
}

TEST(TimeStepLimits, AreNamedBeforeARunThatWouldNeverEnd) {
  Simulation sim{blob<2, double>(3, 0.01), UniformGrid<2>{},
                 mps::Flow<mps::Recommended>({.spacing = 0.01, .viscosity = 1e15}),
                 SemiImplicit{}};
  EXPECT_TRUE(refuses(
      [&] { sim.run({.until = 1}); },
      {"steps are ahead", "mps::Flow: FlowSettings: viscosity allows", "decrease"}));
}

TEST(TimeStepGrowth, IsAtMostAFifthPerStep) {
  auto sim = slowed();
  double last = sim.last_time_step();
  EXPECT_DOUBLE_EQ(last, 0.2 * 0.02 / 20);
  int limited = 0;
  for (int k = 0; k < 40; ++k) {
    const mps::TimeStepLimits limits = sim.interaction().time_step_limits(sim.particles());
    EXPECT_DOUBLE_EQ(limits.growth, 1.2 * last);
    EXPECT_EQ(sim.time_step(), limits.smallest());
    limited += limits.smallest() == limits.growth;
    sim.step();
    last = sim.last_time_step();
  }
  EXPECT_GT(limited, 15);
  EXPECT_LT(limited, 40) << "until another limit applies";
}

TEST(TimeStepGrowth, IsThatOfTheSettings) {
  EXPECT_DOUBLE_EQ(slowed({.spacing = 0.02, .max_growth = 3}).time_step(),
                   3 * 0.2 * 0.02 / 20);
  const double free = slowed({.spacing = 0.02, .max_growth = inf}).time_step();
  EXPECT_DOUBLE_EQ(free, std::sqrt(0.2 * 0.02 / 9.81));
  EXPECT_TRUE(refuses([] { slowed({.spacing = 0.02, .max_growth = 0.9}); },
                      {"FlowSettings: max_growth = 0.9 ", "at least 1"}));
  EXPECT_TRUE(refuses([] { slowed({.spacing = 0.02, .max_growth = nan}); },
                      {"FlowSettings: max_growth = nan "}));
}

TEST(TimeStepGrowth, IsNotEnforcedForUserDefinedStepsButStartsFromThem) {
  auto sim = slowed();
  sim.step(8e-3);
  EXPECT_DOUBLE_EQ(sim.interaction().time_step_limits(sim.particles()).growth, 1.2 * 8e-3);
}

TEST(TimeStepGrowth, StartsFromThePreviousStepAfterAFailedStep) {
  auto sim = slowed();
  const double chosen = sim.time_step();
  sim.particles()[position][5] = sim.particles()[position][4];
  EXPECT_TRUE(refuses([&] { sim.step(1e-3); }, {"same position"}));
  EXPECT_EQ(sim.time_step(), chosen);
}

TEST(TimeStepGrowth, ResumesFromACheckpoint) {
  const auto path = std::filesystem::path(testing::TempDir()) / "silt_growth.silt";
  auto uninterrupted = slowed();
  uninterrupted.step();
  write_checkpoint(path, uninterrupted);
  auto resumed = simulation(blob<2, double>(6, 0.02), {.spacing = 0.02});
  EXPECT_NE(resumed.time_step(), uninterrupted.time_step());
  read_checkpoint(path, resumed);
  std::filesystem::remove(path);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(resumed.time_step(), uninterrupted.time_step());
    EXPECT_EQ(resumed.time_step(), 1.2 * resumed.last_time_step());
    resumed.step();
    uninterrupted.step();
  }
  EXPECT_TRUE(state_of(resumed.particles()) == state_of(uninterrupted.particles()));
}

TEST(UserDefinedTimeStep, IsRejectedBeyondEachStabilityLimitAndRolledBack) {
  const auto rejected = [](const Settings& settings, double dt, const Vec<2>& u,
                          const std::vector<std::string>& message) {
    auto sim = simulation(blob<2, double>(6, 0.02), settings);
    sim.particles()[velocity][9] = u;
    const auto before = state_of(sim.particles());
    const auto result = refuses([&] { sim.step(dt); }, message);
    EXPECT_TRUE(state_of(sim.particles()) == before);
    EXPECT_EQ(sim.steps(), 0u);
    EXPECT_EQ(sim.time(), 0);
    return result;
  };
  EXPECT_TRUE(rejected({.spacing = 0.02}, 0.011, {0, 2},
                      {"time_step = 0.011 s moves a particle of 2 m/s", "use at most 0.002 s",
                       "id 9"}));
  EXPECT_TRUE(rejected({.spacing = 0.02, .viscosity = 1}, 1e-3, {0, 0},
                      {"time_step = 0.001 s exceeds the viscous limit "}));
  EXPECT_TRUE(rejected({.spacing = 0.02}, 0.05, {0, 0},
                      {"time_step = 0.05 s moves a particle from rest", "use at most 0.020"}));
  EXPECT_TRUE(rejected({.spacing = 0.02}, 1e-3, {nan, 0},
                      {"the velocity (nan, 0) m/s is not finite", "id 9", "step 0"}));
  EXPECT_TRUE(rejected({.spacing = 0.02}, 1e-3, {0, -inf}, {"the velocity (0, -inf) m/s is not"}));
}

TEST(UserDefinedTimeStep, MayBeTwiceTheViscousLimitButNotLonger) {
  const auto water = blob<2, double>(6, 0.02);
  const Settings settings{.spacing = 0.02};
  const mps::TimeStep::Input input{.viscous = 1e-3, .time = 0};
  mps::TimeStep time_step;
  EXPECT_NO_THROW(time_step.begin(water, settings, input, 2e-3));
  EXPECT_TRUE(refuses([&] { time_step.begin(water, settings, input, std::nextafter(2e-3, 1)); },
                      {"exceeds the viscous limit 0.002 s"}));
}

}  // namespace
}  // namespace silt::test::time_step_test
