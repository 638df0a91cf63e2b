// SPDX-License-Identifier: MIT
// Grains on triangle meshes, at rest and rotating.
#include "support/any_wall.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/triangles.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace silt::test::wall_contacts_test {
namespace {

constexpr double g = 9.81;
const dem::CundallStrack elastic{.normal_stiffness = 1e6};
const dem::CundallStrack rough{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.5,
                               .friction_angle = 0.4};

auto simulation(const dem::Grains<3>& grains, const dem::CundallStrack& law,
                const AnyMoving<3>& wall, double gravity = g) {
  return Simulation{grains, NeighbourList<3>{},
                    Forces{Gravity<3>{{0, 0, -gravity}}, dem::Contacts{law, wall}}, Leapfrog{}};
}
template <class Sim>
const auto& contacts_of(const Sim& sim) {
  return sim.interaction().template part<1>();
}

// A pebble in equilibrium on the plane z = 0.
dem::Grains<3> resting_grain(const Vec<3>& v) {
  auto grains = one_grain<3>({0.0123, 0.0217, 0.01}, v);
  grains[position][0][2] -= grains[mass][0] * g / elastic.normal_stiffness;
  return grains;
}

double mass_of(const dem::Grains<3>& grains) {
  double sum = 0;
  for (const double m : grains[mass]) sum += m;
  return sum;
}

dem::MeshWall<> floor_of_triangles() {
  Triangles floor;
  add_patch(floor, 20, [](double u, double v) { return Vec<3>(u, v, 0); });
  return dem::MeshWall(floor);
}

TEST(FloorOfTriangles, DoesNotDisturbASlidingSphere) {
  const Vec<3> v(1.7, 0.9, 0);
  auto sim = simulation(resting_grain(v), elastic, at_rest<3>(floor_of_triangles()));
  const double height = sim.particles()[position][0][2];
  sim.run({.until = 0.4, .time_step = 1e-4});  // across about forty edges
  EXPECT_GT(sim.particles()[position][0][0], 0.6);
  EXPECT_EQ(sim.particles()[velocity][0][0], v[0]);
  EXPECT_EQ(sim.particles()[velocity][0][1], v[1]);
  EXPECT_NEAR(sim.particles()[velocity][0][2], 0, 1e-13);
  EXPECT_NEAR(sim.particles()[position][0][2], height, 1e-17);
}

// The tangential spring is passed on from triangle to triangle.
TEST(FloorOfTriangles, ActsAsAPlaneOnASphereThatSlidesAndRolls) {
  const Vec<3> v(1.7, 0.9, 0);
  auto on_triangles = simulation(resting_grain(v), rough, at_rest<3>(floor_of_triangles()));
  auto on_plane = simulation(resting_grain(v), rough, at_rest<3>(dem::Plane<3>{}));
  for (int k = 0; k < 8000; ++k) {
    on_triangles.step(5e-5);
    on_plane.step(5e-5);
  }
  const auto& a = on_triangles.particles();
  const auto& b = on_plane.particles();
  EXPECT_NEAR((a[velocity][0] - b[velocity][0]).norm(), 0, 1e-13);
  EXPECT_NEAR((a[spin][0] - b[spin][0]).norm(), 0, 1e-11);
  EXPECT_NEAR((a[position][0] - b[position][0]).norm(), 0, 1e-14);
  EXPECT_NEAR(a[velocity][0].head<2>().norm(), v.norm() * 5 / 7, 5e-3) << "it finally rolls";
}

TEST(BoxOfTriangles, ActsAsSixPlanesOnABouncingSphere) {
  const Box<3> box = cube<3, double>(0, 0.1);
  const dem::CundallStrack law{
      .normal_stiffness = 1e6, .tangential_stiffness = 5e5, .friction_angle = 0.2};
  auto grain = one_grain<3>({0.03, 0.05, 0.06}, {3, -2, 1.3});
  grain[spin][0] = {20, 50, -30};
  const AnyMoving<3> walls[] = {at_rest<3>(dem::MeshWall(box_of_triangles(box))),
                                at_rest<3>(dem::BoxWall<3>{.box = box})};
  auto of_triangles = simulation(grain, law, walls[0]);
  auto of_planes = simulation(grain, law, walls[1]);
  const double dt = of_planes.time_step();
  Index steps_at_walls = 0;
  for (int k = 0; k < 40000; ++k) {
    of_triangles.step(dt);
    of_planes.step(dt);
    steps_at_walls += contacts_of(of_planes).size();
    ASSERT_EQ(contacts_of(of_triangles).size(), contacts_of(of_planes).size()) << k;
  }
  EXPECT_GT(steps_at_walls, 300u) << "it bounced";
  const auto& a = of_triangles.particles();
  const auto& b = of_planes.particles();
  EXPECT_NEAR((a[velocity][0] - b[velocity][0]).norm(), 0, 1e-10);
  EXPECT_NEAR((a[position][0] - b[position][0]).norm(), 0, 1e-12);
}

// At an edge and at a corner of a block: one contact that conserves energy.
TEST(BlockOfTriangles, ReflectsASphereWithOneContact) {
  const auto block = at_rest<3>(dem::MeshWall(box_of_triangles(cube<3, double>(-0.1, 0.1), 2)));
  for (const Vec<3>& out : {Vec<3>(1, 0, 1), Vec<3>(1, 1, 1), Vec<3>(1, 0.3, 0.9)}) {
    const Vec<3> n = out.normalized();
    Vec<3> foot;
    for (int k = 0; k < 3; ++k) foot[k] = out[k] != 0 ? 0.1 : 0;
    const Vec<3> v = -2 * n + 0.1 * Vec<3>(0.3, -0.2, 0.4);
    auto sim = simulation(one_grain<3>(foot + 0.0102 * n, v), elastic, block, 0);
    Index touched = 0;
    const double dt = sim.time_step() / 4;
    for (int k = 0; k < 1500; ++k) {
      sim.step(dt);
      ASSERT_LE(contacts_of(sim).size(), 1u);
      touched += contacts_of(sim).size();
    }
    EXPECT_GT(touched, 30u);
    EXPECT_GT(sim.particles()[velocity][0].dot(n), 1.5);
    EXPECT_NEAR(sim.particles()[velocity][0].norm(), v.norm(), 1e-4);
  }
}

// A drum of plane strips with ends and its axis along y.
dem::MeshWall<> drum_of_triangles() {
  Triangles all;
  constexpr double R = 0.1, width = 0.1;
  add_patch(all, 24, [](double u, double v) {
    const double angle = 2 * std::numbers::pi * u;
    return Vec<3>(R * std::cos(angle), width * (v - 0.5), R * std::sin(angle));
  });
  for (const double y : {-width / 2, width / 2}) {
    for (int k = 0; k < 24; ++k) {
      const auto rim = [&](int n) {
        const double angle = 2 * std::numbers::pi * (n % 24) / 24;
        return Vec<3>(R * std::cos(angle), y, R * std::sin(angle));
      };
      all.push_back({{Vec<3>(0, y, 0), rim(k), rim(k + 1)}});
    }
  }
  return dem::MeshWall(all);
}

// In every step the torques of drum and gravity are the change of the grains' angular momentum.
TEST(DrumOfTriangles, LiftsItsGrains) {
  dem::Grains<3> grains = crowd<3, double>(4, 5);
  for (auto& x : grains[position]) x -= Vec<3>(0.041, 0.041, 0.06);
  const dem::Rotation<3> turn{.spin = {0, 20, 0}};
  dem::CundallStrack soft = rough;
  soft.normal_stiffness = 2e4;
  soft.tangential_stiffness = 1e4;
  auto sim = simulation(grains, soft, moving<3>(drum_of_triangles(), turn));
  const double dt = sim.time_step();
  sim.step(dt);  // also shifts the velocities by half a step
  double lifting_moment = 0;
  for (int k = 0; k < 3000; ++k) {
    const auto before = sim.particles();
    sim.step(dt);
    const auto load = contacts_of(sim).load_on(before, 0);
    Vec<3> of_gravity = Vec<3>::Zero();
    for (Index i = 0; i < before.size(); ++i) {
      of_gravity += cross(Vec<3>(before[position][i]), Vec<3>(0, 0, -before[mass][i] * g));
    }
    const Vec<3> turning = angular_momentum(sim.particles(), Vec<3>::Zero()) -
                           angular_momentum(before, Vec<3>::Zero());
    ASSERT_NEAR((turning - (of_gravity - load.torque) * dt).norm(), 0, 1e-15) << k;
    const Vec<3> push = momentum(sim.particles()) - momentum(before);
    const Vec<3> weight(0, 0, -g * mass_of(before));
    ASSERT_NEAR((push - (weight - load.force) * dt).norm(), 0, 1e-14) << k;
    lifting_moment += load.torque[1];
  }
  EXPECT_EQ(sim.particles().size(), grains.size());
  for (Index i = 0; i < grains.size(); ++i) {
    const Vec<3> x = sim.particles()[position][i];
    EXPECT_LT(std::hypot(x[0], x[2]), 0.1) << "none is lost";
    EXPECT_LT(std::abs(x[1]), 0.05);
  }
  EXPECT_LT(lifting_moment, 0) << "the grains slow the drum down";
}

TEST(DrumOfTriangles, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto run = [](int number) {
    return with_threads(number, [] {
      auto grains = crowd<3, double>(11, 6);
      const auto inside = dem::BoxWall<3>{.box = cube<3, double>(0, 11 * 0.0205)};
      auto triangles = box_of_triangles(inside.box, 3);
      const dem::Rotation<3> turn{.about = {0.11, 0.11, 0.11}, .spin = {0.5, 2, 1}};
      auto sim = simulation(grains, rough, moving<3>(dem::MeshWall(triangles), turn));
      for (int k = 0; k < 20; ++k) sim.step(2e-5);
      Bytes bytes = state_of(sim.particles());
      const auto load = contacts_of(sim).load_on(sim.particles(), 0);
      append(bytes, std::span<const double>(load.force.data(), 3));
      append(bytes, std::span<const double>(load.torque.data(), 3));
      EXPECT_GT(load.force.norm(), 0);
      return bytes;
    });
  };
  const Bytes one = run(1);
  for (const int number : {2, 4}) EXPECT_EQ(run(number), one) << number;
}

}  // namespace
}  // namespace silt::test::wall_contacts_test
