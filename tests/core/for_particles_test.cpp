// SPDX-License-Identifier: MIT
// A simulation stores interactions in types that depend on the type of its particles.
#include "support/check.hpp"

#include <silt/dem.hpp>
#include <silt/measure/timed.hpp>

#include <gtest/gtest.h>

#include <concepts>

namespace silt::test::for_particles_test {
namespace {

using Grains = dem::Grains<2>;
using Contacts = dem::Contacts<dem::CundallStrack, dem::Plane<2>>;
using ContactsOfGrains = dem::ContactsOf<Grains, dem::CundallStrack, dem::Plane<2>>;

static_assert(std::same_as<ForParticles<Contacts, Grains>, ContactsOfGrains>);
static_assert(std::same_as<ForParticles<ContactsOfGrains, Grains>, ContactsOfGrains>);
static_assert(std::same_as<ForParticles<Gravity<2>, Grains>, Gravity<2>>);
static_assert(std::same_as<ForParticles<Forces<Gravity<2>, Contacts>, Grains>,
                           Forces<Gravity<2>, ContactsOfGrains>>);
static_assert(std::same_as<ForParticles<TimedInteraction<Contacts>, Grains>,
                           TimedInteraction<ContactsOfGrains>>);
// Contacts of other particles, or of another dimension, do not exist.
static_assert(std::same_as<ForParticles<Contacts, Particles<2, double>>, Contacts>);
static_assert(std::same_as<ForParticles<Contacts, dem::Grains<3>>, Contacts>);

const dem::CundallStrack law{.normal_stiffness = 1e5, .restitution = 0.5};
Forces<Gravity<2>, Contacts> forces(double g) {
  return Forces{Gravity<2>{{0, -g}}, dem::Contacts{law, dem::Plane<2>{}}};
}
auto grain_on_a_floor() {
  Grains grains;
  dem::add_grain(grains, {0, 0.0499}, {.radius = 0.05, .density = 2500});
  return Simulation{grains, UniformGrid<2>{}, forces(9.81), Leapfrog{}};
}

TEST(ForParticles, PartsAreFoundByTheTypeGivenAndByThatOfTheirParticles) {
  auto sim = grain_on_a_floor();
  sim.step();
  EXPECT_EQ(sim.interaction().part<Contacts>().size(), 1u);
  EXPECT_EQ(&sim.interaction().part<Contacts>(), &sim.interaction().part<ContactsOfGrains>());
  EXPECT_EQ(&sim.interaction().part<Contacts>(), &sim.interaction().part<1>());
}

TEST(ForParticles, AnInteractionOfTheSameTypesReplacesThatOfASimulation) {
  auto sim = grain_on_a_floor();
  auto other = grain_on_a_floor();
  sim.interaction() = forces(-9.81);
  sim.step();
  other.step();
  EXPECT_GT(sim.particles()[velocity][0][1], other.particles()[velocity][0][1]);
}

TEST(ForParticles, InteractionsAddForcesWithoutASimulation) {
  auto sim = grain_on_a_floor();
  auto grains = sim.particles();
  auto interaction = for_particles(forces(9.81), grains);
  UniformGrid<2> search{{.radius = interaction.reach(grains)}};
  search.update(grains);
  clear(grains);
  interaction.accelerate(grains, search, interaction.time_step(grains));
  EXPECT_NEAR(grains[force][0][1], 1e5 * 1e-4 - 9.81 * grains[mass][0], 1e-9);
}

TEST(ForParticles, ASimulationOfTheStateOfAnotherHasTheSameType) {
  auto sim = grain_on_a_floor();
  for (int k = 0; k < 5; ++k) sim.step(1e-5);
  const auto [grains, interaction] = sim.state();
  Simulation next{grains, UniformGrid<2>{}, interaction, Leapfrog{}};
  next.step(1e-5);
  EXPECT_EQ(next.interaction().part<Contacts>().size(), 1u);
  sim = next;
  EXPECT_EQ(sim.interaction().part<Contacts>().size(), 1u);
}

TEST(ForParticles, ContactsWithOtherSettingsKeepTheirHistories) {
  Grains grains;
  dem::add_grain(grains, {0, 0.0499}, {.radius = 0.05, .density = 2500});
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law, dem::Plane<2>{}}, Leapfrog{}};
  sim.step();
  sim.interaction() = sim.interaction().with({.check_stability = false});
  EXPECT_EQ(sim.interaction().size(), 1u);
  EXPECT_EQ(sim.interaction().history(sim.particles()).size(), 1u);
}

// Counts its evaluations; must not be replaced by the contacts it is derived from.
struct CountingContacts : ContactsOfGrains {
  explicit CountingContacts(const ContactsOfGrains& contacts) : ContactsOfGrains(contacts) {}
  template <class S>
  void accelerate(Grains& grains, const S& search, double dt) {
    ++count;
    ContactsOfGrains::accelerate(grains, search, dt);
  }
  void add_forces() = delete;  // so that accelerate() is called
  int count = 0;
};

TEST(ForParticles, ADerivedInteractionIsStoredWhole) {
  Grains grains;
  dem::add_grain(grains, {0, 0.0499}, {.radius = 0.05, .density = 2500});
  const CountingContacts contacts{for_particles(dem::Contacts{law, dem::Plane<2>{}}, grains)};
  Simulation sim{grains, UniformGrid<2>{}, contacts, Leapfrog{}};
  sim.step(1e-5);
  sim.step(1e-5);
  EXPECT_GE(sim.interaction().count, 2);
}

// The search radius follows the radii of other grains that replace those of a simulation.
TEST(ForParticles, ContactsSeeTheRadiiOfGrainsThatReplaceOthers) {
  const auto two = [](double R) {
    Grains grains;
    for (const double x : {0.0, 0.09}) dem::add_grain(grains, {x, 0}, {.radius = R, .density = 1});
    return grains;
  };
  Simulation sim{two(0.01), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  sim.step(1e-5);
  EXPECT_EQ(sim.interaction().size(), 0u);
  sim.particles() = two(0.05);
  for (int k = 0; k < 3; ++k) sim.step(1e-5);
  EXPECT_EQ(sim.interaction().size(), 1u);
  Simulation other{two(0.01), UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
  other.step(1e-5);
  Simulation third{two(0.05), UniformGrid<2>{}, other.interaction(), Leapfrog{}};
  third.step(1e-5);
  EXPECT_EQ(third.interaction().size(), 1u);
}

// Moves the particles after the step of the leapfrog, which has verified its own results only.
struct MovesAfterwards : Leapfrog<> {
  template <class P, class S, class I>
  void step(P& particles, S& search, I& interaction, double dt) {
    Leapfrog<>::step(particles, search, interaction, dt);
    particles[position][0][0] += 2;
  }
};

TEST(ForParticles, ADerivedIntegratorThatMovesParticlesIsChecked) {
  Grains grains(Box<2>{.lower = {-1, -1}, .upper = {1, 1}});
  dem::add_grain(grains, {0, 0}, {.radius = 0.05, .density = 2500});
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law}, MovesAfterwards{}};
  EXPECT_TRUE(refuses([&] { sim.step(1e-5); }, {"left the box"}));
}

}  // namespace
}  // namespace silt::test::for_particles_test
