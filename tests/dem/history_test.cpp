// SPDX-License-Identifier: MIT
// What contacts remember, and of whom: through new searches, restarts and several looks in a step.
#include "support/check.hpp"
#include "support/grains.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace silt::test {
namespace {

// A spring that counts how often it is looked at, in Reals and in a number that is none.
template <int begin>
struct SpringCountingFrom {
  template <int Dim, class Real>
  struct History {
    Real looks = begin;
    int number = begin;
  };
  template <class C, class M>
  auto force(const C& contact, M& history) const {
    history.looks += 1;
    history.number += 1;
    return typename C::Vec(typename C::Real(1e-6) * contact.overlap * contact.normal);
  }
};
using CountingSpring = SpringCountingFrom<0>;

// A row of grains in touch.
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
std::vector<int> looks_of(const C& contacts, const P& grains) {
  std::vector<int> looks;
  contacts.history(grains).for_each_pair([&](Id, Id, const auto& history) {
    EXPECT_EQ(history.looks, history.number);
    looks.push_back(history.number);
  });
  return looks;
}

template <class Real>
void expect_counts() {
  Simulation sim{row_of<3, Real>(7), UniformGrid<3, Real>{}, dem::Contacts{CountingSpring{}}, Leapfrog{}};
  for (int step = 1; step <= 4; ++step) {
    sim.step(1e-6);
    EXPECT_EQ(looks_of(sim.interaction(), sim.particles()), std::vector<int>(6, step));
  }
}

TEST(LawHistory, HoldsNumbersThatAreNoReals) {
  expect_counts<double>();
  expect_counts<float>();
}

TEST(LawHistory, GoesOnFromWhatARestartReads) {
  const auto grains = row_of<2, double>(2);
  UniformGrid<2> search({.radius = 1});
  dem::Contacts contacts{CountingSpring{}};
  PairHistory<CountingSpring::History<2, double>> history({{0, 1, {.looks = 100, .number = 100}}});
  contacts.set_history(grains, history);
  EXPECT_EQ(looks_of(contacts, grains), std::vector{100});
  auto moved = grains;
  for (int look = 101; look < 105; ++look) {
    moved[position][0][0] += look % 2 == 0 ? 0.04 : -0.04;  // so far that all is found anew
    search.update(moved);
    contacts.accelerate(moved, search, 1e-6);
    EXPECT_EQ(looks_of(contacts, moved), std::vector{look});
  }
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{CountingSpring{}}, Leapfrog{}};
  sim.interaction().set_history(sim.particles(), history);
  EXPECT_THROW(sim.step(-1), Error);
  for (int look = 101; look < 104; ++look) {
    sim.step(1e-6);
    EXPECT_EQ(looks_of(sim.interaction(), sim.particles()), std::vector{look});
    const auto state = sim.state();
    EXPECT_EQ(looks_of(state.interaction, state.particles), std::vector{look + 1});
  }
}

// What looks made by hand, without Simulation's save() and restore(), leave behind.
struct LooksByHand {
  dem::Grains<2> grains = row_of<2, double>(3);
  UniformGrid<2> search{{.radius = 1}};
  dem::Contacts<CountingSpring> contacts{CountingSpring{}};

  std::vector<int> look() {
    search.update(grains);
    contacts.accelerate(grains, search, 1e-6);
    return looks_of(contacts, grains);
  }
};

TEST(LawHistory, IsForgottenByALookThatFails) {
  LooksByHand by_hand;
  by_hand.look();
  EXPECT_EQ(by_hand.look(), (std::vector{2, 2}));
  const auto sound = by_hand.grains;
  by_hand.grains[position][2] = by_hand.grains[position][1];
  EXPECT_TRUE(refuses([&] { by_hand.look(); }, {"coincide"}));
  by_hand.grains = sound;
  EXPECT_EQ(by_hand.look(), (std::vector{1, 1}));
  EXPECT_EQ(by_hand.look(), (std::vector{2, 2}));
}

TEST(LawHistory, OutlivesALookThatIsRefused) {
  LooksByHand by_hand;
  by_hand.look();
  const auto sound = by_hand.grains;
  by_hand.grains[radius][1] = -1;
  by_hand.grains[position][0][0] -= 0.04;  // so far that all is found anew
  EXPECT_TRUE(refuses([&] { by_hand.look(); }, {"radius = -1", "id 1"}));
  by_hand.grains = sound;
  EXPECT_EQ(by_hand.look(), (std::vector{2, 2}));
}

TEST(LawHistory, BeginsAnewWhenGrainsMeetAgain) {
  auto grains = row_of<2, double>(2);
  UniformGrid<2> search({.radius = 1});
  dem::Contacts contacts{SpringCountingFrom<7>{}};
  const double touching = grains[position][1][0];
  const auto look_at = [&](double x) {
    grains[position][1][0] = x;
    search.update(grains);
    contacts.accelerate(grains, search, 1e-6);
    return looks_of(contacts, grains);
  };
  const std::vector<int> none;
  for (const double apart : {1.0 + 1e-9, 1.5, 4.0}) {  // near, farther, out of reach
    EXPECT_EQ(look_at(touching), std::vector{8}) << "before they are at " << apart;
    EXPECT_EQ(look_at(touching), std::vector{9});
    EXPECT_EQ(look_at(apart), none);
    EXPECT_EQ(look_at(apart), none);
  }
}

// Contacts that were found with one list must not take another's word for it that nobody has moved.
TEST(Contacts, AreFoundAnewForAnotherList) {
  dem::Grains<2> grains;
  for (const double x : {0.0, 5.0}) dem::add_grain(grains, {x, 0}, {.radius = 0.5, .density = 1});
  grains[velocity][0] = {1, 0};
  const dem::CundallStrack spring{.normal_stiffness = 1e3};
  Simulation first{grains, NeighbourList<2>{}, dem::Contacts{spring}, Leapfrog{}};
  first.run({.until = 3, .time_step = 1e-3});
  const auto [particles, contacts] = first.state();
  Simulation second{particles, NeighbourList<2>{}, contacts, Leapfrog{}};
  second.run({.until = 3, .time_step = 1e-3});
  EXPECT_NEAR(second.snapshot()[velocity][1][0], 1, 1e-3) << "they have met";

  auto by_hand = particles;
  dem::Contacts same{spring};
  Index most = 0;
  for (int step = 0; step < 1500; ++step) {
    NeighbourList<2> list({.radius = 1});
    list.update(by_hand);
    same.accelerate(by_hand, list, 1e-3);
    most = std::max(most, same.size());
    by_hand[position][0][0] += 1e-3;
  }
  EXPECT_EQ(most, 1u);
}

}  // namespace
}  // namespace silt::test
