// SPDX-License-Identifier: MIT
// Conservation of momentum and angular momentum in contacts, and of energy in elastic ones.
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace silt::test::conservation_test {
namespace {

const dem::CundallStrack lossy{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.6,
                               .friction_angle = 0.5,
                               .cohesion = 0.1};

double size_of(double spin) { return std::abs(spin); }
double size_of(const Vec<3>& spin) { return spin.norm(); }

template <class S>
class AllGrains : public ::testing::Test {};
using Searches = AllOrUsual<::testing::Types<UniformGrid<2>, NeighbourList<2>, BruteForce<2>,
                                             UniformGrid<3>, NeighbourList<3>, BruteForce<3>>,
                            ::testing::Types<NeighbourList<2>, UniformGrid<3>>>;
TYPED_TEST_SUITE(AllGrains, Searches);

TYPED_TEST(AllGrains, ConserveMomentumAndAngularMomentumToRoundOff) {
  constexpr int dim = TypeParam::Vec::RowsAtCompileTime;
  Simulation sim{crowd<dim, double>(dim == 2 ? 8 : 4, 3), TypeParam{}, dem::Contacts{lossy},
                 Leapfrog{}};
  const Vec<dim> p = momentum(sim.particles());
  const auto before = angular_momentum(sim.particles(), Vec<dim>::Zero());
  const double energy = energy_of_motion(sim.particles());
  double scale = 0;
  for (const auto& x : sim.particles()[position]) {
    scale += sim.particles()[mass][0] * x.norm();  // at a speed of 1 m/s
  }
  sim.run({.until = 0.02});
  EXPECT_LT(energy_of_motion(sim.particles()), 0.8 * energy) << "they collided";
  EXPECT_LT((momentum(sim.particles()) - p).norm(), 1e-12 * scale / 0.02);
  // The half step between v and x changes x × v by v × v Δt/2 = 0: it causes no error.
  const auto after = angular_momentum(sim.particles(), Vec<dim>::Zero());
  EXPECT_LT(size_of(typename dem::Grains<dim>::AngularVec(after - before)), 1e-12 * scale);
}

TEST(LeverArm, ToTheContactPointConservesAngularMomentumUnlikeTheRadius) {
  const auto change = [](dem::LeverArm arm) {
    Simulation sim{crowd<2, double>(8, 3), UniformGrid<2>{},
                   dem::Contacts{lossy}.with({.lever_arm = arm}), Leapfrog{}};
    const double before = angular_momentum(sim.particles(), Vec<2>::Zero());
    sim.run({.until = 0.02});
    return std::abs(angular_momentum(sim.particles(), Vec<2>::Zero()) - before);
  };
  EXPECT_GT(change(dem::LeverArm::radius), 1e6 * change(dem::LeverArm::contact_point));
}

TEST(AllGrainsPeriodic, ConserveMomentumAcrossTheSides) {
  auto grains = crowd<2, double>(8, 4);
  auto box = cube<2, double>(0, 8 * 0.0205);
  box.periodic.fill(true);
  grains.set_box(box);
  Simulation sim{grains, NeighbourList<2>{}, dem::Contacts{lossy}, Leapfrog{}};
  const Vec<2> p = momentum(sim.particles());
  sim.run({.until = 0.05});
  EXPECT_LT((momentum(sim.particles()) - p).norm(), 1e-12);
}

TEST(TwoGrains, CollideAcrossAPeriodicSideAsInOpenSpace) {
  const auto leave = [](bool periodic) {
    dem::Grains<2> grains;
    auto box = cube<2, double>(0, 1);
    box.periodic[0] = periodic;
    grains.set_box(box);
    // Across x = 0 ≡ 1, or in the middle.
    const double middle = periodic ? 1.0 : 0.5;
    dem::add_grain(grains, {middle - 0.0105, 0.5}, pebble);
    dem::add_grain(grains, {periodic ? 0.0105 : 0.5105, 0.505}, pebble);
    grains[velocity][0] = {1, 0.25};
    grains[velocity][1] = {-1, 0};
    Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{lossy}, Leapfrog{}};
    through_contact(sim, sim.time_step());
    return sim.snapshot();
  };
  const auto through_side = leave(true);
  const auto in_open = leave(false);
  for (Index i = 0; i < 2; ++i) {
    EXPECT_NEAR((through_side[velocity][i] - in_open[velocity][i]).norm(), 0, 1e-9);
    EXPECT_NEAR(through_side[spin][i], in_open[spin][i], 1e-6);
    EXPECT_GT(std::abs(through_side[spin][i]), 1);
  }
}

TEST(TwoGrains, OfUnequalMassHaveTheVelocitiesOfAnElasticImpactOfPointMasses) {
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0}, {.radius = 0.02, .density = 2500});
  dem::add_grain(grains, {0.0301, 0, 0}, {.radius = 0.01, .density = 2500});
  grains[velocity][1] = {-9, 0, 0};
  Simulation sim{grains, UniformGrid<3>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e6}}, Leapfrog{}};
  through_contact(sim, sim.time_step() / 4);
  EXPECT_NEAR(sim.particles()[velocity][0][0], -2, 1e-3) << "2 m1/(m0 + m1) times the speed";
  EXPECT_NEAR(sim.particles()[velocity][1][0], 7, 1e-3);
}

TEST(TwoGrains, ConserveEnergyDuringAnElasticContact) {
  Simulation sim{two_grains<2>(1e-5, Vec<2>(-1, 0.3)), UniformGrid<2>{},
                 dem::Contacts{dem::CundallStrack{
                     .normal_stiffness = 1e6, .tangential_stiffness = 3e5, .friction_angle = 1.5}},
                 Leapfrog{}};
  const double before = energy_of_motion(sim.particles());
  double max_stored = 0;
  for (int k = 0; k < 400; ++k) {
    sim.step(sim.time_step() / 5);
    // Contacts of the last step belong to its beginning; use the simulation of a snapshot instead.
    auto at_step = sim;
    auto grains = sim.snapshot();
    at_step.step(1e-12);
    const double stored = at_step.interaction().elastic_energy(at_step.particles());
    max_stored = std::max(max_stored, stored);
    ASSERT_NEAR(energy_of_motion(grains) + stored, before, 2e-3 * before) << k;
  }
  EXPECT_GT(max_stored, 0.4 * before);
}

TEST(Grains, HaveTheMassAndInertiaOfTheirShape) {
  dem::Grains<2> flat;
  dem::add_grain(flat, {0, 0}, {.radius = 2, .density = 3});
  dem::add_grain(flat, {9, 0}, {.radius = 2, .density = 3, .shape = dem::Shape::sphere});
  dem::Grains<3> round;
  dem::add_grain(round, {0, 0, 0}, {.radius = 2, .density = 3});
  EXPECT_NEAR(flat[mass][0], 37.699111843, 1e-8) << "a disc of unit thickness";
  EXPECT_NEAR(flat[inertia][0], 75.398223686, 1e-8);
  EXPECT_NEAR(flat[mass][1], 100.53096491, 1e-7) << "a sphere in 2D";
  EXPECT_NEAR(flat[inertia][1], 160.84954386, 1e-7);
  EXPECT_EQ(round[mass][0], flat[mass][1]);
  EXPECT_EQ(round[inertia][0], flat[inertia][1]);
}

}  // namespace
}  // namespace silt::test::conservation_test
