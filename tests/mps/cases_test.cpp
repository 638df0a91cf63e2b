// SPDX-License-Identifier: MIT
// make_tank, and runs of all eleven cases of Table 1 in 2D, of three of them in 3D.
#include <silt/dem/setup/random.hpp>

#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/slow_types.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

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

// Walls of faces may stand between two points of the lattice.
TEST(Tank, HasFacesExactlyWhereTheyWereAskedToBe) {
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.38}, .size = {.length = 1.61, .height = 1.01}, .spacing = 0.02});
  EXPECT_EQ(tank.particles.size(), 20u * 19u);
  Vec<2> corner = Vec<2>::Zero();
  for (const auto& face : tank.walls.segments) {
    for (const Vec<2>& end : face.corners) corner = corner.cwiseMax(end);
  }
  EXPECT_EQ(corner, Vec<2>(1.61, 1.01));
  EXPECT_EQ(tank.particles.box().upper[1], 3 * 1.01);
}

// By name, with both, and only what is on the lattice of the particles.
TEST(Tank, RefusesWhatIsNoWholeNumberOfSpacingsWithTheNearestThatAre) {
  const mps::Tank<3> whole{.column = {0.4, 0.4},
                           .size = {.length = 1.6, .height = 1, .depth = 0.2},
                           .spacing = 0.02};
  const auto refused = [&](auto&& make, const std::function<void(mps::Tank<3>&)>& modify,
                           const std::string& message) {
    mps::Tank<3> tank = whole;
    modify(tank);
    return refuses([&] { make(tank); }, {"Tank: " + message, " m"});
  };
  const auto of_faces = [](const auto& tank) { mps::make_tank<mps::Recommended>(tank); };
  const auto of_particles = [](const auto& tank) { mps::make_tank(tank); };
  const auto width = [](auto& tank) { tank.column[0] = 0.41; };
  const auto height = [](auto& tank) { tank.column[1] = 0.395; };
  const auto depth = [](auto& tank) { tank.size.depth = 0.21; };
  EXPECT_TRUE(
      refused(of_particles, width,
              "column width = 0.41 m is 20.5 times the spacing = 0.02 m, and the column is "
              "on the lattice of wall particles; give a whole number of spacings, such as 0.4 "
              "or 0.42 m"));
  EXPECT_TRUE(refused(of_particles, height, "column height = 0.395 m is 19.75 times"));
  const auto length_of_tank = [](auto& tank) { tank.size.length = 1.61; };
  const auto height_of_tank = [](auto& tank) { tank.size.height = 1.01; };
  EXPECT_NO_THROW(of_faces(whole));
  EXPECT_TRUE(refused(of_particles, length_of_tank,
                      "length = 1.61 m is 80.5 times the spacing = 0.02 m, and wall particles are "
                      "on the lattice of the fluid; give a whole number of spacings, such as 1.6 or "
                      "1.62 m"));
  EXPECT_TRUE(refused(of_particles, height_of_tank, "height = 1.01 m"));
  EXPECT_TRUE(refused(of_particles, depth, "depth = 0.21 m"));
}

// That of sums and quotients, but not a length with too few digits.
TEST(Tank, TakesLengthsThatAreWholeUpToRoundOff) {
  const auto columns = [](double width, double spacing) {
    const auto tank = mps::make_tank<mps::Recommended, 2>(
        {.column = {width, spacing}, .size = {.length = width, .height = 1}, .spacing = spacing});
    return tank.particles.size();
  };
  EXPECT_EQ(columns(0.3, 0.1), 3u);
  EXPECT_EQ(columns(0.1 + 0.1 + 0.1, 0.1), 3u);
  EXPECT_EQ(columns(1, 1.0 / 49), 49u);
  EXPECT_EQ(columns(0.3333333333, 1.0 / 3), 1u) << "ten digits, as in messages";
  double sum = 0;
  for (int k = 0; k < 1000; ++k) sum += 0.001;
  EXPECT_EQ(columns(sum, 0.001), 1000u);
  EXPECT_TRUE(refuses(
      [&] {
        mps::make_tank<2>({.column = {0.3333333, 1.0 / 30},
                           .size = {.length = 1, .height = 1},
                           .spacing = 1.0 / 30});
      },
      {"column width = 0.3333333 m is 9.999999 times", " or 0.3333333333 m"}));
}

// No other test proves that a column that no lattice fits has its volume and rests: 9.75 by 10.25
// and 10 by 19.75 spacings.
TEST(Tank, RestsWithAColumnThatNoLatticeFits) {
  const auto expect_rest = [](const mps::Tank<2>& tank) {
    const auto made = mps::make_tank<mps::Recommended>(tank);
    const double volume = tank.column.prod() / squared(tank.spacing);
    EXPECT_LE(std::abs(double(made.particles.size()) - volume), 0.5);
    const double scale = std::sqrt(9.81 * tank.column[1]);
    const mps::Flow<mps::Recommended> water{
        {.spacing = tank.spacing, .speed_scale = scale, .walls = made.walls}};
    Simulation still{made.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
    still.run({.until = 0.2});
    for (const auto& u : still.particles()[velocity]) EXPECT_LT(u.norm(), 2e-3 * scale);
  };
  expect_rest({.column = {0.39, 0.41}, .size = {.length = 0.39, .height = 0.8}, .spacing = 0.04});
  expect_rest({.column = {0.2, 0.395}, .size = {.length = 0.2, .height = 0.8}, .spacing = 0.02});
}

// Half a spacing of air beside the fluid is no start at rest: no particle fits into it.
TEST(Tank, RefusesAGapBesideTheColumnThatHoldsNoParticle) {
  mps::Tank<2> tank{
      .column = {0.4, 0.2}, .size = {.length = 0.41, .height = 0.3}, .spacing = 0.02};
  const auto make = [&] { mps::make_tank<mps::Recommended>(tank); };
  EXPECT_TRUE(refuses(make, {"Tank: length = 0.41 m leaves a gap of 0.5 times the spacing = 0.02 m",
                             "give 0.4 m, or at least 0.42 m"}));
  tank.size.length = 0.425;
  EXPECT_NO_THROW(make()) << "beyond a gap of a spacing and more";
  tank.size.height = 0.21;
  EXPECT_NO_THROW(make()) << "the surface is free";
  tank.lid = true;
  EXPECT_TRUE(refuses(make, {"Tank: height = 0.21 m leaves a gap of 0.5 times", "give 0.2 m"}));
}

// For fluid of another shape, with the same walls and box to the bit as with a column.
TEST(Tank, MayBeEmpty) {
  mps::Tank<3> tank{.size = {.length = 0.41, .height = 0.3, .depth = 0.215}, .spacing = 0.02};
  const auto empty = mps::make_empty_tank<mps::Recommended>(tank);
  EXPECT_TRUE(empty.particles.empty());
  EXPECT_EQ(empty.walls.triangles.size(), 2u * 5u);
  tank.size.depth = 0.22;
  tank.column = {0.02, 0.02};
  const auto full = mps::make_tank<mps::Recommended>(tank);
  EXPECT_TRUE(refuses([&] { mps::make_empty_tank<mps::Recommended>(tank); },
                      {"Tank: column = (0.02, 0.02) m in a tank without fluid", "leave it out"}));
  tank.column.setZero();
  const auto same = mps::make_empty_tank<mps::Recommended>(tank);
  EXPECT_EQ(same.walls.checksum(), full.walls.checksum());
  EXPECT_EQ(same.particles.box().upper, full.particles.box().upper);
}

// Of any lengths: the extents of what is made, between faces and of the lattice with half a spacing
// around it, or of rows with nearly this and the volume, are those that were asked for, or there is
// an error.
TEST(Tank, IsWhatWasAskedForOrAnError) {
  Random random{.seed = 3, .id = 1};
  const auto any_length = [&](double spacing, int most) {
    const double whole = std::floor(random.uniform({1, double(most)})) * spacing;
    const double kind = random.uniform();
    if (kind < 0.6) return whole;
    return kind < 0.8 ? whole * (1 + 3e-9) : whole + random.uniform() * spacing;
  };
  const auto extent = [](const auto& points) {
    Vec<2> farthest = Vec<2>::Zero();
    for (const auto& x : points) farthest = farthest.cwiseMax(x);
    return farthest;
  };
  int made = 0, refused = 0;
  for (int k = 0; k < 2000; ++k) {
    const double l0 = random.uniform({0.005, 0.03});
    const mps::Tank<2> tank{.column = {any_length(l0, 6), any_length(l0, 6)},
                            .size = {.length = any_length(l0, 12), .height = any_length(l0, 12)},
                            .spacing = l0,
                            .dummy_layers = 0,
                            .lid = k % 2 == 0};
    const Vec<2> size(tank.size.length, tank.size.height);
    const auto is = [](const Vec<2>& found, const Vec<2>& asked) {
      return ((found - asked).array().abs() <= 1e-9 * asked.array()).all();
    };
    try {
      const auto with_faces = mps::make_tank<mps::Recommended>(tank);
      ++made;
      const Vec<2> half = Vec<2>::Constant(l0 / 2);
      const Vec<2> cells = tank.column / l0;
      const Vec<2> column = extent(with_faces.particles[position]) + half;
      if (((cells - cells.array().round().matrix()).array().abs() < 1e-9 * cells.array()).all()) {
        EXPECT_TRUE(is(column, tank.column));
      } else {
        EXPECT_LT((column - tank.column).lpNorm<Eigen::Infinity>(), l0 / 2);
        EXPECT_LE(std::abs(double(with_faces.particles.size()) - cells.prod()), 0.5 + 1e-6);
      }
      std::vector<Vec<2>> ends;
      for (const auto& face : with_faces.walls.segments) {
        for (const Vec<2>& end : face.corners) ends.push_back(end);
      }
      EXPECT_TRUE(is(extent(ends), size));
      const auto with_particles = mps::make_tank(tank);
      ++made;
      Vec<2> inner = extent(with_particles[position]) - half;
      if (!tank.lid) inner[1] += l0;  // it ends with the walls
      EXPECT_TRUE(is(inner, size));
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(made, 300);
  EXPECT_GT(refused, 300);
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
