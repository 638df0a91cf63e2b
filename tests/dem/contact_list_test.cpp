// SPDX-License-Identifier: MIT
// The list of contacts is rebuilt when it has to be, and only from an updated search.
#include <silt/dem.hpp>

#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/reads_these.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace silt::test::contact_list_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e4, .restitution = 0.5};

// The search is used for nothing else than rebuilding the list.
struct CountedList : NeighbourList<2> {
  Index updates = 0;

  template <class P>
  void update(P& particles) {
    ++updates;
    NeighbourList<2>::update(particles);
  }
};

// Uses views that are not const, as a user's part of Forces may, and may change a radius.
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

template <class Interaction>
Index most_contacts(const Interaction& interaction) {
  auto grains =
      dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0.06, 0}}, {.radius = 0.01, .density = 2500});
  grains[velocity][0] = {1, 0};
  grains[velocity][1] = {-1, 0};
  Simulation sim{grains, NeighbourList<2>{}, interaction, Leapfrog{}};
  Index most = 0;
  while (sim.time() < 0.04) {
    sim.step(2e-5);
    most = std::max(most, sim.interaction().template part<1>().size());
  }
  return most;
}

TEST(ContactList, IsRebuiltFromAnUpdatedSearchIfAnotherPartReadsMasses) {
  EXPECT_EQ(most_contacts(Forces{Gravity<2>{{0, 0}}, dem::Contacts{law}.with(without_limits)}), 1u);
  EXPECT_EQ(most_contacts(Forces{Visitor{}, dem::Contacts{law}.with(without_limits)}), 1u);
}

// A list that a failed step has built is in the memory that the next step builds one in.
TEST(ContactList, IsDividedAnewAfterAFailedStep) {
  constexpr double R = 0.01;
  constexpr Index count = 200;
  dem::Grains<2> grains;
  for (Index k = 0; k < count; ++k) {
    dem::add_grain(grains, Vec<2>(3 * R * double(k), 0), {.radius = R, .density = 2500});
  }
  Simulation sim{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  sim.step(1e-5);
  const auto move = [](auto& simulation, Index n) {
    const auto x = simulation.particles()[position];
    for (Index k = 0; k < n; ++k) x[k] = {1.99 * R * double(k % 20), 1.99 * R * double(k / 20)};
    for (Index k = n; k < count; ++k) x[k] = {3 * R * double(k), -1};
  };
  auto expected = sim;
  move(sim, 10);
  sim.particles()[velocity][count - 1] = {1e9, 0};
  EXPECT_THROW(sim.step(1e-5), Error);
  sim.particles()[velocity][count - 1] = {0, 0};
  for (auto* each : {&sim, &expected}) {
    move(*each, count);
    each->step(1e-5);
  }
  EXPECT_TRUE(state_of(sim.particles()) == state_of(expected.particles()));
}

TEST(ContactList, HasTheWallsBeyondAPeriodicSide) {
  auto grains =
      dem::make_grains(std::vector<Vec<2>>{{0.95, 0.0138}}, {.radius = 0.01, .density = 2500});
  Box<2> box{.lower = {0, -1}, .upper = {1, 1}};
  box.periodic = {true, false};
  grains.set_box(box);
  grains[velocity][0] = {0.5, 0};
  const dem::Polyline<> floor{.points = {{-0.2, 0}, {0.5, -0.01}, {1.2, 0}}};
  Simulation sim{grains, NeighbourList<2>{},
                 Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, floor}}, Leapfrog{}};
  Index crossings = 0;
  double before = 0.95;
  while (sim.time() < 0.3) {
    const double x = std::as_const(sim).particles()[position][0][0];
    const double y = std::as_const(sim).particles()[position][0][1];
    sim.step(2e-5);
    const double height = -0.01 + 0.01 * std::abs(x - 0.5) / 0.7;
    if (y - height < 0.01 - 1e-6) {
      ASSERT_EQ(sim.interaction().part<1>().size(), 1u) << "at x = " << x;
    }
    crossings += x < before - 0.5;
    before = x;
  }
  EXPECT_EQ(crossings, 1u);
}

TEST(ContactList, IsRebuiltAfterARadiusWasChanged) {
  auto grains =
      dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0.03, 0}}, {.radius = 0.01, .density = 2500});
  Simulation sim{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  sim.step(1e-5);
  EXPECT_EQ(sim.interaction().size(), 0u);
  sim.particles()[radius][0] = 0.0205;
  sim.step(1e-5);
  EXPECT_EQ(sim.interaction().size(), 1u);
}

TEST(ContactList, IsRebuiltAfterAGrainWasMoved) {
  auto grains =
      dem::make_grains(std::vector<Vec<2>>{{0, 0}, {0.5, 0}}, {.radius = 0.01, .density = 2500});
  Simulation sim{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  sim.step(1e-5);
  sim.particles()[position][1][0] = 0.0199;
  sim.step(1e-5);
  EXPECT_EQ(sim.interaction().size(), 1u);
}

dem::Grains<2> resting() {
  return dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.2}}, 0.02 * (1 + 1e-9)), pebble);
}

template <class P>
Index updates_in_steps(const P& grains, const Visitor& visitor) {
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

  const dem::Moving floor{dem::Plane<2>{},
                          dem::Vibration<2>{.amplitude = {0, 1e-3}, .frequency = 60}};
  Simulation simulation{dem::Grains<2>{}, CountedList{}, dem::Contacts{law, floor}, Leapfrog{}};
  simulation.step(1e-5);
  const Index before = simulation.search().updates;
  for (int k = 0; k < 10; ++k) simulation.step(1e-5);
  EXPECT_EQ(simulation.search().updates, before);
}

// Neither a copy nor a run that is resumed knows how far grains have travelled. One that moves
// against the others moves relative to their mean by nearly twice that distance.
TEST(ContactList, IsRebuiltInTheSameStepIfTheTravelIsUnknown) {
  dem::Grains<2> grains;
  for (int i = 0; i < 20; ++i) {
    const Index added = dem::add_grain(grains, {0, 0.03 * i}, {.radius = 0.01, .density = 2500});
    grains[velocity][added] = {1, 0};
  }
  Simulation whole{grains, CountedList{}, dem::Contacts{law}, Leapfrog{}};
  auto copied = whole;
  for (int k = 0; k < 200; ++k) {
    if (k == 45) {
      whole.particles()[velocity][0] = {-1, 0};
      copied.particles()[velocity][0] = {-1, 0};
    }
    whole.step(1e-5);
    auto copy = copied;
    copy.step(1e-5);
    copied = copy;
    ASSERT_EQ(copied.search().updates, whole.search().updates) << k;
  }
  EXPECT_GT(whole.search().updates, 2u);
  EXPECT_LT(whole.search().updates, 10u);
}

// Positions move by a whole unit in the last place of a float, v Δt is half of it.
TEST(ContactList, IsRebuiltForDisplacementsAfterRounding) {
  constexpr float R = 1e-3f;
  constexpr float gap = 1.21e-5f;
  constexpr float v = 0.51f * 0x1p-23f / 1e-6f;
  dem::Grains<2, float> grains;
  dem::add_grain(grains, {1.5f, 1.5f}, {.radius = R, .density = 2500});
  dem::add_grain(grains, {1.5f + 2 * R + gap, 1.5f}, {.radius = R, .density = 2500});
  grains[velocity][0][0] = v;
  grains[velocity][1][0] = -v;
  Simulation simulation{grains, NeighbourList<2, float>{},
                        dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e3}}, Leapfrog{}};
  const auto& particles = std::as_const(simulation).particles();
  float overlap = 0;
  Index contacts = 0;
  for (int k = 0; k < 300 && contacts == 0; ++k) {
    const Vec<2, float> r = particles[position][0] - particles[position][1];
    overlap = 2 * R - r.norm();
    simulation.step(1e-6);
    contacts = std::as_const(simulation).interaction().size();
    if (contacts == 0) {
      EXPECT_LE(overlap, 1e-3f * R) << "step " << k;
    }
  }
  EXPECT_EQ(contacts, 1u);
}

TEST(ContactList, OfOtherGrainsIsRejectedInACheckpoint) {
  const Vec<2> zero(0, 0);
  dem::detail::SavedList<2, double> list;
  const auto expect_refusal = [&](const Buffer<Vec<2>>& since, const char* reason) {
    ReadsThese archive({{"is_known", true},
                        {"first", Buffer<Id>{0}},
                        {"second", Buffer<Id>{1}},
                        {"since", since},
                        {"margin", 0.1},
                        {"time", 0.0},
                        {"extent_lower", zero},
                        {"extent_upper", zero},
                        {"stable_time_step", 1.0},
                        {"added", Index(0)}});
    list.transfer(archive);
    EXPECT_TRUE(refuses([&] { list.check(two_grains<2>(0.01, {0, 0})); }, {reason}));
  };
  expect_refusal({zero, zero, zero}, "dem::Contacts: the list has 3 positions for 2 grains");
  // The second grain may have been added later, but then the list has no contact of it.
  expect_refusal({zero}, "has no position in the list");
}

}  // namespace
}  // namespace silt::test::contact_list_test
