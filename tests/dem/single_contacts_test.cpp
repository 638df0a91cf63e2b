// SPDX-License-Identifier: MIT
// Contacts of the last step, computed again for observers.
#include <silt/dem/contact/contacts.hpp>
#include <silt/dem/wall/moving.hpp>
#include <silt/dem/wall/plane.hpp>
#include <silt/search/brute_force.hpp>

#include "support/check.hpp"
#include <gtest/gtest.h>

namespace silt::test::single_contacts_test {
namespace {

// Laws whose force is their input.
struct ForceIsVelocity {
  template <int Dim, class Real>
  Vec<Dim, Real> force(const dem::Contact<Dim, Real>& contact) const {
    return contact.relative_velocity;
  }
};

struct ForceIsSpin {
  template <int Dim, class Real>
  dem::LoadComponents<Dim, Real> components(const dem::Contact<Dim, Real>& contact) const {
    dem::LoadComponents<Dim, Real> load;
    load.tangential_spring = contact.relative_spin;
    return load;
  }
};

// Two spinning grains of different sizes with a large overlap; the first touches the floor.
dem::Grains<3> spinning_grains() {
  dem::Grains<3> grains;
  dem::add_grain(grains, {0, 0, 0.19}, {.radius = 0.2, .density = 1});
  dem::add_grain(grains, {0.15, 0.07, 0.39}, {.radius = 0.1, .density = 1});
  grains[velocity][0] = {0.1, -0.2, 0.3};
  grains[velocity][1] = {-0.4, 0.5, 0.6};
  grains[spin][0] = {7, -8, 9};
  grains[spin][1] = {11, 5, -13};
  return grains;
}

// The contacts of these grains, and of the first with a floor that moves, in a step with this law.
template <class Law>
auto contacts_of(dem::Grains<3>& grains, const Law& law) {
  BruteForce<3> search({.radius = 0.4});
  search.update(grains);
  auto contacts = for_particles(
      dem::Contacts{law, dem::Moving{dem::Plane<3>{.normal = {0, 0, 1}},
                                     dem::Rotation<3>{.about = {0.3, 0, 0}, .spin = {0.5, 0, 2}}}},
      grains);
  contacts.accelerate(grains, search, 1e-3);
  return contacts;
}

TEST(SingleContacts, HaveTheVelocitiesThatTheLawSaw) {
  dem::Grains<3> grains = spinning_grains();
  const auto contacts = contacts_of(grains, ForceIsVelocity{});
  int of_grains = 0;
  int of_walls = 0;
  contacts.for_each_evaluated_contact(grains, [&](const auto& each) {
    EXPECT_EQ(each.answer, each.contact.relative_velocity);
    EXPECT_NE(each.contact.relative_velocity, Vec<3>::Zero());
  });
  contacts.for_each_contact(grains, [&](Index, Index j, const auto& contact, const Vec<3>& force) {
    EXPECT_EQ(contact.relative_velocity, force) << "bitwise";
    ++(j == no_index ? of_walls : of_grains);
  });
  EXPECT_EQ(of_grains, 1);
  EXPECT_EQ(of_walls, 1);
}

TEST(SingleContacts, HaveTheSpinsThatTheLawSaw) {
  dem::Grains<3> grains = spinning_grains();
  int number = 0;
  contacts_of(grains, ForceIsSpin{})
      .for_each_contact(grains, [&](Index, Index, const auto& contact, const Vec<3>& force) {
        EXPECT_EQ(contact.relative_spin, force) << "bitwise";
        EXPECT_NE(contact.relative_spin, Vec<3>::Zero());
        ++number;
      });
  EXPECT_EQ(number, 2);
}

TEST(SingleContacts, OfGrainsThatRollOnOneAnotherHaveNoVelocity) {
  // Equal lever arms: opposite spins move both surfaces alike.
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 0.1, .density = 1});
  dem::add_grain(grains, {0.16, 0}, {.radius = 0.1, .density = 1});
  grains[spin][0] = 4;
  grains[spin][1] = -4;
  BruteForce<2> search({.radius = 0.2});
  search.update(grains);
  auto contacts = for_particles(dem::Contacts{ForceIsVelocity{}}, grains);
  contacts.accelerate(grains, search, 1e-3);
  int number = 0;
  contacts.for_each_contact(grains, [&](Index, Index, const auto& contact, const Vec<2>&) {
    EXPECT_EQ(contact.relative_velocity, Vec<2>::Zero());
    ++number;
  });
  EXPECT_EQ(number, 1);
}

}  // namespace
}  // namespace silt::test::single_contacts_test
