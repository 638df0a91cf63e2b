// SPDX-License-Identifier: MIT
// The policies beyond the paper, individually and combined in RecommendedForWallParticles.
#include <silt/mps.hpp>
#include <silt/mps/operator/corrected_gradient.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/points.hpp"
#include "support/view.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::test::recommended_test {
namespace {

using mps::CollidingPair;
using mps::Kind;
using mps::RecommendedForWallParticles;

// --- kernels -------------------------------------------------------------------------------------

template <class K>
class SmoothKernels : public ::testing::Test {};
using AllKernels = ::testing::Types<mps::InverseKernel, mps::GaussianKernel, mps::CubicKernel,
                                    mps::WendlandKernel>;
TYPED_TEST_SUITE(SmoothKernels, AllKernels);

TYPED_TEST(SmoothKernels, HaveTheirDerivativesAsSlopeAndCurvature) {
  const double h = 1e-4;
  for (const double q : {0.2, 0.45, 0.7, 0.95}) {
    const double w0 = TypeParam::weight(q - h);
    const double w = TypeParam::weight(q);
    const double w1 = TypeParam::weight(q + h);
    const double size = 1 + std::abs(TypeParam::curvature(q));
    EXPECT_NEAR(TypeParam::slope(q), (w1 - w0) / (2 * h), 1e-5 * size);
    EXPECT_NEAR(TypeParam::curvature(q), (w1 - 2 * w + w0) / (h * h), 1e-5 * size);
    const auto weights = mps::HigherOrderLaplacian{}.weights<2>(TypeParam{});
    EXPECT_NEAR(weights.weight(q), TypeParam::curvature(q) - TypeParam::slope(q) / q,
                1e-12 * size);
    EXPECT_GE(mps::HigherOrderLaplacian{}.weights<3>(TypeParam{}).weight(q), 0);
  }
}

// --- gradient, rates -----------------------------------------------------------------------------

TEST(CorrectedGradient, IsExactForLinearFieldsIncludingBoundaries) {
  const double l0 = 0.1;
  const auto points = jittered<2, double>(12, l0, 0.2);
  const mps::Stencil<2, double, mps::WendlandKernel> stencil({.spacing = l0, .radius = 3.1});
  const Vec<2> slope(3, -7);
  for (Index i = 0; i < points.size(); ++i) {
    const auto for_each = [&](auto&& f) {
      for (Index j = 0; j < points.size(); ++j) {
        const Vec<2> r_ij = points[j] - points[i];
        const double r = r_ij.norm();
        if (j == i || r >= stencil.re) continue;
        const double w = stencil.weight(r);
        f(slope.dot(points[j]), r_ij, w, w / (r * r));
      }
    };
    const Vec<2> found =
        mps::CorrectedGradient{}.evaluate(stencil, slope.dot(points[i]), for_each);
    EXPECT_LT((found - slope).norm(), 1e-12 * slope.norm()) << i;
  }
}

TEST(CorrectedGradient, OfTwoParticlesIsNotCorrected) {
  const mps::Stencil<2, double, mps::WendlandKernel> stencil({.spacing = 1, .radius = 3.1});
  const auto one = [](auto&& f) { f(2.0, Vec<2>(1, 0), 0.5, 0.5); };
  const Vec<2> found = mps::CorrectedGradient{}.evaluate(stencil, 1.0, one);
  EXPECT_DOUBLE_EQ(found[0], 2 / stencil.n0 * 0.5);
}

TEST(DensityRate, IsTheTimeDerivativeOfTheNumberDensity) {
  const double l0 = 0.1, dt = 1e-6;
  const mps::Stencil<2, double, mps::CubicKernel> stencil({.spacing = l0, .radius = 3.1});
  auto points = jittered<2, double>(10, l0, 0.2);
  std::vector<Vec<2>> u;
  for (const auto& x : points) u.push_back({-0.3 * x[0] + 0.2 * x[1], 0.5 * x[1] * x[0]});
  const auto density = [&](Index i) {
    double n = 0;
    for (Index j = 0; j < points.size(); ++j) {
      const double r = (points[j] - points[i]).norm();
      if (j != i && r < stencil.re) n += stencil.weight(r);
    }
    return n;
  };
  BruteForce<2> search;
  search.set_radius(stencil.re);
  auto fluid = fluid_at<2, double>(points);
  search.update(fluid);
  for (const Index i : {Index(0), Index(44), Index(99)}) {
    const double rate = mps::density_rate(search, stencil, i, u);
    const double before = density(i);
    auto moved = points;
    for (Index j = 0; j < points.size(); ++j) moved[j] += dt * u[j];
    std::swap(points, moved);
    EXPECT_NEAR(rate, (density(i) - before) / dt / stencil.n0, 1e-4);
    std::swap(points, moved);
  }
}

TEST(ErrorCompensatingSource, IsTheHigherOrderSourceIfThereIsNoError) {
  ViewOf now{{.density = 1000, .time_step = 1e-3, .density_rate = 2}};
  mps::ErrorCompensatingSource source;
  source.begin(StepOf{.numbers = {.density_rate = 0}});
  EXPECT_DOUBLE_EQ(source.value(now), -2e6);
  EXPECT_DOUBLE_EQ(mps::HigherOrderSource{}.value(now), -2e6);
  // More pressure for fluid that is compressed and was being compressed.
  now.numbers.compression = 0.01;
  source.begin(StepOf{.numbers = {.density_rate = 3}});
  EXPECT_DOUBLE_EQ(source.value(now), -1e6 * (2 + 0.03 + 0.03));
}

// --- pairs ---------------------------------------------------------------------------------------

TEST(KeepApart, DoesNotChangePairsThatStayFarEnoughApart) {
  const CollidingPair<2> near{
      .r_ij = {0.95, 0}, .r = 0.95, .u_ij = {-0.1, 0}, .spacing = 1, .time_step = 0.1};
  EXPECT_EQ(mps::KeepApart{}.velocity_change(near).norm(), 0);
  EXPECT_GT(mps::Collision{}.velocity_change(near).norm(), 0);
}

TEST(KeepApart, KeepsPairsApartByAtMostTheImpulseOfACollision) {
  // Approach at speed 2: 0.95 − 0.2 = 0.75 without KeepApart; a distance of 0.9 needs a change of
  // 1.5, a collision changes the speed by 2.4.
  CollidingPair<2> pair{
      .r_ij = {0.95, 0}, .r = 0.95, .u_ij = {-2, 0}, .spacing = 1, .time_step = 0.1};
  EXPECT_NEAR(mps::KeepApart{}.velocity_change(pair)[0], -0.75, 1e-12);
  EXPECT_NEAR(mps::DynamicStabilisation{}.velocity_change(pair)[0], -0.75, 1e-12);
  pair.wall = true;
  EXPECT_NEAR(mps::KeepApart{}.velocity_change(pair)[0], -1.5, 1e-12);
  // Already too close and slow: limited by the collision.
  pair = {.r_ij = {0.5, 0}, .r = 0.5, .u_ij = {-0.1, 0}, .spacing = 1, .time_step = 0.1};
  EXPECT_NEAR(mps::KeepApart{}.velocity_change(pair)[0], -0.06, 1e-12);
  EXPECT_NEAR(mps::DynamicStabilisation{}.velocity_change(pair)[0], -2.05, 1e-12);
}

TEST(KeepApart, NeverIncreasesTheEnergy) {
  const auto numbers = random_points(200, cube<2, double>(-1, 1), 5);
  for (Index k = 0; k + 1 < numbers.size(); ++k) {
    const Vec<2> u_i = 3 * numbers[k];
    const Vec<2> u_j = Vec<2>(numbers[k + 1][1], numbers[k][0]);
    CollidingPair<2> pair{.r_ij = numbers[k + 1],
                          .r = numbers[k + 1].norm(),
                          .u_ij = u_j - u_i,
                          .spacing = 1,
                          .time_step = 0.2};
    const Vec<2> change = mps::KeepApart{}.velocity_change(pair);
    const double before = u_i.squaredNorm() + u_j.squaredNorm();
    const double after = (u_i + change).squaredNorm() + (u_j - change).squaredNorm();
    EXPECT_LE(after, before * (1 + 1e-12));
  }
}

TEST(ParticleShifting, IsAgainstTheConcentrationGradientLimitedAndZeroNearBoundaries) {
  const mps::ParticleShifting shifting;
  ViewOf at{{.time_step = 0.01,
             .concentration_gradient = {0.01, 0},
             .max_relative_speed = 2,
             .spacing = 0.1}};
  EXPECT_NEAR(shifting.displacement(at)[0], -4 * 2 * 0.01 * 0.01, 1e-15);
  at.numbers.concentration_gradient = {10, 0};
  EXPECT_NEAR(shifting.displacement(at)[0], -0.01, 1e-15);
  at.numbers.near_boundary = true;
  EXPECT_EQ(shifting.displacement(at).norm(), 0);
}

// --- surface, walls ------------------------------------------------------------------------------

struct WithCones : RecommendedForWallParticles {
  mps::ConeSurface surface{};
  mps::NoShifting shifting{};
};

template <class Scheme>
void expect_outermost_row_on_surface() {
  Simulation sim{blob<2, double>(12, 0.02), UniformGrid<2>{},
                 mps::Flow<Scheme>({.spacing = 0.02, .gravity = Vec<2>::Zero()}), SemiImplicit<>{}};
  sim.step(1e-4);
  const auto& fluid = sim.particles();
  for (Index i = 0; i < fluid.size(); ++i) {
    const Vec<2> x = fluid[position][i];
    const bool outermost = x.minCoeff() < 0.02 || x.maxCoeff() > 0.22;
    EXPECT_EQ(fluid[mps::surface][i] != 0, outermost) << x.transpose();
  }
}
TEST(ConeSurface, ConsistsOfTheOutermostRowOfABlock) {
  expect_outermost_row_on_surface<WithCones>();
}
TEST(DensitySurface, AtNineTenthsConsistsOfTheOutermostRowOfABlock) {
  expect_outermost_row_on_surface<RecommendedForWallParticles>();
}

// Fluid with a uniform velocity along a channel of wall particles, periodic along x.
mps::Fluid<2> sliding_fluid(double speed) {
  constexpr double l0 = 0.02;
  Box<2> box{.lower = {0, -1}, .upper = {20 * l0, 1}, .periodic = {true, false}};
  mps::Fluid<2> fluid(box);
  for (int y = -5; y < 13; ++y) {
    for (int x = 0; x < 20; ++x) {
      const bool inside = y >= 0 && y < 8;
      const Kind kind = inside ? Kind::fluid : y == -1 || y == 8 ? Kind::wall : Kind::dummy;
      const double along = (x + 0.5 + (inside ? 0.3 : 0)) * l0;
      const Index i = mps::add_particle(fluid, {along, (y + 0.5) * l0}, kind);
      if (inside) fluid[velocity][i] = {speed, 0};
    }
  }
  return fluid;
}

// Maximum deviation from the uniform velocity after 50 steps [m/s].
template <class Scheme>
double disturbance_of_sliding_fluid() {
  Simulation sim{sliding_fluid(1), UniformGrid<2>{},
                 mps::Flow<Scheme>({.spacing = 0.02, .viscosity = 0, .gravity = Vec<2>::Zero()}),
                 SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step(2e-3);
  double max_deviation = 0;
  const auto& fluid = sim.particles();
  for (Index i = 0; i < fluid.size(); ++i) {
    if (fluid[mps::kind][i] != Kind::fluid) continue;
    max_deviation = std::max(max_deviation, (fluid[velocity][i] - Vec<2>(1, 0)).norm());
  }
  return max_deviation;
}

TEST(SmoothWalls, DoNotDisturbSlidingFluidUnlikeGrainyWalls) {
  struct Grainy : RecommendedForWallParticles {
    mps::BothConditions surface{};
    mps::GrainyWalls walls{};
    mps::NoShifting shifting{};
  };
  EXPECT_LT(disturbance_of_sliding_fluid<RecommendedForWallParticles>(), 1e-6);
  EXPECT_GT(disturbance_of_sliding_fluid<Grainy>(), 1e-4);
}

// --- the whole scheme
// -----------------------------------------------------------------------------------

// With P = 0 at a height [m].
template <class Scheme>
void expect_still_tank(double height, double max_speed) {
  const double l0 = 0.02;
  const auto tank = mps::make_tank<Scheme, 2>(
      {.column = {0.3, 0.3}, .size = {.length = 0.3, .height = 0.4}, .spacing = l0});
  Simulation still{tank.particles, UniformGrid<2>{},
                   mps::Flow<Scheme>({.spacing = l0, .speed_scale = 1.7, .walls = tank.walls}),
                   SemiImplicit<>{}};
  for (int k = 0; k < 300; ++k) still.step();
  const auto& water = still.particles();
  for (Index i = 0; i < water.size(); ++i) {
    if (water[mps::kind][i] != Kind::fluid) continue;
    EXPECT_LT(water[velocity][i].norm(), max_speed);
    const double depth = height - water[position][i][1];
    EXPECT_NEAR(water[mps::pressure][i], 9810 * depth, 0.001 * 9810 * 0.3);
  }
}

TEST(RecommendedScheme, KeepsWaterAtRestWithTheHydrostaticPressure) {
  expect_still_tank<mps::Recommended>(0.3, 1e-6);
  // Through the centres of the outermost particles; √(g H) is 1.7 m/s.
  expect_still_tank<RecommendedForWallParticles>(0.3 - 0.02 / 2, 0.004);
}

TEST(RecommendedScheme, HasNoPressureInAFallingBlock) {
  const auto start = blob<2, double>(12, 0.02);
  mps::FlowSettings<2, RecommendedForWallParticles> settings{.spacing = 0.02};
  settings.clip_negative_pressure = false;
  Simulation sim{start, UniformGrid<2>{}, mps::Flow<RecommendedForWallParticles>(settings),
                 SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step(2e-3);
  const auto& fluid = sim.particles();
  for (Index i = 0; i < fluid.size(); ++i) {
    EXPECT_LT(std::abs(fluid[mps::pressure][i]), 1e-6 * 9810 * 0.24);
    EXPECT_NEAR(fluid[velocity][i][1], -9.81 * 0.1, 1e-9);
  }
}

TEST(RecommendedScheme, FollowsATimeDependentBodyForce) {
  mps::FlowSettings<2, RecommendedForWallParticles> settings{.spacing = 0.02,
                                                             .gravity = Vec<2>::Zero()};
  settings.body_force = [](const Vec<2>&, double t) { return Vec<2>(t < 0.05 ? 2.0 : 0.0, 0); };
  Simulation sim{blob<2, double>(8, 0.02), UniformGrid<2>{},
                 mps::Flow<RecommendedForWallParticles>(settings),
                 SemiImplicit<>{}};
  for (int k = 0; k < 50; ++k) sim.step(2e-3);
  for (const auto& u : sim.particles()[velocity]) EXPECT_NEAR(u[0], 0.1, 1e-9);
}

}  // namespace
}  // namespace silt::test::recommended_test
