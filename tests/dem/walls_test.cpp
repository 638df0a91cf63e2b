// SPDX-License-Identifier: MIT
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace silt::test::walls_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e6};

TEST(Plane, IsIndependentOfTheLengthOfItsNormal) {
  const auto leave = [](double length) {
    const dem::Plane<2> wall{.point = {3, 1}, .normal = length * Vec<2>(0.6, 0.8)};
    const Vec<2> x = wall.point + 0.0101 * Vec<2>(0.6, 0.8) + 5 * Vec<2>(0.8, -0.6);
    Simulation sim{one_grain<2>(x, {0, -1}), UniformGrid<2>{}, dem::Contacts{law, wall},
                   Leapfrog{}};
    through_contact(sim, sim.time_step());
    return Vec<2>(sim.particles()[velocity][0]);
  };
  // Reflection of (0, −1) about the plane.
  for (const double length : {1.0, 1e-9, 17.0, 1e9}) {
    EXPECT_NEAR((leave(length) - Vec<2>(0.96, 0.28)).norm(), 0, 1e-3) << length;
  }
}

TEST(Plane, IsSolidBehind) {
  const dem::Plane<3> floor{.point = {0, 0, 1}, .normal = {0, 0, 2}};
  Simulation sim{one_grain<3>({7, 8, 0.5}, {0, 0, 0}), UniformGrid<3>{},
                 dem::Contacts{law, floor}.with(without_limits), Leapfrog{}};
  sim.step(1e-6);
  EXPECT_GT(sim.particles()[velocity][0][2], 0) << "a grain deep inside is also pushed out";
}

TEST(Plane, IsRefusedIfItBreaksOffAtAPeriodicSide) {
  auto grains = one_grain<2>({0.5, 0.1}, {0, 0});
  Box<2> box{.lower = {0, 0}, .upper = {1, 1}};
  box.periodic[0] = true;
  grains.set_box(box);
  const auto step_above = [&](const Vec<2>& normal) {
    Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law, dem::Plane<2>{.normal = normal}},
                   Leapfrog{}};
    sim.step(1e-6);
  };
  EXPECT_NO_THROW(step_above({0, 1}));
  const dem::Plane<2> far{.point = {-1, 0}, .normal = {1, 0}};
  Simulation beside{grains, UniformGrid<2>{}, dem::Contacts{law, far}, Leapfrog{}};
  EXPECT_NO_THROW(beside.step(1e-6));
  EXPECT_TRUE(refuses([&] { step_above({0.1, 1}); }, {"Plane: the normal", "axis 0", "periodic"}));
}

TEST(Segment, IsTwoSided) {
  const dem::Segment<> wall{.from = {-1, 0}, .to = {1, 0}};
  for (const double side : {1.0, -1.0}) {
    Simulation sim{one_grain<2>({0.3, side * 0.0101}, {0.5, -side}), UniformGrid<2>{},
                   dem::Contacts{law, wall}, Leapfrog{}};
    through_contact(sim, sim.time_step());
    EXPECT_NEAR(sim.particles()[velocity][0][1], side, 1e-3);
    EXPECT_NEAR(sim.particles()[velocity][0][0], 0.5, 1e-12);
  }
}

TEST(Segment, HasRoundEnds) {
  const dem::Segment<> wall{.from = {-1, 0}, .to = {1, 0}};
  // Head on against the end, along the segment.
  Simulation along{one_grain<2>({1.0101, 0}, {-1, 0}), UniformGrid<2>{}, dem::Contacts{law, wall},
                   Leapfrog{}};
  through_contact(along, along.time_step());
  EXPECT_NEAR(along.particles()[velocity][0][0], 1, 1e-3);
  // Past the end, without contact.
  Simulation past{one_grain<2>({1.0101, 0.05}, {0, -1}), UniformGrid<2>{}, dem::Contacts{law, wall},
                  Leapfrog{}};
  past.run({.until = 0.1, .time_step = 1e-4});
  EXPECT_EQ(past.particles()[velocity][0][1], -1);
  // At 45 degrees to the end: reflected in the opposite direction.
  const Vec<2> out = Vec<2>(1, 1).normalized();
  Simulation corner{
      one_grain<2>(Vec<2>(-1, 0) + 0.0101 * Vec<2>(-out[0], out[1]), {out[0], -out[1]}),
      UniformGrid<2>{}, dem::Contacts{law, wall}, Leapfrog{}};
  through_contact(corner, corner.time_step());
  EXPECT_NEAR((corner.particles()[velocity][0] - Vec<2>(-out[0], out[1])).norm(), 0, 1e-3);
}

TEST(Segment, PushesACentreOnItToTheLeft) {
  const dem::Segment<> wall{.from = {0, 0}, .to = {0, 2}};
  Simulation sim{one_grain<2>({0, 1}, {0, 0}), UniformGrid<2>{},
                 dem::Contacts{law, wall}.with(without_limits), Leapfrog{}};
  sim.step(1e-6);
  EXPECT_LT(sim.particles()[velocity][0][0], 0);
}

TEST(Walls, UseTheirOwnMaterials) {
  const dem::CundallStrack bouncy{.normal_stiffness = 1e6};
  const dem::CundallStrack dull{.normal_stiffness = 1e6, .restitution = 0.5};
  const dem::Plane<2> floor{.normal = {0, 1}};
  const dem::Plane<2> side{.normal = {1, 0}, .material = 1};
  auto grains = one_grain<2>({0.0101, 1}, {-1, 0});
  dem::add_grain(grains, {1, 0.0101}, pebble);
  grains[velocity][1] = {0, -1};
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{dem::Materials{bouncy, dull}, floor, side},
                 Leapfrog{}};
  sim.run({.until = 0.02, .time_step = sim.time_step() / 2});
  EXPECT_NEAR(sim.particles()[velocity][0][0], 0.5, 2e-3);
  EXPECT_NEAR(sim.particles()[velocity][1][1], 1.0, 2e-3);
}

TEST(Walls, HaveSeparateTangentialSprings) {
  // In a corner both walls act on a grain by friction, each with its own history.
  dem::CundallStrack rough{
      .normal_stiffness = 1e6, .tangential_stiffness = 5e5, .friction_angle = 1};
  const dem::Plane<2> floor{.normal = {0, 1}};
  const dem::Plane<2> side{.normal = {1, 0}};
  auto grains = one_grain<2>({0.0099, 0.0099}, {0, 0});
  grains[spin][0] = 1;
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{rough, floor, side}, Leapfrog{}};
  sim.step(1e-6);
  sim.step(1e-6);  // at time 0 the springs are unwound
  ASSERT_EQ(sim.interaction().size(), 2u);
  const auto& history = sim.interaction().history(sim.particles());
  ASSERT_NE(history.find(0, wall_id(0)), nullptr);
  ASSERT_NE(history.find(0, wall_id(1)), nullptr);
  const auto& on_floor = history.find(0, wall_id(0))->tangential_force;
  const auto& on_side = history.find(0, wall_id(1))->tangential_force;
  EXPECT_LT(on_floor[0], 0) << "a counter-clockwise spin drags the floor forward";
  EXPECT_EQ(on_floor[1], 0);
  EXPECT_GT(on_side[1], 0);
  EXPECT_EQ(on_side[0], 0);
}

// A mesh so large that only its number of elements is made.
struct HugeMesh {
  Index count = 0;
  std::uint32_t material = 0;

  void check() const {}
  Index element_count() const { return count; }
  dem::NearestPoint<3, double> nearest(Index, const Vec<3>&) const { return {}; }
  template <class F>
  void for_each_element_near(const Vec<3>&, double, F&&) const {}
};

TEST(Walls, AreRefusedIfTheyHaveMoreElementsThanAListOfContactsCanNumber) {
  const dem::Plane<3> floor{.normal = {0, 0, 1}};
  const Index most = Index(1) << 28;
  EXPECT_NO_THROW((dem::Contacts{law, floor, HugeMesh{most - 1}}));
  EXPECT_TRUE(refuses([&] { dem::Contacts{law, floor, HugeMesh{most}}; },
                      {"268435457 elements", "coarser meshes"}));
}

}  // namespace
}  // namespace silt::test::walls_test
