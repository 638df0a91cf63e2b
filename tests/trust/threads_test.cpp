// SPDX-License-Identifier: MIT
// The same bits, and the same texts of errors, on 1 to 16 threads.
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/grains.hpp"
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace silt::test::threads_test {
namespace {

const dem::CundallStrack law{.normal_stiffness = 1e6,
                             .tangential_stiffness = 5e5,
                             .restitution = 0.6,
                             .friction_angle = 0.5};

// Grains that fall through a periodic box onto a vibrating floor.
auto shaken() {
  auto grains = crowd<3, double>(16, 1);
  auto box = cube<3, double>(0, 16 * 0.0205);
  box.lower[2] = -0.5;
  box.upper[2] = 10;
  box.periodic = {true, true, false};
  grains.set_box(box);
  const dem::Moving floor{dem::Plane<3>{.point = {0, 0, -0.02}},
                          dem::Vibration<3>{.amplitude = {0, 0, 1e-3}, .frequency = 50}};
  return Simulation{std::move(grains), NeighbourList<3>{},
                    Forces{Gravity<3>{{0.5, 0, -9.81}}, dem::Contacts{law, floor}}, Leapfrog{}};
}

auto dam() {
  return Simulation{
      mps::make_tank<2>(
          {.column = {0.8, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = 0.016}),
      UniformGrid<2>{}, mps::Flow<mps::Case10, 2>({.spacing = 0.016, .max_time_step = 1e-3}),
      SemiImplicit{}};
}

template <class Start>
void expect_same_bits(Start&& start, int steps) {
  const auto run = [&] {
    auto simulation = start();
    for (int k = 0; k < steps; ++k) simulation.step();
    return state_of(simulation.particles());
  };
  const Bytes alone = with_threads(1, run);
  for (const int number : {2, 3, 4, 8, 16}) {
    EXPECT_TRUE(with_threads(number, run) == alone) << number << " threads";
  }
}

TEST(Threads, GiveTheSameBitsOfGrains) { expect_same_bits(shaken, 15); }
TEST(Threads, GiveTheSameBitsOfGrainsInTenThousandStepsSlow) { expect_same_bits(shaken, 10000); }
TEST(Threads, GiveTheSameBitsOfAFlow) { expect_same_bits(dam, 2); }
TEST(Threads, GiveTheSameBitsOfAFlowInFiveHundredStepsSlow) { expect_same_bits(dam, 500); }

// What the next step reports, after a change by which several particles are wrong.
template <class Sim, class Change>
void expect_same_text(const Sim& simulation, const std::string& part, Change&& change) {
  std::vector<std::string> texts;
  for (const int number : {1, 2, 3, 4, 8, 16}) {
    with_threads(number, [&] {
      Sim broken = simulation;
      change(broken.particles());
      try {
        broken.step(1e-5);
        texts.emplace_back();
      } catch (const Error& error) {
        texts.emplace_back(error.what());
      }
    });
  }
  EXPECT_NE(texts.front().find(part), std::string::npos) << texts.front();
  EXPECT_EQ(texts, std::vector<std::string>(texts.size(), texts.front()));
}

TEST(Threads, GiveTheSameTextsOfErrors) {
  auto simulation = shaken();
  ASSERT_GT(simulation.particles().size(), 3 * chunk_size);
  simulation.step();
  const auto each_third = [](auto& particles, auto&& change) {
    for (Index i = 1; i < particles.size(); i += 3) change(i);
  };
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  expect_same_text(simulation, "velocity",
                   [&](auto& p) { each_third(p, [&](Index i) { p[velocity][i][1] = nan; }); });
  expect_same_text(simulation, "radius",
                   [&](auto& p) { each_third(p, [&](Index i) { p[radius][i] = -1; }); });
  expect_same_text(simulation, "coincide", [&](auto& p) {
    each_third(p, [&](Index i) { p[position][i] = p[position][i - 1]; });
  });
  expect_same_text(simulation, "material",
                   [&](auto& p) { each_third(p, [&](Index i) { p[dem::material][i] = 7; }); });
  expect_same_text(simulation, "stable", [&](auto& p) {
    each_third(p, [&](Index i) {
      p[mass][i] *= 1e-9;
      p[inertia][i] *= 1e-9;
    });
  });
  expect_same_text(dam(), "velocity", [&](auto& p) {
    each_third(p, [&](Index i) { p[velocity][i][1] = nan; });
  });
}

}  // namespace
}  // namespace silt::test::threads_test
