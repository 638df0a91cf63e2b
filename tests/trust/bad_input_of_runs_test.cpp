// SPDX-License-Identifier: MIT
// Runs, boxes, searches, damping, measurements and files accept or refuse wrong and extreme values,
// and empty texts, as these tables say.
#include <silt/io/checkpoints.hpp>
#include <silt/io/csv.hpp>
#include <silt/io/particle_csv.hpp>
#include <silt/io/stl.hpp>
#include <silt/io/vtk.hpp>
#include <silt/measure/probe.hpp>
#include <silt/measure/profiles.hpp>

#include "support/bad_input_table.hpp"
#include "support/check.hpp"
#include "support/file_test.hpp"
#include "support/grains.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::test::bad_input_of_runs_test {
namespace {

constexpr std::int64_t largest_int = std::numeric_limits<int>::max();

// Without forces, so that its position is finite after any time.
auto flying_grain() {
  return Simulation{one_grain<2>({0, 0}, {1, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}},
                    Leapfrog{GlobalDamping{}}};
}

// What is refused changes nothing.
void use_run(const Run& run) {
  auto sim = flying_grain();
  change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.run(run); });
  EXPECT_GE(sim.time(), run.until * (1 - 1e-12));
  EXPECT_TRUE(is_finite(sim.particles()[position][0]));
}

TEST(BadInput, OfRunsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"Run: until", [](double x) { use_run({.until = x, .time_step = 0.1}); },
       accepts::zero | accepts::minus_one | accepts::tiny},
      {"Run: output_every",
       [](double x) { use_run({.until = 1, .output_every = x, .time_step = 0.1}); },
       accepts::zero | accepts::huge},
      {"Run: time_step", [](double x) { use_run({.until = 1, .time_step = x}); }, accepts::huge},
      {"Simulation: time_step",
       [](double x) {
         auto sim = flying_grain();
         change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.step(x); });
         EXPECT_EQ(sim.time(), x);
         EXPECT_EQ(sim.steps(), 1u);
       },
       accepts::positive},
      {"Gravity: acceleration", [](double x) { Gravity<2>({x, 0}); }, accepts::finite},
      {"GlobalDamping: alpha",
       [](double x) {
         Simulation sim{one_grain<2>({0, 0}, {1, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}},
                        Leapfrog{GlobalDamping{.alpha = x}}};
         change_or_keep([&] { return state_of(sim.particles()); }, [&] { sim.step(0.1); });
       },
       accepts::zero | accepts::tiny}});
  check_parameters(std::vector<IntegerParameter>{{"use_threads: number",
                                                  [](std::int64_t n) {
                                                    with_threads(threads(), [&] {
                                                      use_threads(static_cast<int>(n));
                                                      for_each(100'000, [](Index) {});
                                                    });
                                                  },
                                                  accepts::nothing, largest_int}});
}

void use_box(const Box<2>& box) {
  Particles<2, double> particles(cube<2, double>(0, 1));
  const auto lower_and_upper = [&] {
    const auto& now = particles.box();
    return std::vector{now.lower[0], now.lower[1], now.upper[0], now.upper[1]};
  };
  change_or_keep(lower_and_upper, [&] { particles.set_box(box); });
  const auto wrapped = particles.box().wrap({0.25, 0.25});
  EXPECT_TRUE(is_finite(wrapped));
}

TEST(BadInput, OfBoxesIsRefused) {
  constexpr unsigned below_one = accepts::zero | accepts::minus_one | accepts::tiny;
  check_parameters(std::vector<NumberParameter>{
      {"Box: lower", [](double x) { use_box({.lower = {0, x}, .upper = {1, 1}}); },
       below_one | accepts::minus_infinite},
      {"Box: upper", [](double x) { use_box({.lower = {0, 0}, .upper = {x, 1}}); },
       accepts::positive | accepts::infinite},
      {"Box: lower",
       [](double x) { use_box({.lower = {0, x}, .upper = {1, 1}, .periodic = {false, true}}); },
       below_one},
      {"Box: upper",
       [](double x) { use_box({.lower = {0, 0}, .upper = {x, 1}, .periodic = {true, false}}); },
       accepts::positive},
      {"lattice: spacing", [](double x) { lattice<2>({.lower = {0, 0}, .upper = {1, 1}}, x); },
       accepts::nothing},
      {"lower", [](double x) { lattice<2>({.lower = {x, 0}, .upper = {1, 1}}, 0.5); }, below_one},
      {"upper", [](double x) { lattice<2>({.lower = {0, 0}, .upper = {x, 1}}, 0.5); },
       accepts::nothing}});
}

// Finds pairs of grains.
template <class S>
void use_search(S search) {
  auto grains = two_grains<2>(-1e-4, Vec<2>(0, 0));
  if (!(search.radius() > 0)) search.set_radius(0.02);
  change_or_keep([&] { return state_of(grains); }, [&] { search.update(grains); });
  Index pairs = 0;
  search.for_each_pair([&](Index, Index, const auto&, double) { ++pairs; });
  EXPECT_EQ(pairs, search.radius() < 0.01 ? 0u : 1u);
}

void use_list(NeighbourList<2>::Settings settings) { use_search(NeighbourList<2>(settings)); }

TEST(BadInput, OfSearchesIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"UniformGrid: radius", [](double x) { use_search(UniformGrid<2>({.radius = x})); },
       accepts::not_negative},
      {"BruteForce: radius", [](double x) { use_search(BruteForce<2>({.radius = x})); },
       accepts::not_negative},
      {"LevelGrid: radius", [](double x) { use_search(LevelGrid<2>({.radius = x})); },
       accepts::zero | accepts::huge},
      {"NeighbourList: radius", [](double x) { use_list({.radius = x}); }, accepts::not_negative},
      {"NeighbourList: skin_fraction",
       [](double x) { use_list({.radius = 0.02, .skin_fraction = x}); }, accepts::not_negative},
      {"UniformGrid: radius", [](double x) { UniformGrid<2>{}.set_radius(x); }, accepts::positive},
      {"radius",
       [](double x) {
         Simulation{two_grains<2>(0, Vec<2>(0, 0)), UniformGrid<2>({.radius = x}),
                    dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
       },
       accepts::huge | accepts::zero}});
}

// A profile of a bed of one grain.
void use_slices(const Slices& slices) {
  Profiles<2> profiles(slices);
  profiles.add(one_grain<2>({0.05, 0.05}, {1, 0}));
  profiles.add(one_grain<2>({0.05, 0.05}, {1, 0}));
  for (const auto& row : profiles.rows()) {
    EXPECT_TRUE(is_finite(row.height));
    EXPECT_TRUE(is_finite(row.solid_fraction.value));
  }
}

void use_probe(const Probe<2>& probe) {
  const auto grains = one_grain<2>({0, 0}, {1, 0});
  const auto value = probe.read(grains, mass, [](Index) { return true; });
  EXPECT_EQ(value.value_or(grains[mass][0]), grains[mass][0]);
}

TEST(BadInput, OfMeasurementsIsRefused) {
  const Slices usual{.lower = 0, .upper = 1, .count = 4, .cross_section = 1};
  const auto with = [&](auto member) {
    return [=](auto x) {
      Slices slices = usual;
      slices.*member = static_cast<std::remove_reference_t<decltype(slices.*member)>>(x);
      use_slices(slices);
    };
  };
  check_parameters(std::vector<NumberParameter>{
      {"Slices: lower", with(&Slices::lower), accepts::zero | accepts::minus_one | accepts::tiny},
      {"Slices: upper", with(&Slices::upper), accepts::huge},
      {"Slices: cross_section", with(&Slices::cross_section), accepts::huge},
      {"Probe: spacing", [](double x) { use_probe({.spacing = x}); }, accepts::positive},
      {"Probe: point", [](double x) { use_probe({.point = {x, 0}, .spacing = 1}); },
       accepts::finite},
      {"lower",
       [](double x) {
         Simulation sim{two_grains<2>(-1e-4, Vec<2>(0, 0)), UniformGrid<2>{},
                        dem::Contacts{dem::CundallStrack{.normal_stiffness = 1e5}}, Leapfrog{}};
         sim.step();
         const auto state = sim.state();
         const auto stress =
             dem::stress(state.particles, state.interaction, {.lower = {x, -1}, .upper = {1, 1}});
         EXPECT_TRUE(is_finite(stress.contact(0, 0)));
       },
       accepts::zero | accepts::minus_one | accepts::tiny}});
  check_parameters(std::vector<IntegerParameter>{
      {"Slices: count", with(&Slices::count), accepts::nothing},
      {"BlockSums: number of values", [](std::int64_t n) { BlockSums(static_cast<Index>(n)); },
       accepts::nothing}});
}

TEST(BadInput, OfIntervalsOfCheckpointsIsRefused) {
  const Folder folder;
  check_parameters(std::vector<NumberParameter>{
      {"Checkpoints: every", [&](double x) { Checkpoints{folder.path / "run.silt", {.every = x}}; },
       accepts::not_negative | accepts::infinite}});
}

TEST(BadInput, WithoutATextIsRefused) {
  const Folder folder;
  const auto table = folder.path / "table.csv";
  std::ofstream(table) << "x\n1\n";
  const auto grains = one_grain<2>({0, 0}, {0, 0});
  auto sim = flying_grain();
  const struct {
    std::string name;
    std::function<void(const std::string&)> use;
  } parameters[] = {
      {"VtkSeries", [](const std::string& path) { VtkSeries{path}; }},
      {"CsvFile", [](const std::string& path) { CsvFile(path, {"t"}); }},
      {"CsvFile: column", [&](const std::string& name) { CsvFile(table, {"t", name}); }},
      {"CsvTable: column", [&](const std::string& name) { read_csv(table)[name]; }},
      {"read_csv", [](const std::string& path) { read_csv(path); }},
      {"read_stl", [](const std::string& path) { read_stl(path); }},
      {"write_stl", [](const std::string& path) { write_stl<double>(path, {}); }},
      {"write_csv", [&](const std::string& path) { write_csv(path, grains); }},
      {"write_checkpoint", [&](const std::string& path) { write_checkpoint(path, sim); }},
      {"read_checkpoint", [&](const std::string& path) { read_checkpoint(path, sim); }},
      {"Checkpoints", [&](const std::string& path) { Checkpoints{path, {}}; }}};
  for (const auto& [name, use] : parameters) {
    check_value(name, {"\"\""}, false, [&use = use] { use(""); });
  }
}

}  // namespace
}  // namespace silt::test::bad_input_of_runs_test
