// SPDX-License-Identifier: MIT
// Contact laws, bonds, grains and settings of contacts accept or refuse wrong and extreme values as
// these tables say; a law with accepted values gives finite forces.
#include <silt/dem/conformance/checks.hpp>

#include "support/bad_input_table.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace silt::test::bad_input_of_grains_test {
namespace {

using dem::Elastic;

// Evaluates a contact of two grains, as Contacts does, at a usual time step.
template <class Law>
void use(const Law& given) {
  const dem::Materials<Law> materials{given};
  const Law& law = materials.between(0, 0);
  dem::Contact<3, double> contact;
  contact.normal = {1, 0, 0};
  contact.overlap = 1e-4;
  contact.relative_velocity = {-0.1, 0.01, 0};
  contact.relative_spin = {1, 2, 3};
  contact.effective_mass = contact.effective_radius = 5e-3;
  const dem::Stiffness k = law.stiffness(contact);
  contact.time_step = 0.02 * std::sqrt(contact.effective_mass / std::max(k.normal, k.tangential));
  EXPECT_GT(k.normal, 0);
  typename Law::template History<3, double> history{};
  for (int step = 0; step < 2; ++step) {
    const auto load = law.components(contact, history);
    EXPECT_GT(load.normal_spring, 0);
    EXPECT_TRUE(is_finite(load.force(contact.normal)));
    EXPECT_TRUE(is_finite(law.elastic_energy(contact, history)));
  }
}

const dem::LinearSpringDashpot spring{.normal_stiffness = 1e5, .restitution = 0.5};
const Elastic glass{.young_modulus = 1e7, .poisson_ratio = 0.25};

void use_cundall_strack(const dem::CundallStrack& law) { use(law); }
void use_normal(const dem::LinearSpringDashpot& normal) { use(dem::Law{normal}); }
void use_normal(const dem::Hertz& normal) { use(dem::Law{normal}); }
void use_normal(const dem::WaltonBraun& normal) { use(dem::Law{normal}); }
void use_friction(const dem::LinearFriction& friction) { use(dem::Law{spring, friction}); }
void use_friction(const dem::Mindlin& friction) {
  use(dem::Law{dem::Hertz{.elastic = glass}, friction});
}
void use_rolling(const dem::RollingResistance& rolling) { use(dem::Law{spring, rolling}); }
void use_adhesion(const dem::DmtAdhesion& adhesion) { use(dem::Law{spring, adhesion}); }
void use_adhesion(const dem::ConstantCohesion& adhesion) { use(dem::Law{spring, adhesion}); }

// Parameters of which two are multiplied are accepted from 1e-100 to 1e100.
TEST(BadInput, OfTheLawOfCundallAndStrackIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"CundallStrack: normal_stiffness",
       [](double x) { use_cundall_strack({.normal_stiffness = x}); }, accepts::nothing},
      {"CundallStrack: tangential_stiffness",
       [](double x) { use_cundall_strack({.normal_stiffness = 1e5, .tangential_stiffness = x}); },
       accepts::zero},
      {"CundallStrack: restitution",
       [](double x) { use_cundall_strack({.normal_stiffness = 1e5, .restitution = x}); },
       accepts::tiny},
      {"CundallStrack: beta",
       [](double x) { use_cundall_strack({.normal_stiffness = 1e5, .beta = x}); }, accepts::zero},
      {"CundallStrack: friction_angle",
       [](double x) {
         use_cundall_strack(
             {.normal_stiffness = 1e5, .tangential_stiffness = 1e5, .friction_angle = x});
       },
       accepts::zero | accepts::tiny},
      {"CundallStrack: cohesion",
       [](double x) {
         use_cundall_strack({.normal_stiffness = 1e5, .tangential_stiffness = 1e5, .cohesion = x});
       },
       accepts::not_negative}});
}

TEST(BadInput, OfComponentsOfLawsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"LinearSpringDashpot: normal_stiffness",
       [](double x) { use_normal(dem::LinearSpringDashpot{.normal_stiffness = x}); },
       accepts::nothing},
      {"LinearSpringDashpot: restitution",
       [](double x) {
         use_normal(dem::LinearSpringDashpot{.normal_stiffness = 1e5, .restitution = x});
       },
       accepts::tiny},
      {"Hertz: young_modulus",
       [](double x) { use_normal(dem::Hertz{.elastic = {.young_modulus = x}}); }, accepts::nothing},
      {"Hertz: poisson_ratio",
       [](double x) {
         use_normal(dem::Hertz{.elastic = {.young_modulus = 1, .poisson_ratio = x}});
       },
       accepts::zero | accepts::tiny},
      {"Hertz: restitution",
       [](double x) { use_normal(dem::Hertz{.elastic = glass, .restitution = x}); }, accepts::tiny},
      {"WaltonBraun: loading_stiffness",
       [](double x) { use_normal(dem::WaltonBraun{.loading_stiffness = x}); }, accepts::nothing},
      {"WaltonBraun: restitution",
       [](double x) { use_normal(dem::WaltonBraun{.loading_stiffness = 1e5, .restitution = x}); },
       accepts::nothing},
      {"LinearFriction: tangential_stiffness",
       [](double x) { use_friction(dem::LinearFriction{.tangential_stiffness = x}); },
       accepts::nothing},
      {"LinearFriction: friction_angle",
       [](double x) {
         use_friction(dem::LinearFriction{.tangential_stiffness = 1e5, .friction_angle = x});
       },
       accepts::zero | accepts::tiny},
      {"LinearFriction: cohesion",
       [](double x) {
         use_friction(dem::LinearFriction{.tangential_stiffness = 1e5, .cohesion = x});
       },
       accepts::not_negative},
      {"Mindlin: young_modulus",
       [](double x) { use_friction(dem::Mindlin{.elastic = {.young_modulus = x}}); },
       accepts::nothing},
      {"Mindlin: poisson_ratio",
       [](double x) {
         use_friction(dem::Mindlin{.elastic = {.young_modulus = 1e7, .poisson_ratio = x}});
       },
       accepts::zero | accepts::tiny},
      {"Mindlin: friction_angle",
       [](double x) { use_friction(dem::Mindlin{.elastic = glass, .friction_angle = x}); },
       accepts::zero | accepts::tiny},
      {"RollingResistance: rolling_friction",
       [](double x) { use_rolling({.rolling_friction = x}); }, accepts::zero | accepts::tiny},
      {"RollingResistance: twisting_friction",
       [](double x) { use_rolling({.twisting_friction = x}); }, accepts::zero | accepts::tiny},
      {"RollingResistance: damping_ratio",
       [](double x) { use_rolling({.rolling_friction = 0.1, .damping_ratio = x}); },
       accepts::not_negative},
      {"DmtAdhesion: surface_energy",
       [](double x) { use_adhesion(dem::DmtAdhesion{.surface_energy = x}); }, accepts::zero},
      {"ConstantCohesion: pull", [](double x) { use_adhesion(dem::ConstantCohesion{.pull = x}); },
       accepts::not_negative}});
}

// The stresses of a bond after its grains have moved.
void use_bonds(const dem::ParallelBond& law, double max_gap = 0) {
  auto grains = two_grains<3>(0, Vec<3>(0, 0, 0));
  dem::Bonds<3> bonds(law);
  UniformGrid<3> search({.radius = 0.02});
  bonds.bond_all_touching(grains, search, {.max_gap = max_gap});
  EXPECT_EQ(bonds.bonds().size(), 1u);
  for (int step = 0; step < 2; ++step) {
    bonds.accelerate(grains, search, 0.5 * bonds.time_step(grains));
    grains[position][1] += Vec<3>(1e-6, 2e-6, 0);
    grains[spin][1] = {1e-6, 1e-6, 1e-6};
  }
  for (const auto& bond : bonds.bonds()) {
    EXPECT_TRUE(is_finite(bond.force));
    EXPECT_GT(bonds.state(grains, bond).tensile_stress, 0);
    EXPECT_GE(bonds.state(grains, bond).shear_stress, 0);
  }
}

TEST(BadInput, OfBondsIsRefused) {
  constexpr double k = 1e9;
  check_parameters(std::vector<NumberParameter>{
      {"ParallelBond: normal_stiffness", [](double x) { use_bonds({.normal_stiffness = x}); },
       accepts::nothing},
      {"ParallelBond: tangential_stiffness",
       [](double x) { use_bonds({.normal_stiffness = k, .tangential_stiffness = x}); },
       accepts::zero},
      {"ParallelBond: radius_share",
       [](double x) { use_bonds({.normal_stiffness = k, .radius_share = x}); }, accepts::nothing},
      {"ParallelBond: beta", [](double x) { use_bonds({.normal_stiffness = k, .beta = x}); },
       accepts::zero},
      {"ParallelBond: tensile_strength",
       [](double x) { use_bonds({.normal_stiffness = k, .tensile_strength = x}); },
       accepts::positive | accepts::infinite},
      {"ParallelBond: shear_strength",
       [](double x) { use_bonds({.normal_stiffness = k, .shear_strength = x}); },
       accepts::positive | accepts::infinite},
      {"Touching: max_gap", [](double x) { use_bonds({.normal_stiffness = k}, x); },
       accepts::not_negative}});
}

// Two steps of two grains in contact, of which the second is as given. A step that is refused
// changes nothing.
template <class Change>
void use_beside_another(Change&& change) {
  auto grains = two_grains<2>(-1e-4, Vec<2>(0, 0));
  grains.remove(1);
  change(grains);
  Simulation sim{grains, UniformGrid<2>{},
                 dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
  for (int step = 0; step < 2; ++step) {
    change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.step(1e-6); });
    if (step == 0) {
      EXPECT_EQ(sim.interaction().size(), 1u);
    }
  }
}

void use_grain(const dem::Grain& grain) {
  use_beside_another([&](auto& grains) {
    change_or_keep([&] { return state_of(grains); },
                   [&] { dem::add_grain(grains, {0.0199, 0}, grain); });
  });
}

// The other grain, with one value changed.
template <class Field>
void use_value(Field field, double value) {
  use_beside_another([&](auto& grains) {
    const Index i = dem::add_grain(grains, {0.0199, 0}, pebble);
    if constexpr (requires { grains[field][i][0]; }) {
      grains[field][i][0] = value;
    } else {
      grains[field][i] = value;
    }
  });
}

TEST(BadInput, OfGrainsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"Grain: radius", [](double x) { use_grain({.radius = x, .density = 2500}); },
       accepts::nothing},
      {"Grain: density", [](double x) { use_grain({.radius = 0.01, .density = x}); },
       accepts::nothing},
      {"Particles::add: position",
       [](double x) {
         dem::Grains<2> grains;
         change_or_keep([&] { return state_of(grains); },
                        [&] { dem::add_grain(grains, {0, x}, pebble); });
         EXPECT_EQ(grains.size(), 1u);
       },
       accepts::finite},
      {"dem::Contacts: radius", [](double x) { use_value(radius, x); }, accepts::nothing},
      {"dem::Contacts: mass", [](double x) { use_value(mass, x); }, accepts::nothing},
      {"dem::Contacts: inertia", [](double x) { use_value(inertia, x); }, accepts::huge},
      {"velocity", [](double x) { use_value(velocity, x); }, accepts::finite & ~accepts::huge},
      {"Simulation: spin", [](double x) { use_value(spin, x); }, accepts::finite},
      {"Simulation: angle", [](double x) { use_value(angle, x); }, accepts::finite}});
  check_parameters(std::vector<IntegerParameter>{
      {"Grain: material",
       [](std::int64_t n) {
         dem::Grains<2> grains;
         dem::add_grain(grains, {0, 0},
                        {.radius = 1, .density = 1, .material = static_cast<Index>(n)});
       },
       accepts::zero},
      {"dem::Contacts: material",
       [](std::int64_t n) {
         use_beside_another([&](auto& grains) {
           const Index i = dem::add_grain(grains, {0.0199, 0}, pebble);
           grains[dem::material][i] = static_cast<std::uint32_t>(n);
         });
       },
       accepts::zero, 1 << 30}});
}

TEST(BadInput, OfSettingsOfContactsIsRefused) {
  const dem::CundallStrack law{.normal_stiffness = 1e5};
  check_parameters(std::vector<NumberParameter>{
      {"ContactSettings: steps_per_contact",
       [&](double x) { dem::Contacts{law}.with({.steps_per_contact = x}); }, accepts::positive},
      {"ContactSettings: max_overlap",
       [&](double x) { dem::Contacts{law}.with({.max_overlap = x}); },
       accepts::positive | accepts::infinite},
      {"ContactSettings: max_displacement",
       [&](double x) { dem::Contacts{law}.with({.max_displacement = x}); },
       accepts::positive | accepts::infinite},
      {"Spring: mass", [](double x) { dem::contact_duration({.mass = x, .stiffness = 1}); },
       accepts::positive},
      {"Spring: stiffness", [](double x) { dem::contact_duration({.mass = 1, .stiffness = x}); },
       accepts::positive},
      {"ConformanceConditions: radius",
       [](double x) { dem::ConformanceConditions{.radius = x}.check(); }, accepts::huge},
      {"ConformanceConditions: density",
       [](double x) { dem::ConformanceConditions{.density = x}.check(); }, accepts::positive},
      {"ConformanceConditions: overlap",
       [](double x) { dem::ConformanceConditions{.overlap = x}.check(); }, accepts::tiny}});
}

}  // namespace
}  // namespace silt::test::bad_input_of_grains_test
