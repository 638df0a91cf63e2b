// SPDX-License-Identifier: MIT
// Small runs against closed forms: a bouncing grain, two stacked grains, a column, the broken
// tower.
#include "support/check.hpp"
#include "support/grains.hpp"

#include <silt/io/csv.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace silt::test {
namespace {

constexpr double g = 9.81;

// Garg et al. (2012), free fall and bounces of a sphere: R 0.1 m, ρ 2600 kg/m³, centre at 0.5 m.
TEST(BouncingGrain, RisesToTheApexesOfAHardSphere) {
  const double R = 0.1;
  const double e = 0.8;
  auto grains = one_grain<3>({0, 0, 0.5}, {0, 0, 0}, {.radius = R, .density = 2600});
  const dem::CundallStrack law{.normal_stiffness = 5e6, .restitution = e};
  Simulation sim{grains, UniformGrid<3>{}, Forces{Gravity<3>{{0, 0, -g}}, dem::Contacts{law, dem::Plane<3>{}}},
                 Leapfrog{}};
  std::vector<double> apexes;
  double touches_at = 0;
  double v_before = 0;
  double top = 0;
  while (apexes.size() < 3) {
    sim.step();
    const double v = sim.particles()[velocity][0][2];
    const double z = sim.particles()[position][0][2];
    if (touches_at == 0 && z < R) {
      touches_at = sim.time();
      EXPECT_NEAR(v_before, -std::sqrt(2 * g * 0.4), 0.01);
    }
    top = v > 0 ? std::max(top, z) : top;
    if (v_before > 0 && v <= 0) {
      apexes.push_back(top);
      top = 0;
    }
    v_before = v;
  }
  EXPECT_NEAR(touches_at, std::sqrt(2 * 0.4 / g), 1e-3);
  for (std::size_t n = 0; n < apexes.size(); ++n) {
    EXPECT_NEAR(apexes[n], R + 0.4 * std::pow(e, 2.0 * double(n + 1)), 0.003) << n;
  }
}

// Two spheres pressed between a floor and a lid; the table says where from.
TEST(StackedGrains, FollowTheExactMotionBetweenTwoWalls) {
  const CsvTable table = read_csv(SILT_TESTS_DIR "/reference/stacked_particles_compressed.csv");
  for (const double e : {1.0, 0.9, 0.7, 0.5}) {
    dem::Grains<3> grains;
    dem::add_grain(grains, {0, 0, 0.45e-3}, {.radius = 0.5e-3, .density = 20000});
    dem::add_grain(grains, {0, 0, 1.35e-3}, {.radius = 0.5e-3, .density = 10000});
    const dem::CundallStrack law{.normal_stiffness = 1000, .restitution = e};
    const dem::Plane<3> floor{};
    const dem::Plane<3> lid{.point = {0, 0, 1.8e-3}, .normal = {0, 0, -1}};
    Simulation sim{grains, UniformGrid<3>{}, Forces{Gravity<3>{{0, 0, -g}}, dem::Contacts{law, floor, lid}},
                   Leapfrog{}};
    for (Index row = 0; row < table.rows(); ++row) {
      if (table["e"][row] != e) continue;
      sim.run({.until = table["t_s"][row], .time_step = 2e-7});
      EXPECT_NEAR(sim.particles()[position][0][2] * 1e3, table["y1_mm"][row], 3e-4) << e << " " << sim.time();
      EXPECT_NEAR(sim.particles()[position][1][2] * 1e3, table["y2_mm"][row], 3e-4) << e << " " << sim.time();
    }
  }
}

// --- the tower -----------------------------------------------------------------------------------

constexpr double R = 0.02;

struct Tower {
  int wide = 5;
  int high = 10;
  double offset = 0;     // of the trigger, in radii
  bool trigger = true;
  double alpha = 0;
  double friction = 0;
  double restitution = 0.5;
  double drop = 2;       // gap between tower and trigger, in radii
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
  if (tower.trigger) {
    dem::add_grain(grains, {tower.offset * R, (2 * tower.high + tower.drop + 1) * R}, grain);
  }
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
        if (j == nowhere) sum += f[1];
      });
  return sum;
}

TEST(BrokenTower, AColumnAtRestCarriesItsWeightContactByContact) {
  const int n = 10;
  auto sim = make({.wide = 1, .high = n, .trigger = false, .alpha = 40});
  sim.run({.until = 1.5});
  const double weight = sim.particles()[mass][0] * g;
  EXPECT_NEAR(floor_force(sim), n * weight, 0.01 * n * weight);
  Index contacts = 0;
  sim.interaction().part<1>().for_each_contact(
      sim.particles(), [&](Index i, Index j, const auto& contact, const auto&) {
        // The contact below grain i (its own with the floor, else the one with the grain above it).
        const double carried = j == nowhere ? n : n - 1.0 - double(std::min(i, j));
        EXPECT_NEAR(contact.overlap, carried * weight / stiffness, 0.01 * carried * weight / stiffness);
        ++contacts;
      });
  EXPECT_EQ(contacts, Index(n));
}

TEST(BrokenTower, FloorCarriesTheWholeWeightBeforeTheTriggerLands) {
  auto sim = make({.alpha = 40, .drop = 400});
  // The trigger falls 8 m, with this damping for many seconds.
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
  // Round-off grows with every collision: first it stays round-off, later a small fraction of R.
  sim.run({.until = 0.1});
  EXPECT_LT(asymmetry(), 1e-12 * R * 100);
  sim.run({.until = 0.2});
  EXPECT_LT(asymmetry(), 1e-6 * R);
}

TEST(BrokenTower, TriggersAtPlusAndMinusXMakeMirrorImages) {
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
  EXPECT_GT(moved, 1e-3 * R) << "the tower does break";
}

TEST(BrokenTower, OnAFrictionlessFloorKeepsItsMomentumInX) {
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
      auto springs = s.interaction();  // asked anew where the grains are now
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
  for (const auto& v : sim.particles()[velocity]) EXPECT_LT(std::abs(v[0]), 1.5 * std::sqrt(2 * g * h));
}

}  // namespace
}  // namespace silt::test
