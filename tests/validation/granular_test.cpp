// SPDX-License-Identifier: MIT
// The broken tower. Exact results are in validation/dem_reference.
// Only with --all: a comparison of whole beds.
#include "support/check.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <cmath>

namespace silt::test::granular_test {
namespace {

constexpr double g = 9.81;

constexpr double R = 0.02;

struct Tower {
  int wide = 5;
  int high = 10;
  double offset = 0;  // of the trigger, in radii
  double alpha = 0;
  double friction = 0;
  double restitution = 0.5;
  double drop = 2;  // gap between tower and trigger, in radii
};

constexpr double stiffness = 1e6;

auto make(const Tower& tower) {
  dem::Grains<2> grains;
  const dem::Grain grain{.radius = R, .density = 2500};
  for (int row = 0; row < tower.high; ++row) {
    for (int k = 0; k < tower.wide; ++k) {
      dem::add_grain(grains, {(k - (tower.wide - 1) / 2.0) * 2 * R, (2 * row + 1) * R}, grain);
    }
  }
  dem::add_grain(grains, {tower.offset * R, (2 * tower.high + tower.drop + 1) * R}, grain);
  const dem::CundallStrack law{.normal_stiffness = stiffness,
                               .tangential_stiffness = tower.friction > 0 ? stiffness / 2 : 0,
                               .restitution = tower.restitution,
                               .friction_angle = tower.friction};
  return Simulation{grains, NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -g}}, dem::Contacts{law, dem::Plane<2>{}}},
                    Leapfrog{GlobalDamping{.alpha = tower.alpha}}};
}

template <class Sim>
double floor_force(const Sim& sim) {
  double sum = 0;
  sim.interaction().template part<1>().for_each_contact(
      sim.particles(), [&](Index, Index j, const auto&, const Vec<2>& f) {
        if (j == no_index) sum += f[1];
      });
  return sum;
}

TEST(BrokenTower, FloorCarriesTheWholeWeightBeforeTheTriggerLands) {
  auto sim = make({.alpha = 40, .drop = 400});
  // The trigger falls by 8 m, which takes many seconds with this damping.
  sim.run({.until = 1.5});
  const double weight = 50 * sim.particles()[mass][0] * g;
  EXPECT_NEAR(floor_force(sim), weight, 0.01 * weight);
}

TEST(BrokenTower, KeepsItsMirrorSymmetryWhileRoundOffIsSmall) {
  auto sim = make({.friction = 0.4});
  const auto asymmetry = [&] {
    const auto x = sim.particles()[position];
    double most = 0;
    for (Index row = 0; row < 10; ++row) {
      for (Index k = 0; k < 5; ++k) {
        const auto& a = x[5 * row + k];
        const auto& b = x[5 * row + 4 - k];
        most = std::max({most, std::abs(a[0] + b[0]), std::abs(a[1] - b[1])});
      }
    }
    return std::max(most, std::abs(x[50][0]));
  };
  // Round-off grows with every collision: at first it remains round-off, later a small fraction of
  // R.
  sim.run({.until = 0.1});
  EXPECT_LT(asymmetry(), 1e-12 * R * 100);
  sim.run({.until = 0.2});
  EXPECT_LT(asymmetry(), 1e-6 * R);
}

TEST(BrokenTower, TriggersAtPlusAndMinusXGiveMirrorImages) {
  auto right = make({.offset = 0.25, .friction = 0.4});
  auto left = make({.offset = -0.25, .friction = 0.4});
  right.run({.until = 0.2});
  left.run({.until = 0.2});
  const auto a = right.particles()[position];
  const auto b = left.particles()[position];
  double moved = 0;
  for (Index row = 0; row < 10; ++row) {
    for (Index k = 0; k < 5; ++k) {
      const auto& here = a[5 * row + k];
      const auto& there = b[5 * row + 4 - k];
      EXPECT_NEAR(here[0], -there[0], 1e-6 * R);
      EXPECT_NEAR(here[1], there[1], 1e-6 * R);
      moved = std::max(moved, std::abs(here[0] - (double(k) - 2) * 2 * R));
    }
  }
  EXPECT_GT(moved, 1e-3 * R) << "the tower breaks";
}

TEST(BrokenTower, OnAFrictionlessFloorConservesItsMomentumInX) {
  auto sim = make({.offset = 0.25});
  sim.run({.until = 0.6});
  double scale = 0;
  for (Index i = 0; i < sim.particles().size(); ++i) {
    scale += sim.particles()[mass][i] * sim.particles()[velocity][i].norm();
  }
  EXPECT_GT(scale, 10);
  EXPECT_LT(std::abs(momentum(sim.particles())[0]), 1e-12 * scale);
}

TEST(BrokenTower, NeverGainsEnergy) {
  for (const double alpha : {0.0, 0.5}) {
    auto sim = make({.offset = 0.25, .alpha = alpha, .friction = 0.4});
    const auto energy = [](const auto& s) {
      auto grains = s.snapshot();
      auto springs = s.interaction();  // evaluated again at the current positions
      auto search = s.search();
      search.update(grains);
      springs.accelerate(grains, search, 1e-12);
      double sum = energy_of_motion(grains) + springs.template part<1>().elastic_energy(grains);
      for (Index i = 0; i < grains.size(); ++i) sum += grains[mass][i] * g * grains[position][i][1];
      return sum;
    };
    const double at_start = energy(sim);
    double last = at_start;
    sim.run({.until = 0.8, .output_every = 0.01}, [&](const auto& s) {
      const double now = energy(s);
      EXPECT_LE(now, last + 1e-4 * at_start) << "alpha " << alpha << ", t = " << s.time();
      last = now;
    });
    EXPECT_LT(last, 0.8 * at_start);
  }
}

TEST(BrokenTower, SpreadsNoFasterThanItsHeightAllows) {
  auto sim = make({.offset = 0.25});
  const double h = 20 * R + 3 * R;
  sim.run({.until = 0.6});
  for (const auto& v : sim.particles()[velocity])
    EXPECT_LT(std::abs(v[0]), 1.5 * std::sqrt(2 * g * h));
}

}  // namespace
}  // namespace silt::test::granular_test
