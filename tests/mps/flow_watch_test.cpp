// SPDX-License-Identifier: MIT
// Speeds and energies that nothing had, in the step that gives them.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace silt::test::flow_watch_test {
namespace {

constexpr double l0 = 0.02;  // [m]
constexpr double dt = 1e-3;  // [s]

// Sheets break up into pairs that no pressure separates: 1e14 m/s after 1400 ever smaller steps.
struct NotKeptApart : mps::Recommended {
  mps::KeepApart collision{.distance = 0, .image_distance = 0};
};
TEST(FlowWatch, EndsADamBreakWhoseParticlesAreNotKeptApart) {
  auto tank = mps::make_tank<NotKeptApart, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.6, .height = 1.6}, .spacing = l0});
  Simulation dam{std::move(tank.particles), UniformGrid<2>{},
                 mps::Flow<NotKeptApart>(
                     {.spacing = l0, .speed_scale = 2.8, .walls = tank.walls}),
                 SemiImplicit<>{}};
  double fastest = 0;
  std::string message;
  try {
    while (dam.time() < 1) {
      dam.step();
      for (const auto& u : dam.particles()[velocity]) fastest = std::max(fastest, u.norm());
    }
  } catch (const Error& error) {
    message = error.what();
  }
  EXPECT_NE(message.find("m/s"), std::string::npos) << message;
  EXPECT_LT(fastest, 10 * (4 + 0.1));  // of the last step that succeeded
}

// A watch of two particles of 1 kg that have this speed before a step and that one after it.
struct Speeds {
  double before;
  double after;
};
void check_step_of(const Speeds& speeds, const Vec<2>& gravity = {0, -9.81}) {
  auto fluid = fluid_at<2, double>({{0, 0}, {0, 0.05}});
  const auto set = [&](double speed) {
    for (auto& u : fluid[velocity]) u = {speed, 0};
    return speed * speed;  // the energy
  };
  mps::BodyForce<2, double> force(gravity);
  mps::FlowWatch<2, double> watch;
  const mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0};
  watch.begin(fluid, force, dt, set(speeds.before));
  const double kinetic = set(speeds.after);
  watch.end(fluid);
  watch.check(fluid, settings, kinetic, 1, dt);
}

TEST(FlowWatch, LimitsTheSpeedToTenTimesThatOfTheDeepestFall) {
  const double fall = std::sqrt(2 * 9.81 * 0.05);
  EXPECT_NO_THROW(check_step_of({9 * fall, 9 * fall}));
  EXPECT_TRUE(refuses([&] { check_step_of({5, 60}); },
                      {"mps::Flow: velocity = (60, 0) m/s is more than ten times", "Courant"}));
}

TEST(FlowWatch, LimitsTheEnergyToTenTimesThatBeforeTheStep) {
  // Disorder may add that of a tenth of a spacing in a step, here of 2 m/s.
  EXPECT_NO_THROW(check_step_of({1, 7}));
  EXPECT_TRUE(refuses([&] { check_step_of({1, 7.3}); },
                      {"the kinetic energy after the step, 53.29 J", "ten times", ", 5.0"}));
}

TEST(FlowWatch, AllowsTheNoiseOfFluidAtRest) { EXPECT_NO_THROW(check_step_of({0, 1e-4}, {0, 0})); }

TEST(FlowWatch, AllowsAnEndlessFallAndSpeedsThatAreSetBetweenSteps) {
  auto box = cube<2, double>(0, 10 * l0);
  box.periodic.fill(true);
  Simulation sim{full_box<2, double>(10, l0), UniformGrid<2>{},
                 mps::Flow<mps::Recommended>({.spacing = l0, .gravity = {0, -1e4}}), SemiImplicit<>{}};
  for (int k = 0; k < 300; ++k) sim.step();
  EXPECT_GT(sim.particles()[velocity][0].norm(), 100);
  for (auto& u : sim.particles()[velocity]) u = {1e5, 0};
  EXPECT_NO_THROW(sim.step());
}

// A wall that starts to move drives fluid at rest.
TEST(FlowWatch, AllowsWallsThatMove) {
  auto fluid = fluid_at<2, double>({{0, 0}, {0, 0.05}});
  mps::add_particle(fluid, {0.1, 0}, mps::Kind::wall);
  fluid[velocity][2] = {50, 0};
  mps::FlowWatch<2, double> watch;
  watch.begin(fluid, mps::BodyForce<2, double>(Vec<2>(0, 0)), dt, 0);
  fluid[velocity][0] = {20, 0};
  watch.end(fluid);
  const mps::FlowSettings<2, mps::Recommended> settings{.spacing = l0};
  EXPECT_NO_THROW(watch.check(fluid, settings, 200, 1, dt));
}

}  // namespace
}  // namespace silt::test::flow_watch_test
