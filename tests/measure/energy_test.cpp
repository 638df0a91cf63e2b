// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/timed.hpp>

#include <gtest/gtest.h>

#include <utility>

namespace silt::test::energy_test {
namespace {

TEST(Energy, OfARollingDiscIsOneAndAHalfTimesThatOfASlidingOne) {
  dem::Grains<2> disc;
  dem::add_grain(disc, {0, 0.5}, {.radius = 0.5, .density = 100});
  disc[velocity][0] = {3, 0};
  disc[spin][0] = -6;
  EXPECT_NEAR(rotational_energy(disc) / kinetic_energy(disc), 0.5, 1e-14);
  EXPECT_NEAR(momentum(disc)[0], 3 * disc[mass][0], 1e-12);
}

TEST(AngularMomentum, IsTheSumOfOrbitAndSpin) {
  dem::Grains<3> balls;
  dem::add_grain(balls, {1, 0, 0}, {.radius = 0.5, .density = 100});
  dem::add_grain(balls, {0, 2, 0}, {.radius = 0.5, .density = 100});
  const double m = balls[mass][0];
  balls[velocity][0] = {0, 0, 3};
  balls[spin][1] = {7, 0, 0};
  const Vec<3> about_origin = angular_momentum(balls, {0, 0, 0});
  EXPECT_NEAR((about_origin - m * Vec<3>(0.1 * 7, -3, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((angular_momentum(balls, {1, 5, 0}) - m * Vec<3>(0.7 - 15, 0, 0)).norm(), 0, 1e-12);

  dem::Grains<2> disc;
  dem::add_grain(disc, {1, 2}, {.radius = 0.5, .density = 100});
  disc[velocity][0] = {0, 3};
  disc[spin][0] = 8;
  EXPECT_NEAR(angular_momentum(disc, {0, 0}), disc[mass][0] * (3 + 1), 1e-12);
}

TEST(Energy, OfAThrownBallIsConserved) {
  dem::Grains<3> ball;
  dem::add_grain(ball, {0, 0, 0}, {.radius = 0.5, .density = 100});
  ball[velocity][0] = {1, 2, 3};
  const Vec<3> g{0.5, 0, -9.81};
  Simulation flight{ball, UniformGrid<3>{}, Gravity<3>{g}, Leapfrog{}};
  const auto energy = [&] {
    const auto now = flight.snapshot();
    return kinetic_energy(now) + potential_energy(now, g);
  };
  const double before = energy();
  flight.run({.until = 1, .time_step = 0.01});
  EXPECT_NEAR(energy() / before, 1, 1e-4);
}

TEST(Timed, SearchAndInteractionAreUnchangedAndMeasureTheirTime) {
  const auto heap = [] {
    return dem::make_grains(lattice<2>({{0, 0}, {0.3, 0.3}}, 0.0199),
                            {.radius = 0.01, .density = 1});
  };
  const dem::CundallStrack law{.normal_stiffness = 1e3};
  Simulation plain{heap(), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  Simulation timed{heap(), TimedSearch{UniformGrid<2>{}}, TimedInteraction{dem::Contacts{law}},
                   Leapfrog{}};
  for (int k = 0; k < 20; ++k) {
    plain.step();
    timed.step();
  }
  EXPECT_GT(timed.search().seconds(), 0);
  EXPECT_GT(timed.interaction().seconds(), 0);
  for (Index i = 0; i < plain.particles().size(); ++i) {
    EXPECT_EQ(plain.particles()[position][i], timed.particles()[position][i]);
  }
}

}  // namespace
}  // namespace silt::test::energy_test
