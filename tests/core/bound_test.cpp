// SPDX-License-Identifier: MIT
// An interaction is bound to the type of its particles when a simulation is built.
#include <silt/dem.hpp>
#include <silt/measure/timed.hpp>

#include <gtest/gtest.h>

#include <concepts>

namespace silt::test {
namespace {

using Grains = dem::Grains<2>;
using Contacts = dem::Contacts<dem::CundallStrack, dem::Plane<2>>;
using ContactsOfGrains = dem::ContactsOf<Grains, dem::CundallStrack, dem::Plane<2>>;

static_assert(std::same_as<Bound<Contacts, Grains>, ContactsOfGrains>);
static_assert(std::same_as<Bound<ContactsOfGrains, Grains>, ContactsOfGrains>);
static_assert(std::same_as<Bound<Gravity<2>, Grains>, Gravity<2>>);
static_assert(std::same_as<Bound<Forces<Gravity<2>, Contacts>, Grains>,
                           Forces<Gravity<2>, ContactsOfGrains>>);
static_assert(std::same_as<Bound<TimedInteraction<Contacts>, Grains>,
                           TimedInteraction<ContactsOfGrains>>);
// Contacts of other particles, or of another dimension, do not exist.
static_assert(std::same_as<Bound<Contacts, Particles<2, double>>, Contacts>);
static_assert(std::same_as<Bound<Contacts, dem::Grains<3>>, Contacts>);

const dem::CundallStrack law{.normal_stiffness = 1e5, .restitution = 0.5};
Forces<Gravity<2>, Contacts> forces(double g) {
  return Forces{Gravity<2>{{0, -g}}, dem::Contacts{law, dem::Plane<2>{}}};
}
auto grain_on_a_floor() {
  Grains grains;
  dem::add_grain(grains, {0, 0.0499}, {.radius = 0.05, .density = 2500});
  return Simulation{grains, UniformGrid<2>{}, forces(9.81), Leapfrog{}};
}

TEST(Bound, PartsAreFoundByTheTypeGivenAndByTheBoundOne) {
  auto sim = grain_on_a_floor();
  sim.step();
  EXPECT_EQ(sim.interaction().part<Contacts>().size(), 1u);
  EXPECT_EQ(&sim.interaction().part<Contacts>(), &sim.interaction().part<ContactsOfGrains>());
  EXPECT_EQ(&sim.interaction().part<Contacts>(), &sim.interaction().part<1>());
}

TEST(Bound, AnInteractionOfTheSameTypesReplacesThatOfASimulation) {
  auto sim = grain_on_a_floor();
  auto other = grain_on_a_floor();
  sim.interaction() = forces(-9.81);
  sim.step();
  other.step();
  EXPECT_GT(sim.particles()[velocity][0][1], other.particles()[velocity][0][1]);
}

TEST(Bound, InteractionsAddForcesWithoutASimulation) {
  auto sim = grain_on_a_floor();
  auto grains = sim.particles();
  auto interaction = bound(forces(9.81), grains);
  UniformGrid<2> search{{.radius = interaction.reach(grains)}};
  search.update(grains);
  clear(grains);
  interaction.accelerate(grains, search, interaction.time_step(grains));
  EXPECT_NEAR(grains[force][0][1], 1e5 * 1e-4 - 9.81 * grains[mass][0], 1e-9);
}

// The contacts of state() belong to the grains of the same type.
TEST(Bound, ASimulationContinuesFromTheStateOfAnother) {
  auto sim = grain_on_a_floor();
  for (int k = 0; k < 5; ++k) sim.step(1e-5);
  const auto [grains, interaction] = sim.state();
  Simulation next{grains, UniformGrid<2>{}, interaction, Leapfrog{}};
  next.step(1e-5);
  EXPECT_EQ(next.interaction().part<Contacts>().size(), 1u);
}

}  // namespace
}  // namespace silt::test
