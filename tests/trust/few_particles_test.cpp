// SPDX-License-Identifier: MIT
// Every function works for no particles and for a single one: its results are finite and those that
// follow from their number.
// Only with --all: every function; a run without particles is in mps/flow_test.cpp and dem/contact_list_test.cpp.
#include <silt/dem.hpp>
#include <silt/dem/setup/grain_table.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/energy.hpp>
#include <silt/measure/front.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/profiles.hpp>

#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace silt::test::few_particles_test {
namespace {

auto simulation_of(Index number) {
  const std::vector<Vec<2>> points(number, Vec<2>(0.5, 0.5));
  return Simulation{
      dem::make_grains(points, pebble), NeighbourList<2>{},
      Forces{
          Gravity<2>{{0, -10}},
          dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}, dem::Plane<2>{}},
          dem::Bonds<2>({.normal_stiffness = 1e6, .tangential_stiffness = 1e6, .radius_share = 1})},
      Leapfrog{}};
}

// f(n) for n = 0 and 1.
template <class F>
void for_none_and_one(F&& f) {
  for (const Index n : {Index(0), Index(1)}) {
    SCOPED_TRACE(std::to_string(n) + " grains");
    f(n);
  }
}

TEST(FewGrains, AreAdvancedAndMeasured) {
  for_none_and_one([](Index n) {
    const double m = double(n) * pebble.density * dem::volume_of<2>(pebble.radius);
    auto sim = simulation_of(n);
    dem::EnergyLedger ledger{sim};
    Profiles<2> profiles({.upper = 1, .count = 3, .cross_section = 1});
    const silt::Run run{.until = 0.05, .output_every = 0.01, .time_step = 1e-3};
    EXPECT_TRUE(sim.run(run, profiles, ledger));
    EXPECT_EQ(sim.steps(), 50u);
    EXPECT_EQ(sim.particles().size(), n);
    const auto& [grains, interaction] = sim.state();
    EXPECT_NEAR(momentum(grains)[1], -0.5 * m, 1e-12);
    EXPECT_NEAR(kinetic_energy(grains), 0.125 * m, 1e-12);
    EXPECT_EQ(rotational_energy(grains), 0);
    EXPECT_NEAR(potential_energy(grains, {0, -10}), (5 - 0.125) * m, 1e-12);
    EXPECT_NEAR(angular_momentum(grains, {0, 0}), -0.25 * m, 1e-12);
    EXPECT_NEAR(dem::rms_speed(grains), n == 0 ? 0 : 0.5, 1e-12);
    EXPECT_TRUE(is_finite(ledger.energies().sum()));
    EXPECT_NEAR(ledger.imbalance(), 0, 1e-12);
    EXPECT_EQ(profiles.samples(), 6u);
    for (const auto& row : profiles.rows()) {
      EXPECT_TRUE(is_finite(row.solid_fraction.value));
      EXPECT_EQ(is_finite(row.temperature.value), row.solid_fraction.value > 0);
    }
  });
}

TEST(FewGrains, HaveNoContacts) {
  for_none_and_one([](Index n) {
    auto sim = simulation_of(n);
    for (int step = 0; step < 2; ++step) {
      const auto& grains = sim.particles();
      const auto& contacts = sim.interaction().part<1>();
      EXPECT_EQ(contacts.size(), 0u);
      contacts.for_each_contact(grains, [](Index, Index, const auto&, const auto&) { FAIL(); });
      contacts.for_each_wall_contact(grains, [](const auto&) { FAIL(); });
      EXPECT_EQ(contacts.load_on(grains, 0).force, Vec<2>(0, 0));
      EXPECT_EQ(contacts.elastic_energy(grains), 0);
      EXPECT_EQ(contacts.history(grains).size(), 0u);
      const auto of = dem::coordination(grains, contacts);
      EXPECT_EQ(of.mean, 0);
      EXPECT_EQ(of.mechanical, 0);
      EXPECT_EQ(of.rattlers, double(n));
      const auto stress = dem::stress(grains, contacts, cube<2, double>(0, 1));
      EXPECT_EQ(stress.sum().norm(), 0);
      EXPECT_EQ(stress.pressure(), 0);
      sim.step(1e-3);
    }
  });
}

TEST(FewGrains, HaveNoBonds) {
  for_none_and_one([](Index n) {
    auto sim = simulation_of(n);
    auto bonds = sim.interaction().part<2>();
    EXPECT_EQ(bonds.bond_all_touching(sim.particles(), UniformGrid<2>{}), 0u);
    EXPECT_TRUE(bonds.bonds().empty());
    EXPECT_EQ(bonds.elastic_energy(sim.particles()), 0);
    EXPECT_TRUE(refuses([&] { bonds.bond(sim.particles(), {0, 7}); }, {"dem::Bonds", "7"}));
  });
}

TEST(FewGrains, HaveATimeStepIfThereAreAny) {
  for_none_and_one([](Index n) {
    auto sim = simulation_of(n);
    if (n == 0) {
      EXPECT_TRUE(refuses([&] { sim.step(); }, {"there are no particles", "pass one"}));
    } else {
      sim.step();
      EXPECT_TRUE(is_finite(sim.last_time_step()));
    }
  });
}

TEST(FewGrains, AreMeasuredAtPoints) {
  for_none_and_one([](Index n) {
    auto sim = simulation_of(n);
    const auto all = [](Index) { return true; };
    const Probe<2> probe{.point = {0.5, 0.5}, .spacing = 0.1};
    EXPECT_EQ(probe.read(sim.particles(), mass, all).has_value(), n == 1);
    UniformGrid<2> search({.radius = 0.3});
    auto grains = sim.particles();
    search.update(grains);
    const auto front = find_front(grains, search, {.spacing = 0.1, .min_neighbours = 0}, all);
    EXPECT_EQ(front.x, 0);
    EXPECT_EQ(front.height, 0);
  });
}

TEST(FewGrains, AreWrittenAndRead) {
  for_none_and_one([](Index n) {
    const Folder folder;
    auto sim = simulation_of(n);
    sim.step(1e-3);
    const auto state = state_of(sim.particles());
    VtkSeries frames{folder.path / "frames"};
    frames(sim);
    EXPECT_EQ(frames.frames(), 1u);
    write_checkpoint(folder.path / "run.silt", sim);
    auto resumed = simulation_of(n);
    read_checkpoint(folder.path / "run.silt", resumed);
    EXPECT_TRUE(state_of(resumed.particles()) == state);
    resumed.step(1e-3);
    sim.step(1e-3);
    EXPECT_TRUE(state_of(resumed.particles()) == state_of(sim.particles()));
    write_csv(folder.path / "grains.csv", sim.particles());
    const auto read = dem::grains_from<2>(read_csv(folder.path / "grains.csv"));
    EXPECT_EQ(read.size(), n);
  });
}

TEST(FewGrains, ArePlacedAndRemoved) {
  for_none_and_one([](Index n) {
    dem::Grains<2> grains;
    const dem::Blend<dem::EqualSizes> blend{.sizes = {.value = 0.01}, .density = 1};
    const auto box = cube<2, double>(0, 1);
    dem::scatter(grains, blend, box, {.number = n});
    EXPECT_EQ(grains.size(), n);
    auto sim = simulation_of(0);
    dem::Inflow<Box<2>, dem::EqualSizes> rain{box, blend, {.number = n}};
    EXPECT_TRUE(sim.run({.until = 0.01, .time_step = 1e-3}, rain));
    EXPECT_TRUE(rain.is_done());
    EXPECT_EQ(sim.particles().size(), n);
    dem::Outflow<Box<2>> drain{box};
    EXPECT_TRUE(sim.run({.until = 0.02, .time_step = 1e-3}, drain));
    EXPECT_EQ(drain.number(), n);
    EXPECT_EQ(sim.particles().size(), 0u);
    EXPECT_NEAR(dem::settle(sim, {.speed = 1e-3, .check_every = 0.01, .max_time = 1}), 0.01, 2e-3);
  });
}

}  // namespace
}  // namespace silt::test::few_particles_test
