// SPDX-License-Identifier: MIT
// make_tank, and runs of all eleven cases of Table 1 in 2D, of three of them in 3D.
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/slow_types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

namespace silt::test::cases_test {
namespace {

using mps::Kind;

// --- the tank ------------------------------------------------------------------------------------

TEST(Tank, OfThePaperHas1600FluidParticlesAndOneLayerOfWalls) {
  const auto tank = mps::make_tank<2>(
      {.column = {0.4, 0.4}, .size = {.length = 0.4, .height = 0.4}, .spacing = 0.01});
  EXPECT_EQ(mps::count(tank, Kind::fluid), 1600u);
  EXPECT_EQ(mps::count(tank, Kind::wall), 42u + 2 * 40);  // floor with its corners, two walls
  EXPECT_EQ(mps::count(tank, Kind::dummy), 4u * (42 + 2 * 40) + 2 * (1 + 2 + 3 + 4) * 2);
  EXPECT_EQ(tank.size(), mps::count(tank, Kind::fluid) + mps::count(tank, Kind::wall) +
                             mps::count(tank, Kind::dummy));
}

template <int Dim>
void expect_full_below_the_surface() {
  const double l0 = 0.02;
  Simulation sim{small_dam<Dim>(l0), UniformGrid<Dim>{},
                 mps::Flow<mps::Case10, Dim>({.spacing = l0, .max_time_step = 1e-3}),
                 SemiImplicit{}};
  const auto start = sim.particles();
  sim.step();
  const double n0 = sim.interaction().stencil().n0;
  const double top = (Dim == 2 ? 15 : 8) * l0;
  Index full = 0;
  for (Index i = 0; i < start.size(); ++i) {
    const auto& x = start[position][i];
    if (start[mps::kind][i] == Kind::dummy) continue;
    if (x[0] > 6.6 * l0 || x[Dim - 1] > top - 3 * l0) continue;
    // At a depth of three spacings or more, particles have all neighbours of the full lattice,
    // including those in the walls.
    EXPECT_NEAR(sim.particles()[mps::number_density][i], n0, 1e-9 * n0);
    EXPECT_FALSE(sim.particles()[mps::surface][i]);
    ++full;
  }
  EXPECT_GT(full, 20u);
}

TEST(Tank, HasAFullNeighbourhoodForEveryParticleOffTheSurface) {
  expect_full_below_the_surface<2>();
  expect_full_below_the_surface<3>();
}

TEST(Tank, RoundsLengthsToWholeSpacings) {
  const auto tank = mps::make_tank<2>(
      {.column = {0.104, 0.096}, .size = {.length = 0.2, .height = 0.2}, .spacing = 0.01});
  EXPECT_EQ(mps::count(tank, Kind::fluid), 100u);
}

TEST(Tank, RejectsInvalidInputByNameAndValue) {
  const auto rejected = [](const std::function<void(mps::Tank<3>&)>& modify,
                           const std::string& message) {
    mps::Tank<3> tank{.column = {0.1, 0.1},
                      .size = {.length = 0.2, .height = 0.2, .depth = 0.1},
                      .spacing = 0.01};
    modify(tank);
    return refuses([&] { mps::make_tank(tank); }, {"Tank: ", message});
  };
  EXPECT_TRUE(rejected([](auto& t) { t.spacing = 0; }, "spacing = 0 "));
  EXPECT_TRUE(rejected([](auto& t) { t.spacing = nan; }, "spacing = nan "));
  EXPECT_TRUE(rejected([](auto& t) { t.spacing = 1e-9; },
                       "length = 0.2 m is 2e+08 times the spacing = 1e-09 m"));
  EXPECT_TRUE(rejected([](auto& t) { t.dummy_layers = -1; }, "dummy_layers = -1 "));
  EXPECT_TRUE(rejected([](auto& t) { t.size.length = 0.001; }, "length = 0.001 m"));
  EXPECT_TRUE(rejected([](auto& t) { t.size.height = -1; }, "height = -1 m"));
  EXPECT_TRUE(rejected([](auto& t) { t.size.depth = 0; }, "depth = 0 m"));
  EXPECT_TRUE(rejected([](auto& t) { t.size.depth = inf; }, "depth = inf "));
  EXPECT_TRUE(rejected([](auto& t) { t.column[0] = nan; }, "column width = nan "));
  EXPECT_TRUE(rejected([](auto& t) { t.column[1] = 0; }, "column height = 0 m"));
  EXPECT_TRUE(rejected([](auto& t) { t.column[0] = 0.3; },
                       "along axis 0 (length), the column has 30 spacings, but the tank has 20"));
  EXPECT_TRUE(rejected([](auto& t) { t.column[1] = 0.3; },
                       "along axis 2 (height), the column has 30 spacings, but the tank has 20"));
}

TEST(Tank, IsRejectedAboveABillionCells) {
  // 4 dummy layers and a wall on each side: 2e5 × 1e4 cells.
  const mps::Tank<2> large{
      .column = {1, 1}, .size = {.length = 199990, .height = 9990}, .spacing = 1};
  EXPECT_TRUE(refuses([&] { mps::make_tank(large); },
                      {"Tank: 2e+09 cells of the spacing 1 m are more than 1e9"}));
  // With a billion cells, the next check fails: such a spacing is zero in single precision.
  const double l0 = 1e-60;
  const mps::Tank<2> allowed{
      .column = {l0, l0}, .size = {.length = 999990 * l0, .height = 990 * l0}, .spacing = l0};
  EXPECT_TRUE(refuses([&] { mps::make_tank<2, float>(allowed); }, {"Box: axis 0"}));
}

// --- the cases -----------------------------------------------------------------------------------

template <class CaseType, int Dim>
struct Setting {
  using Case = CaseType;
  static constexpr int dimension = Dim;
};

template <class T>
class Cases : public ::testing::Test {};
using Settings = AllOrUsual<
    ::testing::Types<Setting<mps::Case00, 2>, Setting<mps::Case01, 2>, Setting<mps::Case02, 2>,
                     Setting<mps::Case03, 2>, Setting<mps::Case04, 2>, Setting<mps::Case05, 2>,
                     Setting<mps::Case06, 2>, Setting<mps::Case07, 2>, Setting<mps::Case08, 2>,
                     Setting<mps::Case09, 2>, Setting<mps::Case10, 2>, Setting<mps::Case00, 3>,
                     Setting<mps::Case05, 3>, Setting<mps::Case10, 3>>,
    ::testing::Types<Setting<mps::Case00, 2>, Setting<mps::Case10, 3>>>;
TYPED_TEST_SUITE(Cases, Settings);

// A column begins to collapse: it exerts pressure on floor and wall, and only fluid moves.
template <class Case, int Dim, class Order>
void expect_a_column_to_collapse(Order order) {
  Simulation sim{small_dam<Dim>(), UniformGrid<Dim>{},
                 mps::Flow<Case, Dim>({.spacing = 0.02, .max_time_step = 1e-3}), order};
  const auto start = sim.particles();
  for (int k = 0; k < 8; ++k) sim.step();
  const auto& particles = sim.particles();
  const double weight = 1000 * 9.81 * (Dim == 2 ? 15 : 8) * 0.02;
  double max_pressure = 0;
  double sum_of_u_x = 0;
  double sum_of_u_up = 0;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] == Kind::fluid) {
      sum_of_u_x += particles[velocity][i][0];
      sum_of_u_up += particles[velocity][i][Dim - 1];
      continue;
    }
    EXPECT_EQ(particles[position][i], start[position][i]);
    EXPECT_EQ(particles[velocity][i], Vec<Dim>::Zero());
    if (particles[mps::kind][i] == Kind::wall) {
      max_pressure = std::max(max_pressure, particles[mps::pressure][i]);
    } else {
      EXPECT_EQ(particles[mps::pressure][i], 0);
    }
  }
  EXPECT_GT(sum_of_u_x, 0);
  EXPECT_LT(sum_of_u_up, 0);
  EXPECT_GT(max_pressure, 0.2 * weight);
  EXPECT_LT(max_pressure, 20 * weight);
}

TYPED_TEST(Cases, SimulateACollapsingColumnInTheOrderOfTheirSource) {
  expect_a_column_to_collapse<typename TypeParam::Case, TypeParam::dimension>(SemiImplicit{});
}

#if SILT_SLOW_TESTS
// Case 10 has the order that it does not have by default.
TEST(Cases, SimulateACollapsingColumnWithMovedParticles) {
  static_assert(!mps::SourceOf<mps::Case10>::needs_moved_particles);
  expect_a_column_to_collapse<mps::Case10, 2>(SemiImplicit<MovesParticles>{});
}

TEST(Cases, UseTheOrderOfTheirSourceByDefault) {
  const auto after = [](auto flow, auto order) {
    Simulation sim{small_dam<2>(), UniformGrid<2>{}, flow, order};
    for (int k = 0; k < 5; ++k) sim.step();
    return state_of(sim.particles());
  };
  const mps::Flow<mps::Case00> original({.spacing = 0.02, .max_time_step = 1e-3});
  const mps::Flow<mps::Case01> improved({.spacing = 0.02, .max_time_step = 1e-3});
  EXPECT_TRUE(after(original, SemiImplicit{}) == after(original, SemiImplicit<MovesParticles>{}));
  EXPECT_TRUE(after(improved, SemiImplicit{}) == after(improved, SemiImplicit<KeepsParticles>{}));
  EXPECT_FALSE(after(improved, SemiImplicit{}) == after(improved, SemiImplicit<MovesParticles>{}));
}
#endif

}  // namespace
}  // namespace silt::test::cases_test
