// SPDX-License-Identifier: MIT
// Continuous fields: the balances of mass and momentum at single points, which no other measurement
// has, whatever the width; integrals over the grid; and the exact stress of simple states.
#include <silt/dem/measure/coarse_grained.hpp>
#include <silt/dem/measure/stress.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::test::coarse_grained_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 8e4,
                             .restitution = 0.6,
                             .friction_angle = 0.4};

// A heap that falls on a floor and against a wall.
template <int Dim>
auto heap() {
  auto grains = crowd<Dim, double>(4, 7);
  const Gravity<Dim> gravity{-9.81 * Vec<Dim>::Unit(Dim - 1)};
  const dem::Plane<Dim> floor{.normal = Vec<Dim>::Unit(Dim - 1)};
  Simulation sim{grains, NeighbourList<Dim>{}, Forces{gravity, dem::Contacts{law, floor}},
                 Leapfrog{}};
  for (int k = 0; k < 400; ++k) sim.step(2e-5);
  return sim.state();
}

template <int Dim>
Box<Dim, double> around(const dem::Grains<Dim>& grains, double margin) {
  Box<Dim, double> box;
  box.lower = box.upper = grains[position][0];
  for (const auto& x : grains[position]) {
    box.lower = box.lower.cwiseMin(x);
    box.upper = box.upper.cwiseMax(x);
  }
  box.lower.array() -= margin;
  box.upper.array() += margin;
  return box;
}

template <int Dim>
void expect_balance_at_every_point() {
  const auto state = heap<Dim>();
  const auto& grains = state.particles;
  const auto& contacts = state.interaction.template part<1>();
  const Vec<Dim> g = -9.81 * Vec<Dim>::Unit(Dim - 1);
  for (const double width : {1.5 * pebble.radius, 6 * pebble.radius}) {
    const dem::CoarseGrid<Dim> grid{
        .region = around<Dim>(grains, 0), .spacing = 2 * pebble.radius, .width = width};
    const auto fields = dem::coarse_grained(grains, contacts, grid);
    double most = 0;
    Index loaded = 0;
    for (Index p = 0; p < fields.size(); ++p) {
      // From the accelerations of the grains.
      const Vec<Dim> r = fields.position_of(p);
      Vec<Dim> rate = Vec<Dim>::Zero();
      const double c = width;
      const double top =
          Dim == 2 ? 4 / (std::numbers::pi * c * c) : 315 / (64 * std::numbers::pi * c * c * c);
      for (Index i = 0; i < grains.size(); ++i) {
        const Vec<Dim> d = r - grains[position][i];
        const double left = std::max(0.0, 1 - d.squaredNorm() / (c * c));
        const Vec<Dim> slope = -6 * top * left * left / (c * c) * d;
        const double m = grains[mass][i];
        const Vec<Dim> v = grains[velocity][i];
        rate += grains[force][i] * top * left * left * left - m * v * v.dot(slope);
      }
      const Vec<Dim> balance = -fields.momentum_flux_divergence(p) -
                               fields.contact_stress_divergence(p) - fields.wall_force(p) +
                               fields.density(p) * g;
      const double scale = rate.norm() + fields.contact_stress_divergence(p).norm() +
                           fields.momentum_flux_divergence(p).norm();
      if (scale > 0) most = std::max(most, (balance - rate).norm() / scale);
      loaded += fields.contact_stress(p).norm() > 0;
    }
    EXPECT_LT(most, 1e-10) << width;
    EXPECT_GT(loaded, 5u);
  }
}

TEST(CoarseGrained, BalancesMomentumAtEveryPoint) {
  expect_balance_at_every_point<2>();
  expect_balance_at_every_point<3>();
}

// The divergences are those of the fields: by central differences on a grid so fine that their
// error is small.
TEST(CoarseGrained, HasTheDivergencesOfItsFields) {
  const auto state = heap<2>();
  const auto& contacts = state.interaction.part<1>();
  const double h = 0.002 * pebble.radius;
  const Vec<2> middle = around<2>(state.particles, 0).upper / 3;
  Box<2> region{.lower = middle.array() - h, .upper = middle.array() + h};
  const auto f = dem::coarse_grained(state.particles, contacts,
                                     {.region = region, .spacing = h, .width = 4 * pebble.radius});
  ASSERT_EQ(f.size(), 9u);
  const auto difference = [&](auto&& field) {
    return Vec<2>((field(5).col(0) - field(3).col(0) + field(7).col(1) - field(1).col(1)) /
                  (2 * h));
  };
  const Vec<2> of_contact = difference([&](Index p) { return f.contact_stress(p); });
  EXPECT_NEAR((of_contact - f.contact_stress_divergence(4)).norm() / of_contact.norm(), 0, 1e-4);
  const Vec<2> of_flux = difference([&](Index p) {
    return Eigen::Matrix2d(f.kinetic_stress(p) + f.momentum(p) * f.velocity(p).transpose());
  });
  EXPECT_NEAR((of_flux - f.momentum_flux_divergence(4)).norm() / of_flux.norm(), 0, 1e-4);
  const double of_momentum =
      (f.momentum(5) - f.momentum(3))[0] + (f.momentum(7) - f.momentum(1))[1];
  EXPECT_NEAR(-of_momentum / (2 * h) / f.density_rate(4), 1, 1e-4);
}

TEST(CoarseGrained, HasTheMassAndTheMeanStressOfTheGrains) {
  const auto state = heap<2>();
  const auto& contacts = state.interaction.part<1>();
  const double width = 4 * pebble.radius;
  const auto region = around<2>(state.particles, 1.5 * width);
  const auto f = dem::coarse_grained(state.particles, contacts,
                                     {.region = region, .spacing = width / 10, .width = width});
  double mass_of_all = 0;
  Eigen::Matrix2d contact = Eigen::Matrix2d::Zero();
  const Vec<2> cell = region.length().array() /
                      Vec<2>(double(f.counts()[0]) - 1, double(f.counts()[1]) - 1).array();
  for (Index p = 0; p < f.size(); ++p) {
    mass_of_all += f.density(p) * cell.prod();
    contact += f.contact_stress(p) * cell.prod();
  }
  double expected = 0;
  for (const double m : state.particles[mass]) expected += m;
  EXPECT_NEAR(mass_of_all / expected, 1, 1e-6);
  const auto mean = dem::stress(state.particles, contacts, region);
  EXPECT_NEAR((contact / region.length().prod() - mean.contact).norm() / mean.contact.norm(), 0,
              1e-6);
}

// Also across its sides.
TEST(CoarseGrained, OfAPeriodicLatticeIsTheSameEverywhere) {
  const double s = 1.99 * pebble.radius;
  auto box = cube<3, double>(0, 4 * s);
  box.periodic = {true, true, true};
  dem::Grains<3> grains(box);
  for (const auto& x : lattice<3>({{0, 0, 0}, Vec<3>::Constant(4 * s)}, s)) {
    dem::add_grain(grains, x, pebble);
  }
  Simulation sim{grains, UniformGrid<3>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
  sim.step(1e-9);
  const auto state = sim.state();
  const Box<3> all{.lower = Vec<3>::Zero(), .upper = Vec<3>::Constant(4 * s)};
  const auto f = dem::coarse_grained(state.particles, state.interaction,
                                     {.region = all, .spacing = s, .width = 1.9 * s});
  const double force = 1e5 * 0.01 * pebble.radius;
  for (Index p = 1; p < f.size(); ++p) {
    EXPECT_NEAR(f.density(p) / f.density(0), 1, 1e-12);
    EXPECT_NEAR((f.contact_stress(p) - f.contact_stress(0)).norm(), 0, 1e-9 * force / (s * s));
  }
  EXPECT_NEAR(f.contact_stress(0)(0, 0) / (force / (s * s)), 1, 0.1);
}

TEST(CoarseGrained, RefusesGridsThatCannotBe) {
  const auto make = [](const Box<2>& region, double spacing, double width) {
    return [=] { dem::CoarseGrained<2>({.region = region, .spacing = spacing, .width = width}); };
  };
  const Box<2> unit{.lower = {0, 0}, .upper = {1, 1}};
  EXPECT_TRUE(refuses(make(unit, 0, 1), {"CoarseGrid: spacing = 0"}));
  EXPECT_TRUE(refuses(make(unit, 1, -1), {"CoarseGrid: width = -1"}));
  EXPECT_TRUE(refuses(make(unit, 1e-6, 1), {"more than 1e8"}));
  EXPECT_TRUE(refuses(make(Box<2>{}, 1, 1), {"CoarseGrid: lower side"}));
}

}  // namespace
}  // namespace silt::test::coarse_grained_test
