// SPDX-License-Identifier: MIT
// Sources, free surfaces and collisions individually, and the policies of the cases of Table 1.
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/view.hpp"

#include <gtest/gtest.h>

#include <concepts>
#include <type_traits>

namespace silt::test::policies_test {
namespace {

using mps::BothSurfaces;
using mps::Collision;
using mps::CountSurface;
using mps::DensitySource;
using mps::DensitySurface;
using mps::DivergenceSource;

// --- concepts ------------------------------------------------------------------------------------

static_assert(mps::PressureSource<DensitySource> && mps::PressureSource<DivergenceSource>);
static_assert(mps::FreeSurface<DensitySurface> && mps::FreeSurface<CountSurface>);
static_assert(mps::FreeSurface<BothSurfaces<CountSurface, NoSurface>>);
static_assert(mps::FreeSurface<NoSurface>);
static_assert(mps::CollisionModel<Collision>);

struct SourceWithoutOrder {
  void check() const {}
  double value(const auto&) const { return 0; }
};
static_assert(!mps::PressureSource<SourceWithoutOrder>);
static_assert(!mps::PressureSource<DensitySurface>);

struct SurfaceThatReturnsDouble {
  void check() const {}
  double is_on_surface(const mps::LocalDensity&) const { return 1; }
};
struct UncheckedSurface {
  bool is_on_surface(const mps::LocalDensity&) const { return true; }
};
static_assert(!mps::FreeSurface<SurfaceThatReturnsDouble> && !mps::FreeSurface<UncheckedSurface>);
static_assert(!mps::FreeSurface<DensitySource>);

struct CollisionWithoutReach {
  void check() const {}
  template <int Dim, class Real>
  Vec<Dim, Real> velocity_change(const mps::CollidingPair<Dim, Real>& pair) const {
    return pair.r_ij;
  }
};
static_assert(!mps::CollisionModel<CollisionWithoutReach>);
static_assert(!mps::CollisionModel<DensitySource>);

static_assert(mps::WallModel<mps::GrainyWalls> && mps::WallModel<mps::SmoothWalls>);
static_assert(!mps::WallModel<DensitySource>);
static_assert(mps::Shifting<mps::NoShifting> && mps::Shifting<mps::ParticleShifting>);
static_assert(!mps::Shifting<DensitySource>);
static_assert(mps::LaplacianWeights<mps::HigherOrderLaplacian>);
static_assert(!mps::LaplacianWeights<DensitySource>);

// --- schemes -------------------------------------------------------------------------------------

struct Derived : mps::Recommended {
  Collision collision{.distance = 0.8, .restitution = 0.3};
  mps::CorrectedGradient gradient{.min_determinant = 0.2};
};

TEST(Schemes, GiveTheirNumbersToTheSettingsWhichMayReplaceThem) {
  const mps::FlowSettings<2, Derived> settings{.spacing = 0.01};
  EXPECT_EQ(settings.collision.distance, 0.8);
  EXPECT_EQ(settings.collision.restitution, 0.3);
  EXPECT_EQ(settings.gradient.min_determinant, 0.2);
  EXPECT_EQ(settings.surface.criterion.first.beta, 0.9);  // inherited
  const mps::Flow<Derived> flow{{.spacing = 0.01, .collision = {.distance = 0.7}}};
  EXPECT_EQ(flow.settings().collision.distance, 0.7);
}

// --- Table 1 -------------------------------------------------------------------------------------

template <class Case, class Source, class Kernel, class Surface, class Gradient>
constexpr bool has_policies = std::same_as<mps::SourceOf<Case>, Source> &&
                            std::same_as<mps::KernelOf<Case>, Kernel> &&
                            std::same_as<mps::SurfaceOf<Case>, Surface> &&
                            std::same_as<mps::GradientOf<Case>, Gradient>;

template <class Case>
constexpr bool collides_with(double a, double b) {
  const Collision collision = Case{}.collision;
  return collision.distance == a && collision.restitution == b;
}

using Both = BothSurfaces<DensitySurface, CountSurface>;
using Inverse = mps::InverseKernel;
using Gaussian = mps::GaussianKernel;
using Cubic = mps::CubicKernel;
using By4 = mps::MinimumGradient;
using By18 = mps::ConservingGradient;

static_assert(has_policies<mps::Case00, DensitySource, Inverse, DensitySurface, By4>);
static_assert(has_policies<mps::Case01, DivergenceSource, Inverse, DensitySurface, By4>);
static_assert(has_policies<mps::Case02, DivergenceSource, Gaussian, DensitySurface, By4>);
static_assert(has_policies<mps::Case03, DivergenceSource, Cubic, DensitySurface, By4>);
static_assert(has_policies<mps::Case04, DivergenceSource, Cubic, DensitySurface, By4>);
static_assert(has_policies<mps::Case05, DivergenceSource, Cubic, DensitySurface, By4>);
static_assert(has_policies<mps::Case06, DivergenceSource, Cubic, DensitySurface, By4>);
static_assert(has_policies<mps::Case07, DivergenceSource, Cubic, DensitySurface, By4>);
static_assert(has_policies<mps::Case08, DivergenceSource, Cubic, CountSurface, By4>);
static_assert(has_policies<mps::Case09, DivergenceSource, Cubic, Both, By4>);
static_assert(has_policies<mps::Case10, DivergenceSource, Cubic, Both, By18>);

static_assert(collides_with<mps::Case00>(0.5, 0.2) && collides_with<mps::Case01>(0.5, 0.2));
static_assert(collides_with<mps::Case02>(0.5, 0.2) && collides_with<mps::Case03>(0.5, 0.2));
static_assert(collides_with<mps::Case04>(0.8, 0.2) && collides_with<mps::Case05>(1.0, 0.2));
static_assert(collides_with<mps::Case06>(1.0, 0.0) && collides_with<mps::Case07>(1.0, 0.4));
static_assert(collides_with<mps::Case08>(1.0, 0.2) && collides_with<mps::Case09>(1.0, 0.2));
static_assert(collides_with<mps::Case10>(1.0, 0.2));

// --- sources -------------------------------------------------------------------------------------

TEST(DensitySource, GivesCompressedFluidANegativeSource) {
  // The Laplacian of a maximum is negative: a higher pressure.
  EXPECT_LT(DensitySource{}.value(ViewOf{{.compression = 0.01}}), 0);
  EXPECT_GT(DensitySource{}.value(ViewOf{{.compression = -0.01}}), 0);
  EXPECT_DOUBLE_EQ(DensitySource{}.value(ViewOf{{.compression = 0.01}}),
                   -1e7);
}

TEST(DivergenceSource, GivesConvergingFluidANegativeSource) {
  const DivergenceSource source;
  EXPECT_LT(source.value(ViewOf{{.divergence = -1}}), 0);
  EXPECT_GT(source.value(ViewOf{{.divergence = 1}}), 0);
  EXPECT_EQ(source.value(ViewOf{}), 0);
}

TEST(DivergenceSource, CorrectsTheFractionGammaOfTheDensityError) {
  const ViewOf compressed{{.density = 998, .time_step = 2e-3, .compression = 0.03}};
  EXPECT_DOUBLE_EQ(DivergenceSource{}.value(compressed), 0.01 * DensitySource{}.value(compressed));
  EXPECT_DOUBLE_EQ(DivergenceSource{.gamma = 1}.value(compressed),
                   DensitySource{}.value(compressed));
  EXPECT_EQ(DivergenceSource{.gamma = 0}.value(compressed), 0);
}

// --- surfaces ------------------------------------------------------------------------------------

TEST(Surfaces, AreBelowTheirThresholdOnly) {
  EXPECT_TRUE(DensitySurface{}.is_on_surface(mps::LocalDensity{.density = 0.96, .neighbours = 2}));
  EXPECT_FALSE(DensitySurface{}.is_on_surface(mps::LocalDensity{.density = 0.97, .neighbours = 0}));
  EXPECT_TRUE(CountSurface{}.is_on_surface(mps::LocalDensity{.density = 2, .neighbours = 0.84}));
  EXPECT_FALSE(CountSurface{}.is_on_surface(mps::LocalDensity{.density = 0, .neighbours = 0.85}));
}

TEST(BothSurfaces, NeedBothConditions) {
  const Both both;
  EXPECT_TRUE(both.is_on_surface(mps::LocalDensity{.density = 0.9, .neighbours = 0.8}));
  EXPECT_FALSE(both.is_on_surface(mps::LocalDensity{.density = 0.9, .neighbours = 0.9}));
  EXPECT_FALSE(both.is_on_surface(mps::LocalDensity{.density = 1.0, .neighbours = 0.8}));
  EXPECT_FALSE(both.is_on_surface(mps::LocalDensity{.density = 1.0, .neighbours = 0.9}));
}

// --- collisions ----------------------------------------------------------------------------------

template <class S>
class Collisions : public ::testing::Test {};
TYPED_TEST_SUITE(Collisions, Spaces);

// Applies the collision stage of case 10 with the given parameters.
template <class P>
void collide(P& fluid, double restitution, double distance = 1, double l0 = 0.1) {
  mps::Flow<mps::Case10, P::dimension, typename P::Real> flow(
      {.spacing = l0, .collision = {.distance = distance, .restitution = restitution}});
  UniformGrid<P::dimension, typename P::Real> search;
  search.set_radius(flow.reach(fluid));
  search.update(fluid);
  flow.collide(fluid, search, 1e-3);
}

// Two particles at a distance of 0.08 along an oblique line, with the given velocities.
template <class S>
typename S::Fluid pair(const typename S::Vec& u0, const typename S::Vec& u1) {
  using Real = typename S::Real;
  using Vec = typename S::Vec;
  Vec apart = Vec::Constant(1);
  apart[0] = 2;
  apart *= Real(0.08) / apart.norm();
  auto fluid = fluid_at<S::dimension, Real>({Vec(Vec::Zero()), apart});
  fluid[velocity][0] = u0;
  fluid[velocity][1] = u1;
  return fluid;
}

TYPED_TEST(Collisions, SeparateApproachingPairsWithTheRestitution) {
  using Vec = typename TypeParam::Vec;
  using Real = typename TypeParam::Real;
  for (const double b : {0.0, 0.2, 1.0}) {
    auto fluid = pair<TypeParam>(Vec(Vec::Unit(0)), Vec(Vec::Unit(1) * Real(0.3)));
    const Vec n = (fluid[position][1] - fluid[position][0]).normalized();
    const Vec before = fluid[velocity][1] - fluid[velocity][0];
    const Vec sum_before = fluid[velocity][1] + fluid[velocity][0];
    ASSERT_LT(before.dot(n), 0);
    collide(fluid, b);
    const Vec after = fluid[velocity][1] - fluid[velocity][0];
    EXPECT_NEAR(after.dot(n), -Real(b) * before.dot(n), TypeParam::rounding);
    EXPECT_LE(((after - n * n.dot(after)) - (before - n * n.dot(before))).norm(),
              TypeParam::rounding) << "the perpendicular component is unchanged";
    EXPECT_LE((fluid[velocity][1] + fluid[velocity][0] - sum_before).norm(), TypeParam::rounding);
  }
}

TYPED_TEST(Collisions, DoNotChangeRecedingAndDistantPairs) {
  using Vec = typename TypeParam::Vec;
  auto receding = pair<TypeParam>(Vec(Vec::Constant(-1)), Vec(Vec::Unit(1)));
  const auto before = state_of(receding);
  collide(receding, 0.2);
  EXPECT_TRUE(state_of(receding) == before);

  auto distant = pair<TypeParam>(Vec(Vec::Unit(0)), Vec(Vec::Zero()));
  const auto before_distant = state_of(distant);
  collide(distant, 0.2, 0.79);  // the distance is 0.8 spacings
  EXPECT_TRUE(state_of(distant) == before_distant);
  collide(distant, 0.2, 0.81);
  EXPECT_FALSE(state_of(distant) == before_distant);
}

TYPED_TEST(Collisions, AreDisabledByZeroDistance) {
  using Vec = typename TypeParam::Vec;
  auto fluid = pair<TypeParam>(Vec(100 * Vec::Unit(0)), Vec(-100 * Vec::Unit(0)));
  const auto before = state_of(fluid);
  collide(fluid, 1, 0);
  EXPECT_TRUE(state_of(fluid) == before);
}

TYPED_TEST(Collisions, WithAWallAreThoseWithAnInfiniteMass) {
  using Vec = typename TypeParam::Vec;
  using Real = typename TypeParam::Real;
  for (const auto of_kind : {mps::Kind::wall, mps::Kind::dummy}) {
    auto fluid = pair<TypeParam>(Vec(Vec::Unit(0)), Vec(Vec::Zero()));
    fluid[mps::kind][1] = of_kind;
    const Vec n = (fluid[position][1] - fluid[position][0]).normalized();
    const Real before = fluid[velocity][0].dot(n);
    collide(fluid, 0.2);
    EXPECT_NEAR(fluid[velocity][0].dot(n), -Real(0.2) * before, TypeParam::rounding);
    EXPECT_EQ(fluid[velocity][1], Vec::Zero());
  }
}

TYPED_TEST(Collisions, ConserveMomentum) {
  using Real = typename TypeParam::Real;
  auto fluid = blob<TypeParam::dimension, Real>(6, Real(0.1), Real(0.3));
  give_random_velocities(fluid, Real(2), 7);
  const auto before = velocity_sum(fluid);
  const auto state = state_of(fluid);
  collide(fluid, 0.2);
  EXPECT_FALSE(state_of(fluid) == state);
  EXPECT_LE((velocity_sum(fluid) - before).norm(), double(TypeParam::rounding) * speed_sum(fluid));
}

TYPED_TEST(Collisions, ConserveMomentumAcrossPeriodicBoundaries) {
  using Real = typename TypeParam::Real;
  auto fluid = full_box<TypeParam::dimension, Real>(7, Real(0.1), Real(0.3));
  give_random_velocities(fluid, Real(2), 8);
  const auto before = velocity_sum(fluid);
  collide(fluid, 0.2);
  EXPECT_LE((velocity_sum(fluid) - before).norm(), double(TypeParam::rounding) * speed_sum(fluid));
}

// --- bad input -----------------------------------------------------------------------------------

TEST(Policies, RejectParametersOutOfRange) {
  EXPECT_TRUE(refuses([] { DensitySurface{.beta = 1.2}.check(); }, {"DensitySurface: beta = 1.2"}));
  EXPECT_TRUE(refuses([] { DensitySurface{.beta = nan}.check(); }, {"DensitySurface: beta = nan"}));
  EXPECT_TRUE(refuses([] { CountSurface{.beta = -0.1}.check(); }, {"CountSurface: beta = -0.1"}));
  EXPECT_TRUE(refuses([] { (Both{.second = {.beta = 7}}).check(); }, {"CountSurface: beta = 7"}));
  EXPECT_TRUE(refuses([] { (Both{.first = {.beta = 7}}).check(); }, {"DensitySurface: beta = 7"}));
  EXPECT_TRUE(
      refuses([] { DivergenceSource{.gamma = 2}.check(); }, {"DivergenceSource: gamma = 2 "}));
  EXPECT_TRUE(
      refuses([] { DivergenceSource{.gamma = nan}.check(); }, {"DivergenceSource: gamma = nan"}));
  EXPECT_TRUE(
      refuses([] { Collision{.distance = -1}.check(); }, {"Collision: distance = -1"}));
  EXPECT_TRUE(
      refuses([] { Collision{.distance = inf}.check(); }, {"Collision: distance = inf"}));
  EXPECT_TRUE(refuses([] { Collision{.restitution = 1.5}.check(); },
                      {"Collision: restitution = 1.5"}));
}

}  // namespace
}  // namespace silt::test::policies_test
