// SPDX-License-Identifier: MIT
// What measures tell of particles that processes share, against the same in one process.
#include <silt/dem.hpp>
#include <silt/dem/measure/coordination.hpp>
#include <silt/dem/measure/stress.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/profiles.hpp>
#include <silt/measure/surface_height.hpp>
#include <silt/measure/tracks.hpp>
#include <silt/measure/wall_gauge.hpp>
#include <silt/measure/wall_load.hpp>
#include <silt/mpi.hpp>
#include <silt/mps.hpp>

#include "processes.hpp"
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::shared_measures_test {
namespace {

// f(add) calls add(name, value) for each.
using Values = std::vector<std::pair<std::string, double>>;
template <class F>
Values values_of(F&& f) {
  Values values;
  f([&](const std::string& name, double value) { values.emplace_back(name, value); });
  return values;
}
void expect_same(const Values& serial, const Values& shared, double tolerance) {
  ASSERT_EQ(serial.size(), shared.size());
  for (Index k = 0; k < serial.size(); ++k) {
    EXPECT_NEAR(serial[k].second, shared[k].second,
                tolerance * (std::abs(serial[k].second) + 1e-300))
        << serial[k].first;
    EXPECT_EQ(world->max(shared[k].second), world->min(shared[k].second)) << shared[k].first;
  }
}

template <class Sim>
Values measures_of_grains(Sim& heap) {
  return values_of([&](auto&& add) {
    const auto state = heap.state();
    const auto& grains = state.particles;
    const auto& contacts = state.interaction.template part<1>();
    add("kinetic", kinetic_energy(grains));
    add("rotational", rotational_energy(grains));
    add("potential", potential_energy(grains, {0, 0, -9.81}));
    add("momentum", momentum(grains)[2]);
    add("angular momentum", angular_momentum(grains, {0.1, 0.2, 0})[1]);
    add("elastic", contacts.elastic_energy(grains));
    const auto load = contacts.load_on(grains, 0, {0.1, 0.1, 0});
    add("force on the floor", load.force[2]);
    add("torque on the floor", load.torque[0]);
    const auto number = dem::coordination(grains, contacts);
    add("coordination", number.mean);
    add("mechanical coordination", number.mechanical);
    add("rattlers", number.rattlers);
    const auto stress = dem::stress(grains, contacts, {{0, 0, 0}, {0.3, 0.3, 0.1}});
    add("kinetic stress", stress.kinetic(2, 2));
    add("stress of contacts", stress.contact(2, 2));
    add("shear stress of contacts", stress.contact(0, 2));
    Profiles<3> profiles({.lower = 0, .upper = 0.3, .count = 4, .cross_section = 0.09});
    profiles(heap);
    add("solid fraction", profiles.rows()[1].solid_fraction.value);
    add("mean flow", profiles.rows()[1].velocity[2].value);
  });
}

TEST(SharedMeasures, OfGrainsAreThoseOfOneProcess) {
  dem::Grains<3> grains;
  int k = 0;
  for (const auto& x : lattice<3>({{0, 0, 0}, {0.3, 0.3, 0.36}}, 0.06)) {
    dem::add_grain(grains, x, {.radius = 0.028 - 0.003 * (k++ % 4), .density = 2500});
    grains[velocity][grains.size() - 1] = Vec<3>(0.1 * (k % 5), 0.07 * (k % 3), -1);
  }
  const auto heap_of = [](auto own) {
    const dem::CundallStrack law{.normal_stiffness = 1e5,
                                 .tangential_stiffness = 5e4,
                                 .restitution = 0.5,
                                 .friction_angle = 0.46};
    return Simulation{std::move(own), NeighbourList<3>{},
                      Forces{Gravity<3>{{0, 0, -9.81}},
                             dem::Contacts{law, dem::Plane<3>{.normal = {0, 0, 1}}}},
                      Leapfrog{}};
  };
  auto serial = heap_of(grains);
  auto shared = heap_of(mpi::distribute(grains, *world));
  expect_same(measures_of_grains(serial), measures_of_grains(shared), 1e-10);  // before any step
  for (int step = 0; step < 600; ++step) {
    serial.step();
    shared.step();
  }
  expect_same(measures_of_grains(serial), measures_of_grains(shared), 1e-10);
  serial.particles()[velocity][0] *= 0.5;
  const Id changed = serial.particles().id(0);
  auto& own = shared.particles();
  const Index i = own.index_of(changed);
  if (i < own.size()) own[velocity][i] *= 0.5;
  expect_same(measures_of_grains(serial), measures_of_grains(shared), 1e-10);
  // Without a step after the change, the snapshot knows what others have changed.
  const auto change = [](auto& all) {
    for (Index n = 0; n < all.size(); ++n) {
      all[mass][n] *= 1.01;
      all[position][n] += Vec<3>(0.004, 0, 0) * double(all.id(n) % 3);
    }
    all.remove_if([&](Index n) { return all.id(n) % 7 == 3; });
  };
  change(serial.particles());
  change(shared.particles());
  EXPECT_NEAR(kinetic_energy(serial.snapshot()), kinetic_energy(shared.snapshot()),
              1e-12 * kinetic_energy(serial.snapshot()));
}

TEST(SharedMeasures, CountWhatLeaves) {
  dem::Grains<2> grains;
  for (const auto& x : lattice<2>({{0, 0}, {1, 0.2}}, 0.02)) {
    dem::add_grain(grains, x, {.radius = 0.009, .density = 2500});
    grains[velocity][grains.size() - 1] = {std::fmod(x[1], 0.04) < 0.02 ? 5.0 : -5.0, 1};
  }
  grains.set_box({.lower = {-0.1, -1}, .upper = {1.1, 1}, .on_escape = OnEscape::remove});
  const auto cloud_of = [](auto own) {
    return Simulation{std::move(own), UniformGrid<2>{},
                      dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
  };
  auto serial = cloud_of(grains);
  auto shared = cloud_of(mpi::distribute(grains, *world));
  const dem::Outflow outflow(Box<2>{.lower = {0.3, 0.15}, .upper = {0.7, 0.4}});
  auto removed = outflow, removed_by_all = outflow;
  // Measured in the step in which some leave, too.
  const auto measures_into = [](std::vector<double>& results) {
    return [&results](const auto& simulation) {
      const auto& own = simulation.particles();
      results.push_back(kinetic_energy(own));
      results.push_back(kinetic_energy(simulation.snapshot()));
      results.push_back(dem::coordination(own, simulation.interaction()).mean);
    };
  };
  std::vector<double> results, results_of_all;
  serial.run({.until = 0.05, .output_every = 1e-4}, removed, measures_into(results));
  shared.run({.until = 0.05, .output_every = 1e-4}, removed_by_all, measures_into(results_of_all));
  ASSERT_GT(results.size(), 100u);
  ASSERT_EQ(results.size(), results_of_all.size());
  for (Index k = 0; k < results.size(); ++k) {
    EXPECT_NEAR(results[k], results_of_all[k], 1e-10 * std::abs(results[k]));
  }
  EXPECT_GT(serial.particles_lost(), 10u);
  EXPECT_EQ(serial.particles_lost(), shared.particles_lost());
  EXPECT_GT(removed.number(), 10u);
  EXPECT_EQ(removed.number(), removed_by_all.number());
  EXPECT_NEAR(removed.mass(), removed_by_all.mass(), 1e-12 * removed.mass());
}

TEST(SharedMeasures, OfFlowsAreThoseOfOneProcess) {
  constexpr double l0 = 0.05;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 0.8, .height = 1.2}, .spacing = l0});
  const mps::FlowSettings<2, mps::Recommended> settings{
      .spacing = l0, .density = 1000, .speed_scale = 2.8, .walls = tank.walls};
  const SolveSettings exact{.tolerance = 1e-12};
  Simulation serial{tank.particles, UniformGrid<2>{},
                    mps::Flow<mps::Recommended>{settings, mps::PressureSolver<2>{exact}},
                    SemiImplicit<>{}};
  Simulation shared{mpi::distribute(tank.particles, *world), UniformGrid<2>{},
                    mpi::Flow<mps::Recommended>{settings, mpi::PressureSolver<2>{exact}},
                    SemiImplicit<>{}};
  const auto measures_of = [&](auto& dam) {
    return values_of([&](auto&& add) {
      const auto& water = dam.particles();
      const auto is_fluid = [&water](Index i) { return water[mps::kind][i] == mps::Kind::fluid; };
      const auto front = find_front(water, dam.search(), {.spacing = l0}, is_fluid);
      add("front", front.x);
      add("height", front.height);
      add("pressure at a point",
          Probe<2>{.point = {0.2, 0.2}, .spacing = l0}.read(water, mps::pressure, is_fluid).value_or(-1));
      add("pressure at a wall",
          WallGauge<2>{.point = {0, 0.1}, .normal = {1, 0}, .spacing = l0}.read(water, mps::pressure));
      const WallGauge<2> gauge{.point = {0, 0.1}, .spacing = l0};
      add("pressure in sight", gauge.read(dam, mps::pressure));
      add("pressure by the load", gauge.read_load(dam));
      add("level", SurfaceHeight<2>{.point = {0.3, 0}, .spacing = l0}.read(dam));
      for (const double number : track<2>({3}, velocity).row(dam)) add("track", number);
      const auto load = silt::WallLoad<2>(tank.walls.faces<2>()).read(dam);
      add("load on all walls", load[1]);
      add("load of both sides", load[0]);
      add("kinetic", dam.interaction().energy().kinetic);
    });
  };
  for (int step = 0; step < 120; ++step) {
    serial.step();
    shared.step(serial.last_time_step());
    if (step % 30 == 29) expect_same(measures_of(serial), measures_of(shared), 1e-4);
  }
}

// Those that leave behind them are numbered together.
TEST(SharedMeasures, OfPartsAreThoseOfAllParticles) {
  dem::Grains<2> all, part;
  int k = 0;
  for (const auto& x : lattice<2>({{0, 0}, {1, 0.5}}, 0.05)) {
    dem::add_grain(all, x, {.radius = 0.024, .density = 2500});
    all[velocity][all.size() - 1] = {0.1 * (k % 7), -0.1 * (k % 3)};
    const int first = int(k * world->size() / 200);
    if (first == world->rank()) {
      dem::add_grain(part, x, {.radius = 0.024, .density = 2500});
      part[velocity][part.size() - 1] = all[velocity][all.size() - 1];
    }
    ++k;
  }
  const auto bed_of = [](auto own) {
    return Simulation{std::move(own), UniformGrid<2>{},
                      dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
  };
  auto serial = bed_of(all);
  auto shared = bed_of(mpi::distribute_parts(part, *world));
  for (int step = 0; step < 300; ++step) {
    serial.step();
    shared.step();
  }
  const auto& own = shared.particles();
  EXPECT_EQ(world->sum(std::uint64_t{own.size()}), all.size());
  for (Index i = 0; i < own.size(); ++i) {
    const Index j = serial.particles().index_of(own.id(i));
    ASSERT_NE(j, no_index);
    ASSERT_EQ(serial.particles()[position][j], std::as_const(own)[position][i]);
  }
  if (world->size() == 1) return;
  auto other = part;
  if (!world->is_first()) other.set_box({.lower = {-1, -1}, .upper = {2, 2}});
  EXPECT_THROW(mpi::distribute_parts(other, *world), Error);
}

}  // namespace
}  // namespace silt::test::shared_measures_test
