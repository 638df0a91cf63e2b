// SPDX-License-Identifier: MIT
// The list of contacts is rebuilt when it has to be, and only from an updated search.
#include <silt/dem.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace silt::test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e4, .restitution = 0.5};

// Has access to the masses in every step, although it does not change them.
struct ReadsMasses {
  template <class P>
  double reach(const P&) const {
    return 0;
  }
  template <class P>
  bool needs_search(const P&) const {
    return false;
  }
  template <class P, class S>
  void accelerate(P& particles, const S&, double) const {
    static_cast<void>(particles[mass]);
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
  EXPECT_EQ(most_contacts(Forces{Gravity<2>{{0, 0}}, dem::Contacts{law}}), 1u);
  EXPECT_EQ(most_contacts(Forces{ReadsMasses{}, dem::Contacts{law}}), 1u);
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

}  // namespace
}  // namespace silt::test
