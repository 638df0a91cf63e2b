// SPDX-License-Identifier: MIT
// Memory and time of a search, of contacts and of a placement are bounded for any sizes, positions
// and numbers, or an error names the value.
// Only with --all: every search at extreme sizes and extents.
#include <silt/dem.hpp>
#include <silt/dem/setup/inflow.hpp>
#include <silt/dem/setup/packing.hpp>

#include "support/check.hpp"
#include "support/counted_memory.hpp"
#include "support/points.hpp"
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdio>
#include <ctime>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace silt::test::bounded_memory_test {
namespace {

// Half the bound of docs/choosing.md: bytes for each grain, and beyond.
constexpr std::int64_t grain_bytes = 16 * 1024;
constexpr std::int64_t more_bytes = 1 << 20;

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

// Processor time, which other programs do not increase [s].
template <class F>
double seconds_of(F&& f) {
  const std::clock_t begin = std::clock();
  f();
  return double(std::clock() - begin) / CLOCKS_PER_SEC;
}

template <class S, int Dim = S::Vec::RowsAtCompileTime>
auto simulation_of(const dem::Grains<Dim>& grains, S search = {}) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  return Simulation{grains, std::move(search), dem::Contacts{law}.with({.max_overlap = infinity}),
                    Leapfrog{}};
}

// Grains that move at random and nearly touch, so that some collide.
template <int Dim>
dem::Grains<Dim> small_grains(Index along_each_axis) {
  const double radius = 1e-3;
  auto points =
      lattice(cube<Dim, double>(0, 2.02 * radius * double(along_each_axis)), 2.02 * radius);
  auto grains = dem::make_grains(points, {.radius = radius, .density = 2500});
  const auto v = random_points(points.size(), cube<Dim, double>(-1, 1), 5);
  for (Index i = 0; i < grains.size(); ++i) grains[velocity][i] = v[i];
  return grains;
}

// One grain of so many radii touches the others from below.
template <int Dim>
dem::Grains<Dim> one_large_among_small(Index along_each_axis, double ratio) {
  auto grains = small_grains<Dim>(along_each_axis);
  const double radius = 1e-3 * ratio;
  Vec<Dim> x = Vec<Dim>::Zero();
  x[Dim - 1] = -radius;
  dem::add_grain(grains, x, {.radius = radius, .density = 2500});
  return grains;
}

template <int Dim>
dem::Grains<Dim> grains_at_one_point(Index n) {
  auto points = random_points(n, cube<Dim, double>(0, 1e-6), 3);
  return dem::make_grains(points, {.radius = 1e-3, .density = 2500});
}

// Grains so far away that their positions have too few digits are refused, within the same bounds.
template <class Sim>
void expect_bounded_steps(Sim simulation, int steps, double seconds) {
  const auto grains = static_cast<std::int64_t>(simulation.particles().size());
  double took = 0;
  const std::int64_t peak = peak_of([&] {
    took = seconds_of([&] {
      try {
        for (int step = 0; step < steps; ++step) simulation.step();
      } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("is known to"), std::string::npos) << error.what();
      }
    });
  });
  std::printf("      %lld grains: %lld bytes each, %.2f s\n", static_cast<long long>(grains),
              static_cast<long long>(peak / grains), took);
  EXPECT_GT(peak, 0);
  EXPECT_LE(peak, grains * grain_bytes + more_bytes);
  EXPECT_LT(took, seconds);
}

template <class S>
class BoundedMemory : public ::testing::Test {};
using Searches = ::testing::Types<NeighbourList<2>, NeighbourList<3>, LevelGrid<2>, LevelGrid<3>,
                                  NeighbourList<3, double, LevelGrid<3>>>;
TYPED_TEST_SUITE(BoundedMemory, Searches);

template <class S>
inline constexpr int dimension_of = S::Vec::RowsAtCompileTime;
// About 10⁴ grains.
template <class S>
inline constexpr Index along = dimension_of<S> == 2 ? 100 : 22;

TYPED_TEST(BoundedMemory, IsEnoughForOneLargeGrainAmongManySmallOnes) {
  for (const double ratio : {10.0, 1e2, 1e3, 1e4, 1e6}) {
    SCOPED_TRACE(ratio);
    const auto grains = one_large_among_small<dimension_of<TypeParam>>(along<TypeParam>, ratio);
    expect_bounded_steps(simulation_of<TypeParam>(grains), 5, 5);
  }
}

TYPED_TEST(BoundedMemory, IsEnoughForAGrainFarAway) {
  for (const double far : {1.0, 1e6, 1e12, 1e150}) {
    SCOPED_TRACE(far);
    auto grains = small_grains<dimension_of<TypeParam>>(along<TypeParam>);
    grains[position][17].setConstant(far);
    expect_bounded_steps(simulation_of<TypeParam>(grains), 5, 5);
  }
}

TYPED_TEST(BoundedMemory, IsEnoughForAnyExtent) {
  for (const double extent : {1e-6, 1.0, 1e6, 1e12}) {
    SCOPED_TRACE(extent);
    constexpr int Dim = dimension_of<TypeParam>;
    const double radius = extent < 1 ? 1e-9 : 1e-3;
    const auto points = random_points(60'000, cube<Dim, double>(0, extent), 4);
    const auto grains = dem::make_grains(points, {.radius = radius, .density = 2500});
    expect_bounded_steps(simulation_of<TypeParam>(grains), 3, 2);
  }
}

TYPED_TEST(BoundedMemory, IsEnoughToRefuseACrowd) {
  for (const Index n : {1000, 10'000, 100'000}) {
    SCOPED_TRACE(n);
    const auto grains = grains_at_one_point<dimension_of<TypeParam>>(n);
    double took = 0;
    const std::int64_t peak = peak_of([&] {
      took = seconds_of([&] {
        EXPECT_TRUE(refuses([&] { simulation_of<TypeParam>(grains).step(); },
                            {"more than 64 overlaps per grain", "ids 0 and ", "place them apart"}));
      });
    });
    EXPECT_LE(peak, std::int64_t(n) * grain_bytes + more_bytes);
    EXPECT_LT(took, 3);
  }
}

TEST(BoundedRows, OfACrowdAreRefusedWithASmallerRadiusThanThatOfContacts) {
  auto grains = grains_at_one_point<2>(10'000);
  NeighbourList<2> search({.radius = std::as_const(grains)[radius][0]});
  EXPECT_TRUE(refuses([&] { search.update(grains); }, {"more than 64 overlaps per grain"}));
}

// Neighbours that the radius includes, but that are not in contact, are no crowd.
TEST(BoundedRows, AreNotStoredIfTheRadiusIncludesAllParticles) {
  Particles<3, double> points;
  for (const auto& x : random_points(10'000, cube<3, double>(0, 1), 6)) points.add(x);
  NeighbourList<3> search({.radius = 2, .skin_fraction = 0.1});
  Index pairs = 0;
  const std::int64_t peak = peak_of([&] {
    search.update(points);
    for (int k = 0; k < 2; ++k) {
      pairs = 0;
      for (Index i = 0; i < points.size(); i += 1000) {
        search.for_each_candidate(i, [&](Index) { ++pairs; });
        search.for_each_neighbour(i, [&](Index, const auto&, double) { ++pairs; });
      }
      search.update(points);
    }
  });
  EXPECT_GE(pairs, 10u * 9999u);
  EXPECT_LE(peak, 10'000 * grain_bytes + more_bytes);
}

// Positions and velocities by id.
template <class S>
Bytes state_after(const dem::Grains<S::Vec::RowsAtCompileTime>& grains, int steps) {
  auto simulation = simulation_of<S>(grains);
  for (int step = 0; step < steps; ++step) simulation.step();
  const auto& after = simulation.particles();
  Bytes bytes;
  for (Id id = 0; id < after.size(); ++id) {
    const Index i = after.index_of(id);
    append(bytes, std::vector{after[position][i], after[velocity][i]});
  }
  return bytes;
}

TEST(BoundedRows, HaveNoEffectOnContacts) {
  for (const bool periodic : {false, true}) {
    for (const double ratio : {3.0, 30.0, 1e3}) {
      SCOPED_TRACE(ratio);
      auto grains = one_large_among_small<2>(40, ratio);
      if (periodic) {
        const double side = 5e-3 * ratio + 0.2;
        Box<2> box{
            .lower = {-side / 2, -side}, .upper = {side / 2, side}, .periodic = {true, false}};
        grains.set_box(box);
      }
      const Bytes expected = state_after<BruteForce<2>>(grains, 40);
      EXPECT_TRUE(state_after<NeighbourList<2>>(grains, 40) == expected);
      EXPECT_TRUE(state_after<LevelGrid<2>>(grains, 40) == expected);
      EXPECT_TRUE((state_after<NeighbourList<2, double, LevelGrid<2>>>(grains, 40) == expected));
    }
  }
}

// Whether f throws an error with this text soon, without much memory.
template <class F>
::testing::AssertionResult refuses_soon(const std::string& text, F&& f) {
  ::testing::AssertionResult refused = ::testing::AssertionSuccess();
  double took = 0;
  const std::int64_t peak =
      peak_of([&] { took = seconds_of([&] { refused = refuses(f, {text}); }); });
  if (!refused) return refused;
  if (took > 2 || peak > 64 * more_bytes) {
    return ::testing::AssertionFailure() << took << " s, " << peak << " bytes";
  }
  return refused;
}

constexpr Index very_many = Index{1} << 60;

template <int Dim>
class Setup {
 public:
  template <class R>
  static void scatter_in(const R& region, double radius, const dem::Scatter& scatter) {
    dem::Grains<Dim> grains;
    dem::scatter(grains, equal(radius), region, scatter);
  }
  static Box<Dim> box(double side) { return cube<Dim, double>(0, side); }

  template <class R>
  static void pour_in(const R& region, double radius, double rate, Index tries = 100) {
    dem::Inflow inflow(region, equal(radius),
                       {.number = very_many,
                        .rate = rate > 0 ? std::optional(rate) : std::nullopt,
                        .tries = tries});
    auto simulation = simulation_of<NeighbourList<Dim>>(small_grains<Dim>(2));
    inflow.before_step(simulation);
    simulation.step(1e-6);
    inflow.before_step(simulation);
  }

 private:
  static dem::Blend<dem::EqualSizes> equal(double radius) {
    return {.sizes = {.value = radius}, .density = 2500};
  }
};

template <int Dim>
void expect_that_placements_end() {
  using S = Setup<Dim>;
  const auto scatter = [](const auto& region, double radius, const dem::Scatter& how) {
    return [=] { S::scatter_in(region, radius, how); };
  };
  EXPECT_TRUE(
      refuses_soon("number = 1.15292e+18", scatter(S::box(1), 0.01, {.number = very_many})));
  EXPECT_TRUE(refuses_soon("number = 100000000 grains have no room",
                           scatter(S::box(1), 0.01, {.number = 100'000'000})));
  EXPECT_TRUE(refuses_soon("found no free position",
                           scatter(S::box(1), 0.1, {.number = Dim == 2 ? 30 : 230})));
  EXPECT_TRUE(refuses_soon("solid_fraction = 0.1 gives",
                           scatter(S::box(1), 1e-9, {.solid_fraction = 0.1})));
  EXPECT_TRUE(refuses_soon("solid_fraction = 0.1 gives",
                           scatter(S::box(1), 1e-200, {.solid_fraction = 0.1})));
  EXPECT_TRUE(refuses_soon("radius 0.6 m has no room in the region",
                           scatter(S::box(1), 0.6, {.number = 1, .tries = 1'000'000})));
  EXPECT_TRUE(refuses_soon("tries = 1152921504606846976",
                           scatter(S::box(1), 0.3, {.number = 9, .tries = very_many})));
  EXPECT_TRUE(refuses_soon("= -inf", scatter(Box<Dim>{}, 0.01, {.number = very_many})));
  EXPECT_TRUE(refuses_soon("= inf", scatter(Box<Dim>{}, 0.01, {.solid_fraction = 0.1})));
  EXPECT_TRUE(
      refuses_soon("lower = 0 is not below upper = 0", scatter(S::box(0), 0.01, {.number = 10})));
  EXPECT_TRUE(refuses_soon("volume of the region = 0",
                           scatter(S::box(1e-200), 1e-300, {.solid_fraction = 0.1})));
  for (const double side : {not_a_number, infinity, -infinity}) {
    EXPECT_TRUE(refuses_soon("region", scatter(S::box(side), 0.01, {.number = 10})) ||
                refuses_soon("Box", scatter(S::box(side), 0.01, {.number = 10})));
  }
  for (const double radius : {0.0, -1.0, not_a_number, infinity}) {
    EXPECT_TRUE(refuses_soon("EqualSizes: value = ", scatter(S::box(1), radius, {.number = 10})));
  }

  EXPECT_TRUE(refuses_soon("Inflow: number = 1.15292e+18", [] { S::pour_in(S::box(1), 1e-9, 0); }));
  EXPECT_TRUE(refuses_soon("set a lower rate", [] { S::pour_in(S::box(1), 1e-9, 1e300); }));
  EXPECT_TRUE(refuses_soon("Inflow: a grain of radius 2 m has no room",
                           [] { S::pour_in(S::box(1), 2, 0); }));
  EXPECT_TRUE(refuses_soon("= -inf", [] { S::pour_in(Box<Dim>{}, 0.1, 0); }));
  EXPECT_TRUE(refuses_soon("Inflow: tries", [] { S::pour_in(S::box(1), 0.1, 0, very_many); }));
  S::pour_in(S::box(1), 0.05, 0);  // fills the box, and is not refused

  for (const double spacing : {1e-9, 1e-300, 0.0, not_a_number, infinity}) {
    EXPECT_TRUE(refuses_soon("lattice: spacing", [&] { lattice(S::box(1), spacing); }));
  }
  EXPECT_TRUE(refuses_soon("lattice: ", [&] { lattice(Box<Dim>{}, 0.1); }));
}

TEST(Particles, TakeHardlyAnyMemoryAfterItWasReserved) {
  dem::Grains<3> grains;
  grains.reserve(1000);
  const std::int64_t peak = peak_of([&] {
    for (int k = 0; k < 1000; ++k) grains.add({double(k), 0, 0});
  });
  EXPECT_LT(peak, 1000) << "bytes";
}

TEST(Placements, EndForAnyNumbers) {
  expect_that_placements_end<2>();
  expect_that_placements_end<3>();
}

// The large grains are placed after the small ones, among which they have cells beyond number.
TEST(Placements, EndForAnyRatioOfSizes) {
  for (const double ratio : {10.0, 1e3, 1e6}) {
    auto grains = small_grains<3>(10);
    const double radius = 1e-3 * ratio;
    const double took = seconds_of([&] {
      dem::scatter(grains, dem::Blend<dem::EqualSizes>{.sizes = {.value = radius}, .density = 2500},
                   cube<3, double>(-10 * radius, 10 * radius), {.number = 10});
    });
    EXPECT_EQ(grains.size(), 1010u);
    EXPECT_LT(took, 2);
  }
}

}  // namespace
}  // namespace silt::test::bounded_memory_test
