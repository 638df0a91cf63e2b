// SPDX-License-Identifier: MIT
// Flows whose pressure is defined up to a constant: a full tank with a lid, and a periodic box.
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/slow_types.hpp"

#include <silt/solve/eigen_conjugate_gradient.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::closed_tank_test {
namespace {

using mps::Case10;
using mps::Kind;

constexpr double l0 = 0.02;

mps::Tank<2> full_size() {
  return {.column = {0.3, 0.4}, .size = {.length = 0.3, .height = 0.4}, .spacing = l0, .lid = true};
}
mps::Fluid<2> full_tank() { return mps::make_tank(full_size()); }

TEST(TankWithALid, IsClosedAllAround) {
  const auto tank = full_tank();
  EXPECT_EQ(mps::count(tank, Kind::fluid), 15u * 20u);
  EXPECT_EQ(mps::count(tank, Kind::wall), 17u * 22u - 15u * 20u);
  EXPECT_EQ(mps::count(tank, Kind::dummy), 25u * 30u - 17u * 22u);
  for (const auto& x : tank[position]) EXPECT_TRUE(tank.box().contains(x));
  const auto room = mps::make_tank<3>({.column = {0.1, 0.06},
                                       .size = {.length = 0.1, .height = 0.06, .depth = 0.08},
                                       .spacing = l0,
                                       .dummy_layers = 3,
                                       .lid = true});
  EXPECT_EQ(mps::count(room, Kind::fluid), 5u * 4u * 3u);
  EXPECT_EQ(mps::count(room, Kind::wall), 7u * 6u * 5u - 5u * 4u * 3u);
  EXPECT_EQ(room.size(), 13u * 12u * 11u);
}

template <class S>
class ClosedFlows : public ::testing::Test {};
using Solvers = AllOrUsual<::testing::Types<mps::PressureSolver<2>, EigenConjugateGradient>,
                           ::testing::Types<mps::PressureSolver<2>>>;
TYPED_TEST_SUITE(ClosedFlows, Solvers);

template <class Solver>
auto flow_of(mps::Fluid<2> fluid, mps::FlowSettings<2, Case10> settings) {
  settings.max_time_step = 1e-3;
  return Simulation{std::move(fluid), UniformGrid<2>{},
                    mps::Flow<Case10, 2, double, Solver>(settings), SemiImplicit{}};
}

// Least-squares fit of the pressure of the fluid: constant + slope shape(x).
struct Fit {
  double slope;
  double residual;  // standard deviation of the residual over that of the pressure [-]
};
template <class P, class F>
Fit fit_pressure(const P& particles, F&& shape) {
  double n = 0, s = 0, p = 0, ss = 0, sp = 0, pp = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != Kind::fluid) continue;
    const double each = shape(particles[position][i]);
    const double pressure = particles[mps::pressure][i];
    n += 1, s += each, p += pressure;
    ss += each * each, sp += each * pressure, pp += pressure * pressure;
  }
  const double slope = (n * sp - s * p) / (n * ss - s * s);
  const double explained = slope * (n * sp - s * p) / (n * pp - p * p);
  return {slope, std::sqrt(1 - explained)};
}

TYPED_TEST(ClosedFlows, HaveTheHydrostaticPressureInAFullTank) {
  auto sim = flow_of<TypeParam>(full_tank(), {.spacing = l0});
  double slope = 0;
  for (int k = 0; k < 100; ++k) {
    sim.step();
    EXPECT_EQ(sim.interaction().last_solve().unknowns, 17u * 22u) << "all but dummies";
    const auto p = sim.particles()[mps::pressure];
    EXPECT_EQ(*std::min_element(p.begin(), p.end()), 0);
    const auto hydrostatic = [](const Vec<2>& x) { return -9810 * x[1]; };
    if (k >= 20) slope += fit_pressure(sim.particles(), hydrostatic).slope / 80;
  }
  EXPECT_NEAR(slope, 1, 0.03);
}

// The pressure is zero at the height of the highest particle with a pressure.
template <class Scheme>
void expect_rest_in_a_full_tank(double height) {
  const auto tank = mps::make_tank<Scheme>(full_size());
  Simulation sim{tank.particles, UniformGrid<2>{},
                 mps::Flow<Scheme>({.spacing = l0, .speed_scale = 2, .walls = tank.walls}),
                 SemiImplicit{}};
  for (int k = 0; k < 100; ++k) sim.step();
  for (Index i = 0; i < sim.particles().size(); ++i) {
    EXPECT_LT(sim.particles()[velocity][i].norm(), 1e-6);
    if (sim.particles()[mps::kind][i] == Kind::dummy) continue;
    const double depth = height - sim.particles()[position][i][1];
    EXPECT_NEAR(sim.particles()[mps::pressure][i], 9810 * depth, 0.1);
  }
}
TEST(ClosedFlow, WithTheRecommendedSchemesIsAtRestWithTheExactHydrostaticPressure) {
  expect_rest_in_a_full_tank<mps::Recommended>(0.4 - l0 / 2);
  expect_rest_in_a_full_tank<mps::RecommendedForWallParticles>(0.4 + l0 / 2);  // the lid
}

TYPED_TEST(ClosedFlows, HaveThePressureOfATaylorGreenVortex) {
  // u = −U cos 2πx sin 2πy, v = U sin 2πx cos 2πy in a square of edge 1 m.
  constexpr double k = 2 * std::numbers::pi;
  const auto run = [&](int along) {
    auto fluid = full_box<2, double>(along, 1.0 / along);
    for (Index i = 0; i < fluid.size(); ++i) {
      const auto& x = fluid[position][i];
      fluid[velocity][i] = {-std::cos(k * x[0]) * std::sin(k * x[1]),
                            std::sin(k * x[0]) * std::cos(k * x[1])};
    }
    // No collisions and γ = 0, which would both act against the shearing of the lattice.
    auto sim = flow_of<TypeParam>(std::move(fluid), {.spacing = 1.0 / along,
                                                     .viscosity = 0.01,
                                                     .gravity = Vec<2>::Zero(),
                                                     .source = {.gamma = 0},
                                                     .collision = {.distance = 0}});
    for (int step = 0; step < 5; ++step) {
      sim.step();
      EXPECT_EQ(sim.interaction().last_solve().unknowns, Index(along * along));
    }
    return fit_pressure(sim.particles(), [&](const Vec<2>& x) {
      return -250 * (std::cos(2 * k * x[0]) + std::cos(2 * k * x[1]));
    });
  };
  const Fit coarse = run(20);
  const Fit fine = run(40);
  // The source includes the divergence that the previous projection left: up to a fifth too much.
  EXPECT_LT(fine.residual, 0.05);
  EXPECT_GT(fine.slope, 1);
  EXPECT_LT(fine.slope, 1.25);
  EXPECT_LT(fine.slope, coarse.slope - 0.05);
}

}  // namespace
}  // namespace silt::test::closed_tank_test
