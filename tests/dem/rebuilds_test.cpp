// SPDX-License-Identifier: MIT
// When contacts rebuild their list: seen from the number of updates of the search, which is used
// for nothing else.
#include <silt/dem.hpp>

#include "support/grains.hpp"
#include <gtest/gtest.h>

namespace silt::test {
namespace {

struct CountedList : NeighbourList<2> {
  Index updates = 0;

  template <class P>
  void update(P& particles) {
    ++updates;
    NeighbourList<2>::update(particles);
  }
};

// Uses views that are not const, as in a user's part of Forces, and may change a radius.
struct Visitor {
  double growth = 0;  // of a radius in every step [m]

  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P>
  bool needs_search(const P&) const {
    return false;
  }
  template <class P, class S>
  void accelerate(P& grains, S&, double) const {
    const auto m = grains[mass];
    for (Index i = 0; i < grains.size(); ++i) grains[force][i] += m[i] * Vec<2>(0, -1e-6);
    if (!grains.empty()) grains[radius][0] += growth;
  }
};

dem::Grains<2> resting() {
  return dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.2}}, 0.02 * (1 + 1e-9)), pebble);
}

template <class P>
Index updates_in_steps(const P& grains, const Visitor& visitor) {
  const dem::CundallStrack law{.normal_stiffness = 1e4};
  Simulation simulation{grains, CountedList{}, Forces{dem::Contacts{law}, visitor}, Leapfrog{}};
  simulation.step(1e-5);
  const Index before = simulation.search().updates;
  for (int k = 0; k < 10; ++k) simulation.step(1e-5);
  return simulation.search().updates - before;
}

TEST(ContactList, IsKeptWhenMassesAreOnlyRead) { EXPECT_EQ(updates_in_steps(resting(), {}), 0u); }

TEST(ContactList, IsRebuiltWhenARadiusChanges) {
  EXPECT_GE(updates_in_steps(resting(), {.growth = 1e-12}), 5u);
}

TEST(ContactList, IsRebuiltBetweenStepsOnlyIfAConstantChanges) {
  const dem::CundallStrack law{.normal_stiffness = 1e4};
  Simulation simulation{resting(), CountedList{}, dem::Contacts{law}, Leapfrog{}};
  simulation.step(1e-5);
  auto& grains = simulation.particles();
  const auto rebuilds_after = [&](auto&& access) {
    const Index before = simulation.search().updates;
    access();
    simulation.step(1e-5);
    return simulation.search().updates - before;
  };
  EXPECT_EQ(rebuilds_after([&] { grains[inertia][0] *= 1; }), 0u);
  EXPECT_EQ(rebuilds_after([&] { grains[inertia][99] *= 2; }), 1u);
  EXPECT_EQ(rebuilds_after([&] { grains[mass][99] *= 2; }), 1u);
  EXPECT_EQ(rebuilds_after([&] { grains[radius][99] *= 0.9; }), 1u);
  EXPECT_EQ(rebuilds_after([&] { grains[dem::material][0] = 0; }), 0u);
}

TEST(ContactList, OfNoGrainsIsNeverRebuilt) {
  EXPECT_EQ(updates_in_steps(dem::Grains<2>{}, {}), 0u);
}

}  // namespace
}  // namespace silt::test
