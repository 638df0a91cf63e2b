// SPDX-License-Identifier: MIT
// Bitwise identical results: for any number of threads, for units that differ by powers of four,
// and for searches with the same order of neighbours.
// Only with --all: units and searches; trust/threads_test.cpp has one flow.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace silt::test::determinism_of_flows_test {
namespace {

using mps::Case00;
using mps::Case10;
using mps::Flow;

enum class Threads { constant, changing };

template <class Case, int Dim>
Bytes after_steps(const mps::Fluid<Dim>& fluid, double l0, int steps, Threads number) {
  Simulation sim{fluid, UniformGrid<Dim>{},
                 Flow<Case, Dim>({.spacing = l0, .viscosity = 1e-4, .max_time_step = 1e-3}),
                 SemiImplicit{}};
  for (int k = 0; k < steps; ++k) {
    if (number == Threads::changing) use_threads(1 + 3 * k % 4);
    sim.step();
  }
  return state_of(sim.particles());
}

template <class Case, int Dim>
void expect_one_result(const mps::Fluid<Dim>& fluid, double l0, int steps) {
  ASSERT_GT(fluid.size(), 3 * chunk_size) << "too few chunks for several threads";
  const auto by = [&](int number, Threads threads = Threads::constant) {
    return with_threads(number, [&] { return after_steps<Case>(fluid, l0, steps, threads); });
  };
  const Bytes serial = by(1);
  for (const int number : {2, 3, 4}) EXPECT_TRUE(by(number) == serial) << number << " threads";
  EXPECT_TRUE(by(1, Threads::changing) == serial) << "another number in every step";
}

// With more threads than cores, threads wait for one another in every loop: therefore few steps in
// the quick tests.
mps::Fluid<2> wide_dam(double l0) {
  return mps::make_tank<2>(
      {.column = {0.8, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = l0});
}

TEST(FlowBits, AreTheSameForAnyNumberOfThreads) {
  expect_one_result<Case10>(wide_dam(0.016), 0.016, 8);
  expect_one_result<Case00>(wide_dam(0.016), 0.016, 4);
}

TEST(FlowBits, AreTheSameForAnyNumberOfThreadsIn3D) {
  const auto tank = mps::make_tank<3>({.column = {0.4, 0.4},
                                       .size = {.length = 0.8, .height = 0.5, .depth = 0.2},
                                       .spacing = 0.05});
  expect_one_result<Case10>(tank, 0.05, 8);
}

// Units of length, mass and time in metres, kilograms and seconds.
struct Units {
  double length = 1;
  double mass = 1;
  double time = 1;
};

template <class Case, int Dim>
auto dam_in(const Units& unit) {
  const double l0 = 0.02 * unit.length;
  const double speed = unit.length / unit.time;
  mps::FlowSettings<Dim, Case> settings{
      .spacing = l0,
      .density = 1000 * unit.mass / std::pow(unit.length, 3),
      .viscosity = 1e-3 * unit.length * speed,
      .speed_scale = 1.5 * speed,
      .max_time_step = 1e-3 * unit.time};
  settings.gravity *= speed / unit.time;
  Simulation sim{small_dam<Dim>(l0), UniformGrid<Dim>{}, Flow<Case, Dim>(settings), SemiImplicit{}};
  for (int k = 0; k < (Dim == 2 ? 150 : 20); ++k) sim.step();
  return sim;
}

template <class Case, int Dim>
void expect_the_same_bits_in_other_units() {
  const auto plain = dam_in<Case, Dim>({});
  for (const Units& unit : {Units{.length = 4}, Units{.mass = 16}, Units{.time = 0.25},
                            Units{.length = 1.0 / 16, .mass = 4, .time = 64}}) {
    const auto other = dam_in<Case, Dim>(unit);
    const auto& a = plain.particles();
    const auto& b = other.particles();
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(other.time(), plain.time() * unit.time);
    const double speed = unit.length / unit.time;
    const double stress = unit.mass / (unit.length * unit.time * unit.time);
    bool same = true;
    for (Index i = 0; i < a.size(); ++i) {
      same &= b[position][i] == unit.length * a[position][i];
      same &= b[velocity][i] == speed * a[velocity][i];
      same &= b[mps::pressure][i] == stress * a[mps::pressure][i];
    }
    EXPECT_TRUE(same) << "length " << unit.length << ", mass " << unit.mass << ", time "
                      << unit.time;
  }
}

TEST(FlowBits, AreTheSameInUnitsThatArePowersOfFour) {
  expect_the_same_bits_in_other_units<Case10, 2>();
  expect_the_same_bits_in_other_units<Case00, 2>();
  expect_the_same_bits_in_other_units<Case10, 3>();
}

template <class S>
auto dam_with(S search, int steps) {
  Simulation sim{small_dam<2>(), std::move(search),
                 Flow<Case10>({.spacing = 0.02, .max_time_step = 1e-3}), SemiImplicit{}};
  for (int k = 0; k < steps; ++k) sim.step();
  return sim.particles();
}

TEST(FlowBits, OfAListWithoutSkinAreThoseOfTheGrid) {
  const auto by_grid = dam_with(UniformGrid<2>{}, 100);
  const auto by_list = dam_with(NeighbourList<2>({.skin_fraction = 0}), 100);
  EXPECT_TRUE(state_of(by_list) == state_of(by_grid));
}

TEST(FlowBits, OfOtherSearchesDifferByRoundOffOnly) {
  // Sums run over the neighbours in another order.
  const auto by_grid = dam_with(UniformGrid<2>{}, 3);
  const auto by_list = dam_with(NeighbourList<2>{}, 3);
  const auto by_brute_force = dam_with(BruteForce<2>{}, 3);
  double max_pressure = 0;
  for (const double p : by_grid[mps::pressure]) max_pressure = std::max(max_pressure, p);
  for (Index i = 0; i < by_grid.size(); ++i) {
    EXPECT_LE((by_list[position][i] - by_grid[position][i]).norm(), 1e-13);
    EXPECT_LE((by_brute_force[position][i] - by_grid[position][i]).norm(), 1e-13);
    EXPECT_NEAR(by_list[mps::pressure][i], by_grid[mps::pressure][i], 1e-9 * max_pressure);
    EXPECT_NEAR(by_brute_force[mps::pressure][i], by_grid[mps::pressure][i], 1e-9 * max_pressure);
  }
}

}  // namespace
}  // namespace silt::test::determinism_of_flows_test
