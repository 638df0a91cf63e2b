// SPDX-License-Identifier: MIT
#include <silt/dem/measure/coordination.hpp>
#include <silt/dem/measure/stress.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace silt::test::stress_test {
namespace {

constexpr double k = 1e6;
constexpr double R = pebble.radius;
const dem::CundallStrack spring{.normal_stiffness = k};

// With contacts evaluated in a very short step.
template <class P, class Contacts>
auto state_of(const P& grains, const Contacts& contacts) {
  Simulation sim{grains, UniformGrid<P::dimension>{}, contacts, Leapfrog{}};
  sim.step(1e-9);
  return sim.state();
}
const dem::Plane<2> floor_at_0;

// A column of discs with the overlaps of static equilibrium.
TEST(Stress, OfAColumnAtRestIsTheWeightAbovePerWidth) {
  constexpr int n = 6;
  constexpr double g = 9.81;
  const double m = one_grain<2>({0, 0}, {0, 0})[mass][0];
  dem::Grains<2> grains;
  double top = 0;
  for (int i = 0; i < n; ++i) {
    top += (i == 0 ? R : 2 * R) - (n - i) * m * g / k;
    dem::add_grain(grains, {0, top}, pebble);
  }
  const auto state = state_of(grains, dem::Contacts{spring, floor_at_0});
  const auto x = state.particles[position];
  const double width = 0.05;
  for (Index i = 0; i + 1 < n; ++i) {
    const Box<2> between{.lower = {-width / 2, x[i][1]}, .upper = {width / 2, x[i + 1][1]}};
    const auto sigma = dem::stress(state.particles, state.interaction, between);
    const double above = double(n - 1 - i) * m * g;
    EXPECT_NEAR(sigma.contact(1, 1), above / width, 1e-6 * above / width);
    EXPECT_NEAR(sigma.contact(0, 0), 0, 1e-12 * above);
    EXPECT_NEAR(sigma.kinetic.norm(), 0, 1e-6);
    EXPECT_NEAR(sigma.pressure(), above / width / 2, 1e-6 * above);
  }
  const Box<2> at_floor{.lower = {-width / 2, 0}, .upper = {width / 2, R / 2}};
  const auto floor = dem::stress(state.particles, state.interaction, at_floor);
  EXPECT_NEAR(floor.contact(1, 1), n * m * g / width, 1e-6 * n * m * g / width);
}

// A compressed simple cubic lattice: F/s² in every direction and in every region of whole cells,
// wherever its edges are, also across the periodic sides.
TEST(Stress, OfACompressedLatticeIsTheForcePerCellFace) {
  constexpr double s = 1.99 * R;
  auto box = cube<3, double>(0, 4 * s);
  box.periodic.fill(true);
  auto grains = dem::make_grains(lattice(box, s), pebble);
  ASSERT_EQ(grains.size(), 64u);
  grains.set_box(box);
  const auto state = state_of(grains, dem::Contacts{spring});
  const double expected = k * (2 * R - s) / (s * s);
  for (const double at : {0.0, 0.3 * s, 1.5 * s}) {
    const auto region = cube<3, double>(at, at + 2 * s);
    const auto sigma = dem::stress(state.particles, state.interaction, region);
    const Eigen::Matrix3d all = expected * Eigen::Matrix3d::Identity();
    EXPECT_LT((sigma.contact - all).norm(), 1e-6 * expected) << at;
  }
  const auto whole = dem::stress(state.particles, state.interaction, box);
  EXPECT_NEAR(whole.pressure(), expected, 1e-6 * expected);
  const auto number = dem::coordination(state.particles, state.interaction);
  EXPECT_EQ(number.mean, 6);
  EXPECT_EQ(number.mechanical, 6);
  EXPECT_EQ(number.rattlers, 0);
}

TEST(Stress, OfAFlowingGasIsThatOfItsFluctuations) {
  auto grains = crowd<3, double>(4, 7);
  for (auto& x : grains[position]) x *= 2;
  for (auto& v : grains[velocity]) v += Vec<3>(20, 0, 0);
  const auto region = cube<3, double>(-1, 1);
  const auto state = state_of(grains, dem::Contacts{spring});
  const auto sigma = dem::stress(state.particles, state.interaction, region);
  Vec<3> mean = Vec<3>::Zero();
  for (const auto& v : grains[velocity]) mean += v / double(grains.size());
  double square = 0;
  for (const auto& v : grains[velocity]) square += (v - mean).squaredNorm();
  EXPECT_NEAR(sigma.pressure(), grains[mass][0] * square / 3 / 8, 1e-9) << "n m <v'²>/3";
  EXPECT_EQ(sigma.contact.norm(), 0);
}

TEST(Stress, OfASlidingContactHasAShearComponent) {
  // Both have the same spin, so their surfaces slide: a force along y at a distance along x.
  auto grains = two_grains<2>(-1e-4, Vec<2>(0, 0));
  grains[spin][0] = 1;
  grains[spin][1] = 1;
  const dem::CundallStrack rough{
      .normal_stiffness = k, .tangential_stiffness = k, .friction_angle = 1};
  const auto state = state_of(grains, dem::Contacts{rough, dem::Plane<2>{.point = {0, -1}}});
  Vec<2> force = Vec<2>::Zero();
  state.interaction.for_each_contact(
      state.particles, [&](Index, Index, const auto&, const Vec<2>& f) { force = f; });
  ASSERT_GT(std::abs(force[1]), 1e-6);
  const auto sigma =
      dem::stress(state.particles, state.interaction, cube<2, double>(-0.5, 0.5)).contact;
  const double l = -(2 * R - 1e-4);
  EXPECT_NEAR(sigma(0, 0), force[0] * l, 1e-9 * std::abs(force[0]));
  EXPECT_NEAR(sigma(1, 0), force[1] * l, 1e-9 * std::abs(force[0]));
  EXPECT_NEAR(sigma(0, 1), 0, 1e-9 * std::abs(force[0]));
}

TEST(Stress, ThrowsForARegionWithoutVolume) {
  const auto state = state_of(dem::Grains<2>{}, dem::Contacts{spring, floor_at_0});
  EXPECT_TRUE(refuses([&] { dem::stress(state.particles, state.interaction, Box<2>{}); },
                      {"dem::stress", "not a finite number"}));
  EXPECT_TRUE(refuses(
      [&] { dem::stress(state.particles, state.interaction, cube<2, double>(1, 1)); }, {"Box"}));
}

TEST(Coordination, ExcludesGrainsWithoutLoad) {
  // Three in a row on a floor, the last of which touches only its neighbour, and a distant one.
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, R - 1e-5}, pebble);
  dem::add_grain(grains, {2 * R - 1e-5, R - 1e-5}, pebble);
  dem::add_grain(grains, {4 * R - 2e-5, R + 1e-5}, pebble);
  dem::add_grain(grains, {1, 1}, pebble);
  const auto state = state_of(grains, dem::Contacts{spring, floor_at_0});
  const auto number = dem::coordination(state.particles, state.interaction);
  EXPECT_EQ(number.mean, (2 + 3 + 1) / 4.0);
  EXPECT_EQ(number.mechanical, (2 + 3) / 2.0);
  EXPECT_EQ(number.rattlers, 0.5);
}

TEST(Stress, ThrowsForARegionWithoutEnd) {
  const auto grains = two_grains<2>(0.01, {0, 0});
  const auto contacts =
      for_particles(dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, grains);
  const Box<2> region{.lower = {0, 0}, .upper = {1, std::numeric_limits<double>::infinity()}};
  EXPECT_TRUE(refuses([&] { dem::stress(grains, contacts, region); },
                      {"dem::stress: upper side of the region"}));
}

}  // namespace
}  // namespace silt::test::stress_test
