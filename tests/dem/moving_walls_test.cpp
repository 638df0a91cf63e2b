// SPDX-License-Identifier: MIT
// Moving walls.
#include "support/any_wall.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace silt::test::moving_walls_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e6};

// The derivative of a pose by central differences.
template <class M, int Dim>
Vec<Dim> velocity_by_hand(const M& motion, double t, const Vec<Dim>& X) {
  constexpr double h = 1e-5;
  return (motion.pose_at(t + h).x_of(X) - motion.pose_at(t - h).x_of(X)) / (2 * h);
}

TEST(WallMotions, HaveTheTimeDerivativeOfTheirPoses) {
  const auto expect_derivative = [](const auto& motion, const auto& X) {
    for (const double t : {0.0, 0.3, 7.1}) {
      const auto x = motion.pose_at(t).x_of(X);
      const auto v = motion.velocity_at(t).at(x);
      EXPECT_NEAR((v - velocity_by_hand(motion, t, X)).norm(), 0, 1e-8 * (1 + v.norm()));
      EXPECT_NEAR((motion.pose_at(t).X_of(x) - X).norm(), 0, 1e-14);
    }
  };
  expect_derivative(dem::Translation<2>{.velocity = {1, -2}}, Vec<2>(0.3, 0.4));
  expect_derivative(dem::Rotation<2>{.about = {1, 2}, .spin = 3}, Vec<2>(0.3, 0.4));
  expect_derivative(dem::Rotation<3>{.about = {1, 2, 3}, .spin = {0.5, -1, 2}},
                    Vec<3>(0.3, 0.4, 1));
  expect_derivative(dem::Rotation<3>{}, Vec<3>(0.3, 0.4, 1));
  expect_derivative(dem::Vibration<3>{.amplitude = {0, 0.1, 0.2}, .frequency = 2, .phase = 0.7},
                    Vec<3>(0.3, 0.4, 1));
  const dem::CombinedMotion screw{dem::Rotation<3>{.about = {1, 2, 3}, .spin = {0.5, -1, 2}},
                                  dem::Translation<3>{.velocity = {0.1, -0.2, 0.4}}};
  expect_derivative(screw, Vec<3>(0.3, 0.4, 1));
  const dem::Vibration<3> shaking{.amplitude = {0, 0.1, 0.2}, .frequency = 2, .phase = 0.7};
  const dem::CombinedMotion nested{
      dem::CombinedMotion{shaking, dem::Rotation<3>{.spin = {0, 1, 2}}},
      dem::Rotation<3>{.about = {1, 0, 0}, .spin = {3, 0, 0}}};
  expect_derivative(nested, Vec<3>(0.3, 0.4, 1));
  EXPECT_EQ(nested.period(), 0.5);
  EXPECT_EQ(screw.period(), std::numeric_limits<double>::infinity());
  expect_derivative(dem::CombinedMotion{dem::Rotation<2>{.about = {1, 2}, .spin = 3},
                                        dem::Rotation<2>{.about = {0, 1}, .spin = -1}},
                    Vec<2>(0.3, 0.4));
}

template <int Dim>
auto simulation(const dem::Grains<Dim>& grains, const dem::CundallStrack& own_law,
                const AnyMoving<Dim>& wall, double g = 0) {
  const Gravity<Dim> gravity{-g * Vec<Dim>::Unit(Dim - 1)};
  return Simulation{grains, NeighbourList<Dim>{},
                    Forces{gravity, dem::Contacts{own_law, wall}.with(without_limits)}, Leapfrog{}};
}
template <class Sim>
const auto& contacts_of(const Sim& sim) {
  return sim.interaction().template part<1>();
}

// A sphere put on a belt slides with the acceleration μ g until it rolls, at 2/7 of the belt's
// speed. The wall itself stays where it is.
TEST(SurfaceVelocity, CarriesAGrainAsABeltDoes) {
  const double R = 0.01, u = 0.5, g = 9.81, mu = 0.3;
  const dem::CundallStrack rough{.normal_stiffness = 1e5,
                                 .tangential_stiffness = 8e4,
                                 .restitution = 0.3,
                                 .friction_angle = std::atan(mu)};
  const dem::Moving belt{dem::Plane<3>{}, dem::SurfaceVelocity<3>{.linear = {u, 0, 0}}};
  const double overlap = 4.0 / 3 * std::numbers::pi * R * R * R * 2500 * g / 1e5;
  Simulation sim{one_grain<3>({0, 0, R - overlap}, {0, 0, 0}, {.radius = R, .density = 2500}),
                 NeighbourList<3>{}, Forces{Gravity<3>{{0, 0, -g}}, dem::Contacts{rough, belt}},
                 Leapfrog{}};
  const double sliding = 2.0 / 7 * u / (mu * g);
  sim.run({.until = 0.5 * sliding});
  EXPECT_NEAR(sim.particles()[velocity][0][0] / (mu * g * sim.time()), 1, 0.01);
  sim.run({.until = 3 * sliding});
  EXPECT_NEAR(sim.particles()[velocity][0][0] / (2.0 / 7 * u), 1, 0.01);
  EXPECT_NEAR(sim.particles()[spin][0][1] * -R / (5.0 / 7 * u), 1, 0.01) << "rolls";
  EXPECT_NEAR(sim.particles()[position][0][2], R - overlap, 0.01 * overlap);
}

// An undamped spring reverses the relative velocity: v' = 2u − v.
TEST(MovingPlane, ReflectsRelativeToItsVelocity) {
  for (const double u : {0.5, -0.4, 2.0}) {
    const dem::Translation<3> motion{.velocity = {0, 0, u}};
    auto sim = simulation<3>(one_grain<3>({0, 0, 0.0101}, {0.3, 0, -1}), law,
                             moving<3>(dem::Plane<3>{}, motion));
    bool touched = false;
    for (int k = 0; k < 5000 && !(touched && contacts_of(sim).size() == 0); ++k) {
      sim.step(sim.time_step() / 4);
      touched |= contacts_of(sim).size() > 0;
    }
    ASSERT_TRUE(touched);
    EXPECT_NEAR(sim.particles()[velocity][0][2], 2 * u + 1, 1e-4 * (1 + u)) << u;
    EXPECT_EQ(sim.particles()[velocity][0][0], 0.3) << "there is no friction";
  }
}

TEST(MovingPlane, ActsAsAPlaneAtRestInItsFrame) {
  const dem::CundallStrack rough{.normal_stiffness = 1e6,
                                 .tangential_stiffness = 5e5,
                                 .restitution = 0.6,
                                 .friction_angle = 0.4};
  const Vec<3> u(0.7, -0.2, 0.5);
  auto grain = one_grain<3>({0, 0, 0.0101}, {0.3, 0.5, -1});
  grain[spin][0] = {10, -20, 30};
  auto still = simulation<3>(grain, rough, at_rest<3>(dem::Plane<3>{}));
  grain[velocity][0] += u;
  auto moved =
      simulation<3>(grain, rough, moving<3>(dem::Plane<3>{}, dem::Translation<3>{.velocity = u}));
  const double dt = still.time_step();
  for (int k = 0; k < 100; ++k) {
    still.step(dt);
    moved.step(dt);
    const Vec<3> v = moved.particles()[velocity][0] - u;
    ASSERT_NEAR((v - still.particles()[velocity][0]).norm(), 0, 1e-11) << k;
    ASSERT_NEAR((moved.particles()[spin][0] - still.particles()[spin][0]).norm(), 0, 1e-8) << k;
  }
  EXPECT_GT(still.particles()[velocity][0][2], 0.5) << "it bounced";
}

// A floor that vibrates far below the frequency of the contact carries a grain along; its load is
// the weight plus the inertial force.
TEST(VibratingFloor, CarriesAGrain) {
  constexpr double g = 9.81, A = 1e-4, f = 10, omega = 2 * std::numbers::pi * f;
  const dem::CundallStrack damped{.normal_stiffness = 1e6, .restitution = 0.2};
  const dem::Vibration<3> vibration{.amplitude = {0, 0, A}, .frequency = f};
  auto grain = one_grain<3>({0, 0, 0.01}, {0, 0, A * omega});
  const double m = grain[mass][0];
  grain[position][0][2] -= m * g / 1e6;
  auto sim = simulation<3>(grain, damped, moving<3>(dem::Plane<3>{}, vibration), g);
  sim.run({.until = 0.2, .time_step = 4 * sim.time_step()});
  for (int k = 0; k < 10; ++k) {
    sim.run({.until = sim.time() + 0.0113, .time_step = 4 * sim.time_step()});
    const auto state = sim.state();
    const auto load = state.interaction.template part<1>().load_on(state.particles, 0, {1, 0, 0});
    const double a = -A * omega * omega * std::sin(omega * sim.time());
    EXPECT_NEAR(load.force[2], -m * (g + a), 1e-3 * m * g) << sim.time();
    EXPECT_NEAR(load.torque[1], load.force[2], 1e-15);
    EXPECT_NEAR(state.particles[velocity][0][2], A * omega * std::cos(omega * sim.time()),
                1e-3 * A * omega);
  }
}

// User-defined motion: smooth start along x.
struct Launch {
  double speed = 0;        // final speed [m/s]
  double duration = 1e-3;  // [s]
  dem::Pose<2, double> pose_at(double t) const {
    return {.shift = {speed * (t - duration * (1 - std::exp(-t / duration))), 0}};
  }
  dem::RigidVelocity<2, double> velocity_at(double t) const {
    return {.linear = {speed * (1 - std::exp(-t / duration)), 0}};
  }
};
static_assert(dem::Wall<dem::Moving<dem::Segment<>, Launch>, 2, double>);
static_assert(!dem::Wall<dem::Moving<dem::Segment<>, Launch>, 2, float>);
static_assert(!dem::Wall<dem::Moving<dem::Plane<3>, Launch>, 3, double>);
static_assert(!dem::Wall<dem::Moving<Launch, Launch>, 2, double>);

// A blade sweeps through many grains: in every step its contacts are those found by direct tests.
TEST(MovingWalls, MissNoContactAtAnySpeed) {
  const dem::Segment<> blade{.from = {0, -0.2}, .to = {0, 0.2}};
  const dem::CundallStrack soft{.normal_stiffness = 1e2};
  for (const double speed : {0.1, 10.0, 300.0}) {
    const dem::Rotation<2> turn{.about = {0.07, 0.07}, .spin = speed};
    for (const auto& wall : {moving<2>(blade, turn), moving<2>(blade, Launch{.speed = speed})}) {
      auto sim = simulation<2>(crowd<2, double>(7, 3), soft, wall);
      Index touches = 0;
      for (int k = 0; k < 150; ++k) {
        const auto pose = wall.motion.pose_at(sim.time());
        const auto before = sim.particles();
        sim.step(1e-4);
        std::vector<Index> expected(before.size(), 0), found(before.size(), 0);
        for (Index i = 0; i < before.size(); ++i) {
          const bool touching = blade.nearest(pose.X_of(before[position][i])).distance < 0.01;
          expected[before.id(i)] = touching;
          touches += touching;
        }
        contacts_of(sim).for_each_wall_contact(
            sim.particles(), [&](const auto& touch) { ++found[sim.particles().id(touch.grain)]; });
        ASSERT_EQ(found, expected) << "at step " << k << " of speed " << speed;
      }
      EXPECT_GT(touches, 20u);
    }
  }
}

TEST(MovingWalls, ThrowForInvalidMotions) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const auto& motion) {
    return dem::Contacts{law, dem::Moving{dem::Plane<3>{}, motion}};
  };
  EXPECT_TRUE(refuses([&] { make(dem::Translation<3>{.velocity = {0, nan, 0}}); },
                      {"Translation: velocity", "nan"}));
  EXPECT_TRUE(refuses([&] { make(dem::Rotation<3>{.spin = {0, nan, 0}}); }, {"Rotation: spin"}));
  EXPECT_TRUE(refuses([&] { make(dem::Vibration<3>{.frequency = -1}); }, {"Vibration: frequency"}));
  EXPECT_TRUE(refuses([&] { make(dem::SurfaceVelocity<3>{.linear = {0, nan, 0}}); },
                      {"SurfaceVelocity: linear", "nan"}));
  EXPECT_TRUE(refuses(
      [&] { make(dem::CombinedMotion{dem::Translation<3>{}, dem::Vibration<3>{.frequency = -1}}); },
      {"Vibration: frequency"}));
  const dem::Grains<3> grains;
  const auto contacts = for_particles(dem::Contacts{law, at_rest<3>(dem::Plane<3>{})}, grains);
  EXPECT_TRUE(refuses([&] { contacts.load_on(grains, 1); }, {"no wall 1"}));
}

}  // namespace
}  // namespace silt::test::moving_walls_test
