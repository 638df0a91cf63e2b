// SPDX-License-Identifier: MIT
// Distributions of sizes, placements, inflows, outflows, settling and tables of grains accept or
// refuse wrong and extreme values as these tables say; grains that are refused are not added.
#include <silt/dem/setup/grain_table.hpp>
#include <silt/io/csv.hpp>

#include "support/bad_input_table.hpp"
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::bad_input_of_placements_test {
namespace {

// Draws a radius, which has to be within the given limits.
template <class Sizes>
void use(const Sizes& sizes) {
  sizes.check();
  Random random{.seed = 1, .id = 1};
  for (int k = 0; k < 10; ++k) {
    const double R = sizes.radius(random);
    EXPECT_GT(R, 0);
    EXPECT_LE(R, sizes.largest());
  }
}
void use_uniform(const dem::UniformSizes& sizes) { use(sizes); }
void use_lognormal(const dem::LognormalSizes& sizes) { use(sizes); }
void use_sieve(const dem::SieveSizes::Fraction& fraction, int power = 3) {
  use(dem::SieveSizes({{.min_radius = 1, .max_radius = 2, .mass = 1}, fraction}, {.power = power}));
}

// Radii are accepted from 1e-100 to 1e100 m, so that volumes are finite.
TEST(BadInput, OfDistributionsOfSizesIsRefused) {
  const dem::LognormalSizes usual{
      .median = 1, .deviation = 0.2, .min_radius = 0.5, .max_radius = 2};
  const auto with = [&](double dem::LognormalSizes::* member) {
    return [=](double x) {
      auto sizes = usual;
      sizes.*member = x;
      use_lognormal(sizes);
    };
  };
  check_parameters(std::vector<NumberParameter>{
      {"EqualSizes: value", [](double x) { use(dem::EqualSizes{.value = x}); }, accepts::positive},
      {"UniformSizes: min_radius",
       [](double x) { use_uniform({.min_radius = x, .max_radius = 2}); }, accepts::nothing},
      {"UniformSizes: max_radius",
       [](double x) { use_uniform({.min_radius = 1, .max_radius = x}); }, accepts::nothing},
      {"LognormalSizes: median", with(&dem::LognormalSizes::median), accepts::nothing},
      {"LognormalSizes: deviation", with(&dem::LognormalSizes::deviation), accepts::tiny},
      {"LognormalSizes: min_radius", with(&dem::LognormalSizes::min_radius), accepts::nothing},
      {"LognormalSizes: max_radius", with(&dem::LognormalSizes::max_radius), accepts::nothing},
      {"SieveSizes: min_radius",
       [](double x) { use_sieve({.min_radius = x, .max_radius = 4, .mass = 1}); },
       accepts::nothing},
      {"SieveSizes: max_radius",
       [](double x) { use_sieve({.min_radius = 2, .max_radius = x, .mass = 1}); },
       accepts::nothing},
      {"SieveSizes: mass",
       [](double x) { use_sieve({.min_radius = 2, .max_radius = 4, .mass = x}); },
       accepts::zero | accepts::tiny},
      {"Blend: density",
       [](double x) { dem::Blend<dem::EqualSizes>{.sizes = {1}, .density = x}.check(); },
       accepts::positive}});
  check_parameters(std::vector<IntegerParameter>{
      {"SieveSizes: power",
       [](std::int64_t n) {
         use_sieve({.min_radius = 2, .max_radius = 4, .mass = 1}, static_cast<int>(n));
       },
       accepts::nothing, 1 << 30}});
}

const dem::Blend<dem::EqualSizes> small{.sizes = {0.05}, .density = 2500};

void use_scatter(const Box<2>& region, const dem::Scatter& how) {
  dem::Grains<2> grains;
  change_or_keep([&] { return grains.size(); }, [&] { dem::scatter(grains, small, region, how); });
  EXPECT_LE(grains.size(), 30u);
}

void use_cylinder(const dem::VerticalCylinder<>& region) {
  region.check();
  EXPECT_GE(region.volume(), 0);
  EXPECT_TRUE(is_finite(region.bounds().lower));
}

TEST(BadInput, OfPlacementsIsRefused) {
  const auto unit = cube<2, double>(0, 1);
  check_parameters(std::vector<NumberParameter>{
      {"dem::scatter: solid_fraction", [&](double x) { use_scatter(unit, {.solid_fraction = x}); },
       accepts::zero | accepts::tiny},
      {"upper",
       [&](double x) {
         use_scatter(Box<2>{.lower = {-1, -1}, .upper = {x, 1}}, {.number = 1, .tries = 10});
       },
       accepts::zero | accepts::positive},
      {"VerticalCylinder: base",
       [](double x) { use_cylinder({.base = {0, x, 0}, .radius = 1, .height = 1}); },
       accepts::finite},
      {"VerticalCylinder: radius", [](double x) { use_cylinder({.radius = x, .height = 1}); },
       accepts::positive},
      {"VerticalCylinder: height", [](double x) { use_cylinder({.radius = 1, .height = x}); },
       accepts::positive}});
  check_parameters(std::vector<IntegerParameter>{
      {"dem::scatter: number",
       [&](std::int64_t n) { use_scatter(unit, {.number = static_cast<Index>(n)}); },
       accepts::zero},
      {"dem::scatter: tries",
       [&](std::int64_t n) { use_scatter(unit, {.number = 1, .tries = static_cast<Index>(n)}); },
       accepts::nothing}});
}

auto resting_grain() {
  return Simulation{one_grain<2>({2, 0}, {0, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
}

using Inflow = dem::Inflow<Box<2>, dem::EqualSizes>;
// What is refused adds nothing.
void use_inflow(const Inflow::Settings& settings) {
  Inflow inflow(cube<2, double>(0, 1), small, settings);
  auto sim = resting_grain();
  for (int step = 0; step < 2; ++step) {
    change_or_keep([&] { return sim.particles().size(); }, [&] { inflow.before_step(sim); });
    sim.step(1e-3);
  }
}

void use_settling(const dem::Settling& settling) {
  auto sim = resting_grain();
  change_or_keep([&] { return sim.steps(); }, [&] { dem::settle(sim, settling); });
}

TEST(BadInput, OfInflowAndSettlingIsRefused) {
  const auto out_every = [](double x) {
    dem::Outflow outflow(cube<2, double>(0, 1), {.every = x});
    auto sim = resting_grain();
    outflow.before_step(sim);
    sim.step(1e-3);
    outflow.before_step(sim);
  };
  check_parameters(std::vector<NumberParameter>{
      {"Inflow: rate", [](double x) { use_inflow({.number = 3, .rate = x}); }, accepts::positive},
      {"Inflow: from", [](double x) { use_inflow({.number = 3, .from = x}); }, accepts::finite},
      {"Inflow: velocity", [](double x) { use_inflow({.number = 3, .velocity = {x, 0}}); },
       accepts::finite},
      {"Inflow: every", [](double x) { use_inflow({.number = 3, .every = x}); },
       accepts::not_negative},
      {"Outflow: every", out_every, accepts::not_negative},
      {"Settling: speed",
       [](double x) {
         use_settling({.speed = x, .check_every = 0.1, .max_time = 1, .time_step = 0.01});
       },
       accepts::positive},
      {"Settling: check_every",
       [](double x) {
         use_settling({.speed = 1, .check_every = x, .max_time = 1, .time_step = 0.01});
       },
       accepts::tiny},
      {"Settling: max_time",
       [](double x) {
         use_settling({.speed = 1, .check_every = 0.1, .max_time = x, .time_step = 0.01});
       },
       accepts::nothing},
      {"Settling: time_step",
       [](double x) {
         use_settling({.speed = 1, .check_every = 0.1, .max_time = 1, .time_step = x});
       },
       accepts::huge}});
  check_parameters(std::vector<IntegerParameter>{
      {"Inflow: number",
       [](std::int64_t n) { use_inflow({.number = static_cast<Index>(n), .rate = 10.0}); },
       accepts::zero | accepts::minus_one | accepts::huge},
      {"Inflow: tries",
       [](std::int64_t n) { use_inflow({.number = 3, .tries = static_cast<Index>(n)}); },
       accepts::nothing}});
}

TEST(Settling, EndsIfChecksAreTooFrequentToChangeTheTime) {
  Simulation sim{one_grain<2>({2, 0}, {1, 0}), UniformGrid<2>{}, Gravity<2>{{0, 0}}, Leapfrog{}};
  const dem::Settling settling{
      .speed = 0.5, .check_every = 1e-30, .max_time = 1, .time_step = 0.01};
  EXPECT_TRUE(refuses([&] { dem::settle(sim, settling); },
                      {"Settling: check_every = 1e-30 s", "0.01 s", "; increase it"}));
}

// A table of one grain, one column of which is as given.
auto in_column(const std::string& name) {
  return [name](double x) {
    std::vector<std::string> names{"x", "y", "radius", "density", "velocity_x"};
    std::vector<std::vector<double>> columns{{0}, {0}, {0.01}, {2500}, {0}};
    for (Index k = 0; k < names.size(); ++k) {
      if (names[k] == name) columns[k][0] = x;
    }
    if (name == "mass") {  // instead of a density
      names[3] = name;
      columns[3][0] = x;
    }
    const CsvTable table("grains.csv", std::move(names), std::move(columns), {2});
    EXPECT_EQ(dem::grains_from<2>(table).size(), 1u);
  };
}

TEST(BadInput, OfTablesOfGrainsIsRefused) {
  check_parameters(std::vector<NumberParameter>{
      {"grains.csv: line 2: column x", in_column("x"), accepts::finite},
      {"grains.csv: line 2: column velocity_x", in_column("velocity_x"), accepts::finite},
      {"radius", in_column("radius"), accepts::nothing},
      {"density", in_column("density"), accepts::nothing},
      {"mass", in_column("mass"), accepts::huge}});
}

}  // namespace
}  // namespace silt::test::bad_input_of_placements_test
