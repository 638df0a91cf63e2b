// SPDX-License-Identifier: MIT
// Contacts with walls, evaluated eight at a time, against the same evaluated one at a time.
// tests/CMakeLists.txt compiles this file with full optimisation, at which g++ 12 loses lanes of
// registers that are filled one by one.
#include <silt/dem/contact/contacts.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/search/brute_force.hpp>

#include <Eigen/Geometry>

#include <gtest/gtest.h>

namespace silt::test::lanes_at_walls_test {
namespace {

constexpr double dt = 1e-5;
const dem::CundallStrack law{.normal_stiffness = 1e5,
                             .tangential_stiffness = 5e4,
                             .restitution = 0.6,
                             .friction_angle = 0.4};

// Three groups of eight, the last one incomplete. All grains are different.
dem::Grains<3> bed() {
  dem::Grains<3> grains;
  for (int k = 0; k < 20; ++k) {
    const double radius = 0.5 - 0.001 * k;
    const Index i = dem::add_grain(grains, {1.1 * (k % 5), 1.1 * (k / 5), 0.99 * radius},
                                   {.radius = radius, .density = 1000});
    grains[velocity][i] = {0.1 * k, 1, -0.2 * k};
    grains[spin][i] = {1.0 * k, -1, 0.3};
  }
  return grains;
}

// `motion` moves the floor, the plane z = 0.
template <class Wall>
void expect_what_the_law_gives(const Wall& floor, const dem::RigidVelocity<3, double>& motion) {
  auto grains = bed();
  BruteForce<3> search({.radius = 1});
  search.update(grains);
  auto contacts = for_particles(dem::Contacts{law, floor}, grains);
  contacts.accelerate(grains, search, dt);
  ASSERT_EQ(contacts.size(), grains.size());
  for (Index i = 0; i < grains.size(); ++i) {
    const double R = grains[radius][i];
    dem::Contact<3, double> contact;
    contact.normal = Vec<3>::Unit(2);
    contact.overlap = 0.01 * R;
    const Vec<3> arm = (contact.overlap - R) * contact.normal;
    contact.relative_velocity =
        grains[velocity][i] + cross(grains[spin][i], arm) - motion.at(grains[position][i] + arm);
    contact.effective_mass = grains[mass][i];
    contact.effective_radius = R;
    contact.time_step = dt;
    decltype(law)::History<3, double> history;
    const Vec<3> force = law.components(contact, history).force(contact.normal);
    EXPECT_LT((grains[silt::force][i] - force).norm(), 1e-12 * force.norm()) << i;
    EXPECT_LT((grains[torque][i] - arm.cross(force)).norm(), 1e-12 * R * force.norm()) << i;
  }
}

TEST(LanesAtWalls, GiveTheForcesOfTheLawOnAFloorAtRest) {
  expect_what_the_law_gives(dem::Plane<3>{}, {});
}

TEST(LanesAtWalls, GiveTheForcesOfTheLawOnARotatingTable) {
  const dem::Rotation<3> turning{.about = {1, 2, 0}, .spin = {0, 0, 5}};
  expect_what_the_law_gives(dem::Moving{dem::Plane<3>{}, turning}, turning.velocity_at(0));
}

}  // namespace
}  // namespace silt::test::lanes_at_walls_test
