// SPDX-License-Identifier: MIT
// Walls that move as they are told.
#include "support/check.hpp"
#include "support/grains.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace silt::test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e6};

// The derivative of a pose by central differences.
template <class M, int Dim>
Vec<Dim> velocity_by_hand(const M& motion, double t, const Vec<Dim>& X) {
  constexpr double h = 1e-5;
  return (motion.pose_at(t + h).x_of(X) - motion.pose_at(t - h).x_of(X)) / (2 * h);
}

TEST(WallMotions, HaveTheVelocityOfTheirPoses) {
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
  expect_derivative(dem::Rotation<3>{.about = {1, 2, 3}, .spin = {0.5, -1, 2}}, Vec<3>(0.3, 0.4, 1));
  expect_derivative(dem::Rotation<3>{}, Vec<3>(0.3, 0.4, 1));
  expect_derivative(dem::Vibration<3>{.amplitude = {0, 0.1, 0.2}, .frequency = 2, .phase = 0.7},
                    Vec<3>(0.3, 0.4, 1));
}

// An undamped spring hands back the relative velocity: v' = 2u − v.
TEST(MovingPlane, ReflectsAboutItsOwnVelocity) {
  for (const double u : {0.5, -0.4, 2.0}) {
    const dem::Moving wall{dem::Plane<2>{}, dem::Translation<2>{.velocity = {0, u}}};
    Simulation sim{one_grain<2>({0, 0.0101}, {0.3, -1}), UniformGrid<2>{},
                   dem::Contacts{law, wall}, Leapfrog{}};
    through_contact(sim, sim.time_step() / 4);
    EXPECT_NEAR(sim.particles()[velocity][0][1], 2 * u + 1, 1e-3 * (1 + u)) << u;
    EXPECT_EQ(sim.particles()[velocity][0][0], 0.3) << "it has no friction";
  }
}

TEST(MovingPlane, IsWhatAPlaneAtRestIsToOneWhoMovesWithIt) {
  const dem::CundallStrack rough{.normal_stiffness = 1e6, .tangential_stiffness = 5e5,
                                 .restitution = 0.6, .friction_angle = 0.4};
  const Vec<3> u(0.7, -0.2, 0.5);
  auto grain = one_grain<3>({0, 0, 0.0101}, {0.3, 0.5, -1});
  grain[spin][0] = {10, -20, 30};
  Simulation at_rest{grain, UniformGrid<3>{}, dem::Contacts{rough, dem::Plane<3>{}}, Leapfrog{}};
  grain[velocity][0] += u;
  const dem::Moving wall{dem::Plane<3>{}, dem::Translation<3>{.velocity = u}};
  Simulation moved{grain, UniformGrid<3>{}, dem::Contacts{rough, wall}, Leapfrog{}};
  const double dt = at_rest.time_step();
  for (int k = 0; k < 100; ++k) {
    at_rest.step(dt);
    moved.step(dt);
    const Vec<3> v = moved.particles()[velocity][0] - u;
    ASSERT_NEAR((v - at_rest.particles()[velocity][0]).norm(), 0, 1e-11) << k;
    ASSERT_NEAR((moved.particles()[spin][0] - at_rest.particles()[spin][0]).norm(), 0, 1e-8) << k;
  }
  EXPECT_GT(at_rest.particles()[velocity][0][2], 0.5) << "it has bounced";
}

// A spring on a floor that vibrates far below its own frequency carries a grain along; what the floor
// bears is the weight and the force that the acceleration takes.
TEST(VibratingFloor, CarriesAGrain) {
  constexpr double g = 9.81, A = 1e-4, f = 10, omega = 2 * std::numbers::pi * f;
  const dem::CundallStrack damped{.normal_stiffness = 1e6, .restitution = 0.2};
  const dem::Moving floor{dem::Plane<3>{}, dem::Vibration<3>{.amplitude = {0, 0, A}, .frequency = f}};
  auto grain = one_grain<3>({0, 0, 0.01}, {0, 0, A * omega});
  const double m = grain[mass][0];
  grain[position][0][2] -= m * g / 1e6;
  Simulation sim{grain, UniformGrid<3>{},
                 Forces{Gravity<3>{{0, 0, -g}}, dem::Contacts{damped, floor}}, Leapfrog{}};
  sim.run({.until = 0.2, .time_step = 4 * sim.time_step()});
  for (int k = 0; k < 10; ++k) {
    sim.run({.until = sim.time() + 0.0113, .time_step = 4 * sim.time_step()});
    const auto state = sim.state();
    const auto load = state.interaction.template part<1>().load_on(state.particles, 0, {1, 0, 0});
    const double a = -A * omega * omega * std::sin(omega * sim.time());
    EXPECT_NEAR(load.force[2], -m * (g + a), 1e-3 * m * g) << sim.time();
    EXPECT_NEAR(load.moment[1], load.force[2], 1e-15);
    EXPECT_NEAR(state.particles[velocity][0][2], A * omega * std::cos(omega * sim.time()),
                1e-3 * A * omega);
  }
}

// What a user may write: a wall that starts softly.
struct Launch {
  double speed = 0;  // [m/s], in the end
  dem::Pose<2, double> pose_at(double t) const { return {.shift = {0, speed * (t - 1 + std::exp(-t))}}; }
  dem::RigidVelocity<2, double> velocity_at(double t) const {
    return {.linear = {0, speed * (1 - std::exp(-t))}};
  }
};
static_assert(dem::Wall<dem::Moving<dem::Segment<>, Launch>, 2, double>);
static_assert(!dem::Wall<dem::Moving<dem::Segment<>, Launch>, 2, float>);
static_assert(!dem::Wall<dem::Moving<dem::Plane<3>, Launch>, 3, double>);
static_assert(!dem::Wall<dem::Moving<Launch, Launch>, 2, double>);

// Blades that sweep through a crowd miss nothing: contacts at every step as found by hand.
TEST(MovingWalls, MissNoContactHoweverFastTheyAre) {
  for (const double speed : {0.1, 10.0, 300.0}) {
    const dem::Segment<> blade{.from = {0, -0.2}, .to = {0, 0.2}};
    const dem::Moving paddle{blade, dem::Rotation<2>{.about = {0.07, 0.07}, .spin = speed}};
    const dem::Moving lift{dem::Segment<>{.from = {-1, 0.05}, .to = {1, 0.05}}, Launch{.speed = speed}};
    const dem::CundallStrack soft{.normal_stiffness = 1e2};
    Simulation sim{crowd<2, double>(7, 3), NeighbourList<2>{}, dem::Contacts{soft, paddle, lift},
                   Leapfrog{}};
    Index touches = 0;
    for (int k = 0; k < 200; ++k) {
      const double time = sim.time();
      const auto before = sim.particles();
      sim.step(1e-4);
      std::vector<Index> by_hand(2 * before.size(), 0), found(2 * before.size(), 0);
      const auto note = [&](const auto& wall, Index number) {
        const auto pose = wall.motion.pose_at(time);
        for (Index i = 0; i < before.size(); ++i) {
          const bool touching = wall.wall.nearest(pose.X_of(before[position][i])).distance < 0.01;
          by_hand[2 * before.id(i) + number] = touching;
          touches += touching;
        }
      };
      note(paddle, 0);
      note(lift, 1);
      sim.interaction().for_each_wall_contact(sim.particles(), [&](const auto& touch) {
        ++found[2 * sim.particles().id(touch.grain) + touch.wall];
      });
      ASSERT_EQ(found, by_hand) << "at step " << k << " of speed " << speed;
    }
    EXPECT_GT(touches, 100u);
  }
}

TEST(MovingWalls, RefuseWhatIsNone) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const auto make = [](const auto& motion) {
    return dem::Contacts{law, dem::Moving{dem::Plane<3>{}, motion}};
  };
  EXPECT_TRUE(refuses([&] { make(dem::Translation<3>{.velocity = {0, nan, 0}}); },
                      {"Translation: velocity", "nan"}));
  EXPECT_TRUE(refuses([&] { make(dem::Rotation<3>{.spin = {0, nan, 0}}); }, {"Rotation: spin"}));
  EXPECT_TRUE(refuses([&] { make(dem::Vibration<3>{.frequency = -1}); }, {"Vibration: frequency"}));
  const dem::Contacts contacts{law, dem::Plane<3>{}};
  EXPECT_TRUE(refuses([&] { contacts.load_on(dem::Grains<3>{}, 1); }, {"no wall 1"}));
}

}  // namespace
}  // namespace silt::test
