// SPDX-License-Identifier: MIT
// Contact history after a rebuild of the list, after resuming, and with several evaluations in a
// step.
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace silt::test::history_test {
namespace {

// A spring that counts its evaluations, in a Real and in an integer.
template <int begin>
struct SpringCountingFrom {
  template <int Dim, class Real>
  struct History {
    Real count = begin;
    int number = begin;
  };
  template <class C, class M>
  auto force(const C& contact, M& history) const {
    history.count += 1;
    history.number += 1;
    return typename C::Vec(typename C::Real(1e-6) * contact.overlap * contact.normal);
  }
};
using CountingSpring = SpringCountingFrom<0>;

// A row of touching grains.
template <int Dim, class Real>
dem::Grains<Dim, Real> row_of(int number) {
  dem::Grains<Dim, Real> grains;
  for (int k = 0; k < number; ++k) {
    Vec<Dim, Real> x = Vec<Dim, Real>::Zero();
    x[0] = Real(0.95 * k);
    dem::add_grain(grains, x, {.radius = 0.5, .density = 1});
  }
  return grains;
}

template <class C, class P>
std::vector<int> counts_of(const C& contacts, const P& grains) {
  std::vector<int> counts;
  contacts.history(grains).for_each_pair([&](Id, Id, const auto& history) {
    EXPECT_EQ(history.count, history.number);
    counts.push_back(history.number);
  });
  return counts;
}

template <class Real>
void expect_counts() {
  Simulation sim{row_of<3, Real>(7), UniformGrid<3, Real>{}, dem::Contacts{CountingSpring{}},
                 Leapfrog{}};
  for (int step = 1; step <= 4; ++step) {
    sim.step(1e-6);
    EXPECT_EQ(counts_of(sim.interaction(), sim.particles()), std::vector<int>(6, step));
  }
}

TEST(LawHistory, MayContainOtherTypesThanReal) {
  expect_counts<double>();
#if SILT_SLOW_TESTS
  expect_counts<float>();
#endif
}

TEST(LawHistory, ContinuesFromSetHistory) {
  const auto grains = row_of<2, double>(2);
  UniformGrid<2> search({.radius = 1});
  auto contacts = for_particles(dem::Contacts{CountingSpring{}}, grains);
  PairHistory<CountingSpring::History<2, double>> history({{0, 1, {.count = 100, .number = 100}}});
  contacts.set_history(grains, history);
  EXPECT_EQ(counts_of(contacts, grains), std::vector{100});
  auto moved = grains;
  for (int count = 101; count < 105; ++count) {
    moved[position][0][0] += count % 2 == 0 ? 0.04 : -0.04;  // far enough for a rebuild
    search.update(moved);
    contacts.accelerate(moved, search, 1e-6);
    EXPECT_EQ(counts_of(contacts, moved), std::vector{count});
  }
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{CountingSpring{}}, Leapfrog{}};
  sim.interaction().set_history(sim.particles(), history);
  EXPECT_THROW(sim.step(-1), Error);
  for (int count = 101; count < 104; ++count) {
    sim.step(1e-6);
    EXPECT_EQ(counts_of(sim.interaction(), sim.particles()), std::vector{count});
    const auto state = sim.state();
    EXPECT_EQ(counts_of(state.interaction, state.particles), std::vector{count + 1});
  }
}

// Evaluations without the save() and restore() of Simulation.
struct ManualSteps {
  dem::Grains<2> grains = row_of<2, double>(3);
  UniformGrid<2> search{{.radius = 1}};
  dem::ContactsOf<dem::Grains<2>, CountingSpring> contacts{dem::Contacts{CountingSpring{}}};

  std::vector<int> step() {
    search.update(grains);
    contacts.accelerate(grains, search, 1e-6);
    return counts_of(contacts, grains);
  }
};

TEST(LawHistory, IsUnchangedByAFailedEvaluation) {
  ManualSteps manual;
  manual.step();
  EXPECT_EQ(manual.step(), (std::vector{2, 2}));
  const auto valid = manual.grains;
  manual.grains[position][2] = manual.grains[position][1];
  EXPECT_TRUE(refuses([&] { manual.step(); }, {"coincide"}));
  manual.grains = valid;
  EXPECT_EQ(manual.step(), (std::vector{3, 3}));
  EXPECT_EQ(manual.step(), (std::vector{4, 4}));
}

// The first step that is refused: two centres coincide.
void fail_a_step(auto& sim) {
  const auto x = sim.particles()[position];
  const auto apart = x[2];
  x[2] = x[1];
  EXPECT_TRUE(refuses([&] { sim.step(1e-6); }, {"coincide"}));
  sim.particles()[position][2] = apart;
}

std::vector<double> forces_in(const auto& interaction, const auto& grains) {
  std::vector<double> forces;
  interaction.for_each_contact(grains, [&](Index, Index, const auto& contact, const auto& force) {
    forces.push_back(contact.overlap);
    forces.push_back(force.norm());
  });
  return forces;
}

auto touching_row() {
  return Simulation(row_of<2, double>(3), UniformGrid<2>({.radius = 1}),
                    dem::Contacts{CountingSpring{}}, Leapfrog());
}

TEST(ContactsOfStep, AreTheSameAfterAFailedStepIfTheyHadBeenUsed) {
  auto sim = touching_row();
  sim.step(1e-6);
  sim.step(1e-6);
  const auto before = forces_in(sim.interaction(), sim.particles());
  EXPECT_EQ(before.size(), 4u);
  sim.step(1e-6);
  const auto after = forces_in(sim.interaction(), sim.particles());
  fail_a_step(sim);
  EXPECT_EQ(forces_in(sim.interaction(), sim.particles()), after);
}

TEST(ContactsOfStep, AreUnknownAfterAFailedStepIfTheyHadNeverBeenUsed) {
  auto sim = touching_row();
  sim.step(1e-6);
  sim.step(1e-6);
  auto twin = sim;
  fail_a_step(sim);
  EXPECT_EQ(sim.interaction().size(), 2u);
  EXPECT_TRUE(refuses([&] { forces_in(sim.interaction(), sim.particles()); },
                      {"contacts of the step before a failed one", "Simulation::state()"}));
  const auto state = sim.state();
  EXPECT_EQ(forces_in(state.interaction, state.particles).size(), 4u);
  sim.step(1e-6);
  twin.step(1e-6);
  EXPECT_EQ(forces_in(sim.interaction(), sim.particles()),
            forces_in(twin.interaction(), twin.particles()));
}

// What no other proves: the forces of a step that rebuilt its list are known although its histories
// before the step have been replaced, also if grains were then reordered.
TEST(ContactsOfStep, OfANewListAreThoseOfContactsThatHadBeenUsedBefore) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  Simulation sim{crowd<3, double>(7, 3), NeighbourList<3>{}, dem::Contacts{law}, Leapfrog{}};
  auto twin = sim;
  for (int step = 0; step < 20; ++step) {
    sim.step(1e-5);
    twin.step(1e-5);
    EXPECT_FALSE(forces_in(twin.interaction(), twin.particles()).empty());
  }
  for (auto* const each : {&sim, &twin}) {
    each->particles().remove(each->particles().id(5));  // the list must be rebuilt
    each->step(1e-5);
    std::vector<Index> order(each->particles().size());
    std::iota(order.rbegin(), order.rend(), Index(0));
    each->particles().reorder(order);
  }
  EXPECT_EQ(forces_in(sim.interaction(), sim.particles()),
            forces_in(twin.interaction(), twin.particles()));
  EXPECT_EQ(sim.interaction().elastic_energy(sim.particles()),
            twin.interaction().elastic_energy(twin.particles()));
}

TEST(LawHistory, IsKeptAfterRejectedInput) {
  ManualSteps manual;
  manual.step();
  const auto valid = manual.grains;
  manual.grains[radius][1] = -1;
  manual.grains[position][0][0] -= 0.04;  // far enough for a rebuild
  EXPECT_TRUE(refuses([&] { manual.step(); }, {"radius = -1", "id 1"}));
  manual.grains = valid;
  EXPECT_EQ(manual.step(), (std::vector{2, 2}));
}

TEST(LawHistory, IsInitialInANewContact) {
  auto grains = row_of<2, double>(2);
  UniformGrid<2> search({.radius = 1});
  auto contacts = for_particles(dem::Contacts{SpringCountingFrom<7>{}}, grains);
  const double touching = grains[position][1][0];
  const auto count_at = [&](double x) {
    grains[position][1][0] = x;
    search.update(grains);
    contacts.accelerate(grains, search, 1e-6);
    return counts_of(contacts, grains);
  };
  const std::vector<int> none;
  for (const double apart : {1.0 + 1e-9, 1.5, 4.0}) {  // near, farther, out of range
    EXPECT_EQ(count_at(touching), std::vector{8}) << "before they are at " << apart;
    EXPECT_EQ(count_at(touching), std::vector{9});
    EXPECT_EQ(count_at(apart), none);
    EXPECT_EQ(count_at(apart), none);
  }
}

// Contacts found with one list must not rely on the displacements recorded by another.
TEST(Contacts, AreRebuiltForAnotherNeighbourList) {
  dem::Grains<2> grains;
  for (const double x : {0.0, 5.0}) dem::add_grain(grains, {x, 0}, {.radius = 0.5, .density = 1});
  grains[velocity][0] = {1, 0};
  const dem::CundallStrack spring{.normal_stiffness = 1e3};
  Simulation first{grains, NeighbourList<2>{}, dem::Contacts{spring}.with(without_limits),
                   Leapfrog{}};
  first.run({.until = 3, .time_step = 1e-3});
  const auto [particles, contacts] = first.state();
  Simulation second{particles, NeighbourList<2>{}, contacts, Leapfrog{}};
  second.run({.until = 3, .time_step = 1e-3});
  EXPECT_NEAR(second.snapshot()[velocity][1][0], 1, 1e-3) << "they have met";

  auto moved = particles;
  auto same = for_particles(dem::Contacts{spring}.with(without_limits), moved);
  Index max_size = 0;
  for (int step = 0; step < 1500; ++step) {
    NeighbourList<2> list({.radius = 1});
    list.update(moved);
    same.accelerate(moved, list, 1e-3);
    max_size = std::max(max_size, same.size());
    moved[position][0][0] += 1e-3;
  }
  EXPECT_EQ(max_size, 1u);
}

}  // namespace
}  // namespace silt::test::history_test
