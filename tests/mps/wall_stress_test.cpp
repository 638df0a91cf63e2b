// SPDX-License-Identifier: MIT
// Viscous stresses of walls: exact laminar flows over walls that fluid sticks to, and the law of the
// wall.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/policy/wall_stress.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace silt::test::wall_stress_test {
namespace {

static_assert(mps::WallStress<mps::FreeSlip> && mps::WallStress<mps::NoSlip> &&
              mps::WallStress<mps::WallLaw>);

template <class Stress>
struct With : mps::Recommended {
  mps::NoFriction friction{};
  Stress wall_stress{};
};

constexpr double nu = 1e-3;  // [m²/s]

// A periodic channel between floor and lid, at rest or with a velocity along it.
template <class Stress>
auto channel(int rows, double height, double speed, auto force) {
  const double l0 = height / rows;
  Box<2> box{.lower = {0, 0}, .upper = {8 * l0, height}, .periodic = {true, false}};
  auto fluid = fluid_at(lattice<2>({{0, 0}, {8 * l0, height}}, l0), box);
  for (auto& u : fluid[velocity]) u = {speed, 0};
  mps::FlowSettings<2, With<Stress>> settings{
      .spacing = l0, .viscosity = nu, .gravity = {0, 0}, .speed_scale = 1, .body_force = force};
  for (const double y : {0.0, height}) {
    settings.walls.segments.push_back({{Vec<2>(-8 * l0, y), Vec<2>(16 * l0, y)}});
  }
  return Simulation{std::move(fluid), UniformGrid<2>{}, mps::Flow<With<Stress>>(settings),
                    SemiImplicit<>{}};
}

// Of the particles, u(y) against the exact one, over the largest exact one: rms.
template <class Sim, class F>
double error_of(const Sim& sim, F&& exact) {
  double sum = 0, largest = 0;
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    const double u = exact(water[position][i][1]);
    sum += squared(water[velocity][i][0] - u);
    largest = std::max(largest, std::abs(u));
  }
  return std::sqrt(sum / double(water.size())) / largest;
}

// u = F/(2ν) y (H − y)
TEST(NoSlip, HasTheProfileOfPoiseuille) {
  constexpr double H = 0.1, F = 0.1;
  double last = 1;
  for (const int rows : {10, 20}) {
    // Begins with the mean of the profile: less than a fifth of the slowest mode is wrong at first,
    // and e^{−3.3} of that in the end (3.3 ν π²/H² = 3.3).
    auto sim = channel<mps::NoSlip>(rows, H, F * H * H / (12 * nu),
                                    [F](const Vec<2>&, double) { return Vec<2>(F, 0); });
    while (sim.time() < 3.3) sim.step();
    const double error = error_of(sim, [](double y) { return F / (2 * nu) * y * (H - y); });
    EXPECT_LT(error, 0.03) << rows;
    EXPECT_LT(error, last);
    last = error;
  }
}

// Stokes' first problem, of a fluid that moves over a wall at rest: u = U erf(y/√(4νt)).
TEST(NoSlip, HasTheLayerOfStokesFirstProblem) {
  constexpr double H = 0.2, U = 0.1;
  auto sim = channel<mps::NoSlip>(40, H, U, nullptr);
  while (sim.time() < 0.4) sim.step();
  const double width = std::sqrt(4 * nu * sim.time());
  EXPECT_LT(error_of(sim, [&](double y) {
              return U * (std::erf(y / width) + std::erf((H - y) / width) - 1);
            }),
            0.03);
}

// Stokes' second problem, of a fluid that oscillates over a wall at rest, driven by A ω cos ωt:
// u = A (sin ωt − e^{−ky} sin(ωt − ky)), k = √(ω/2ν).
TEST(NoSlip, HasTheLayerOfStokesSecondProblem) {
  constexpr double H = 0.16, A = 0.1, omega = 2 * std::numbers::pi;
  auto sim = channel<mps::NoSlip>(32, H, 0, [](const Vec<2>&, double t) {
    return Vec<2>(A * omega * std::cos(omega * t), 0);
  });
  while (sim.time() < 2.25) sim.step();
  const double k = std::sqrt(omega / (2 * nu)), t = sim.time();
  const auto from_wall = [&](double y) { return std::exp(-k * y) * std::sin(omega * t - k * y); };
  EXPECT_LT(error_of(sim, [&](double y) {
              return A * (std::sin(omega * t) - from_wall(y) - from_wall(H - y));
            }),
            0.03);
}

TEST(FreeSlip, LeavesFluidOverWallsUnchanged) {
  auto sim = channel<mps::FreeSlip>(10, 0.1, 0.1, nullptr);
  for (int k = 0; k < 50; ++k) sim.step();
  EXPECT_LT(error_of(sim, [](double) { return 0.1; }), 1e-9);
}

TEST(WallLaw, HasTheVelocitiesOfTheLawOfTheWall) {
  const mps::WallLaw smooth, rough{.roughness = 1e-3};
  constexpr double of_water = 1e-6;
  // In the sublayer.
  EXPECT_NEAR(smooth.friction_velocity(1e-3, 1e-3, of_water), 1e-3, 1e-12);
  for (const double u : {0.1, 1.0, 10.0}) {
    const double found = smooth.friction_velocity(u, 0.005, of_water);
    EXPECT_NEAR(u / found, std::log(0.005 * found / of_water) / 0.41 + 5, 1e-9);
    EXPECT_NEAR(u / rough.friction_velocity(u, 0.005, of_water), std::log(5.0) / 0.41 + 8.5, 1e-9);
  }
}

// Fluid that moves as a whole loses τ per area of wall.
TEST(WallLaw, BrakesTheRowAtTheWall) {
  constexpr double l0 = 0.01, U = 1;
  auto sim = channel<mps::WallLaw>(10, 0.1, U, nullptr);
  sim.step();
  const double stress = squared(mps::WallLaw{}.friction_velocity(U, l0 / 2, nu));
  double change = 0;
  for (const auto& u : sim.particles()[velocity]) change += squared(l0) * (U - u[0]);
  const double area = 2 * 8 * l0;  // of both walls
  EXPECT_NEAR(change / (area * stress * sim.time()), 1, 1e-6);
}

TEST(WallLaw, RefusesNegativeRoughness) {
  mps::FlowSettings<2, With<mps::WallLaw>> settings{.spacing = 0.01, .wall_stress = {-1}};
  EXPECT_TRUE(refuses([&] { settings.check(); }, {"WallLaw: roughness = -1"}));
}

}  // namespace
}  // namespace silt::test::wall_stress_test
