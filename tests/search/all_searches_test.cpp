// SPDX-License-Identifier: MIT
// Every search, in every dimension and precision, finds the same pairs as a double loop.
#include "support/check.hpp"
#include "support/grains.hpp"
#include "support/points.hpp"
#include "support/slow_types.hpp"

#include <silt/search/brute_force.hpp>
#include <silt/search/level_grid.hpp>
#include <silt/search/neighbour_list.hpp>
#include <silt/search/uniform_grid.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

namespace silt::test::all_searches_test {
namespace {

template <class S>
class AllSearches : public ::testing::Test {
 public:
  static constexpr int dimension = S::Vec::RowsAtCompileTime;
  using Number = typename S::Real;
  using Point = Vec<dimension, Number>;
  using Points = std::vector<Point>;

  static S search(double radius) { return S({.radius = Number(radius)}); }

  // for_each_neighbour and for_each_pair of the search give the brute-force result.
  template <class P>
  static void expect_right(P& particles, S& found) {
    found.update(particles);
    const auto expected = brute_force_pairs(particles, found.radius());
    EXPECT_EQ(neighbour_pairs(particles, found), expected);
    EXPECT_EQ(pairs(particles, found), once_each(expected));
    for (Index i = 0; i < particles.size(); ++i) {
      found.for_each_neighbour(i, [&](Index j, const Point& r_ij, Number r) {
        EXPECT_LT(j, particles.total());
        EXPECT_NEAR(double(r), double(r_ij.norm()),
                    4 * double(std::numeric_limits<Number>::epsilon()) * double(r));
      });
    }
  }
  static void expect_right(const Points& points, double radius,
                           const Box<dimension, Number>& box = {}) {
    auto particles = particles_at(points, box);
    auto found = search(radius);
    expect_right(particles, found);
  }

  static Index pair_count(const Points& points, double radius, const Box<dimension, Number>& box) {
    auto particles = particles_at(points, box);
    auto found = search(radius);
    found.update(particles);
    return pairs(particles, found).size();
  }
};

using Searches = AllOrUsual<
    ::testing::Types<BruteForce<2, double>, BruteForce<2, float>, BruteForce<3, double>,
                     BruteForce<3, float>, UniformGrid<2, double>, UniformGrid<2, float>,
                     UniformGrid<3, double>, UniformGrid<3, float>, NeighbourList<2, double>,
                     NeighbourList<2, float>, NeighbourList<3, double>, NeighbourList<3, float>>,
    ::testing::Types<BruteForce<2>, UniformGrid<2>, NeighbourList<3>>>;
TYPED_TEST_SUITE(AllSearches, Searches);

TYPED_TEST(AllSearches, FindEveryPairOfRandomPoints) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const auto points = random_points(200, cube<dim, Real>(-1, 1), seed);
    for (const double radius : {0.05, 0.3, 1.0, 5.0}) this->expect_right(points, radius);
  }
}

TYPED_TEST(AllSearches, FindPairsFarFromTheOrigin) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  this->expect_right(random_points(150, cube<dim, Real>(-1003, -1000), 4), 0.5);
  this->expect_right(random_points(150, cube<dim, Real>(1000, 1003), 5), 0.5);
}

TYPED_TEST(AllSearches, FindPairsOnCellFaces) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  // A lattice whose spacing is the radius, or a fraction of it: points are on cell faces.
  for (const double spacing : {0.1, 0.25, 1.0}) {
    typename TestFixture::Points points;
    for (int a = -3; a <= 3; ++a) {
      for (int b = -3; b <= 3; ++b) {
        typename TestFixture::Point x = TestFixture::Point::Zero();
        x[0] = Real(a * spacing);
        x[1] = Real(b * spacing);
        x[dim - 1] += Real((a + b) * spacing);
        points.push_back(x);
      }
    }
    for (const double factor : {1.0, 1.0000001, 2.0}) {
      this->expect_right(points, factor * spacing);
    }
  }
}

TYPED_TEST(AllSearches, FindPairsWithAdjacentFloatingPointCoordinates) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  const Real far = std::numeric_limits<Real>::max();
  for (const double radius : {0.1, 0.3, 0.7}) {
    typename TestFixture::Points points;
    for (int cell = -9; cell <= 9; ++cell) {
      const Real face = Real(cell) * Real(radius);
      for (const Real x : {std::nextafter(face, -far), face, std::nextafter(face, far)}) {
        typename TestFixture::Point at = TestFixture::Point::Constant(face);
        at[0] = x;
        at[dim - 1] = -x;
        points.push_back(at);
      }
    }
    this->expect_right(points, radius);
  }
}

TYPED_TEST(AllSearches, FindEveryPairForAnyExtent) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  // The upper corner of the particles is at the end of the last cell, up to a rounding error.
  for (int thirds = 1; thirds < 400; ++thirds) {
    const Real extent = Real(thirds) / 3 * Real(0.1);
    typename TestFixture::Points points;
    for (const Real along : {Real(0), Real(0.5), Real(1)}) {
      points.push_back(TestFixture::Point::Constant(along * extent));
      points.push_back(TestFixture::Point::Constant(along * extent));
      points.back()[thirds % dim] -= Real(0.04);
    }
    auto particles = particles_at(points);
    auto found = TestFixture::search(0.1);
    found.update(particles);
    ASSERT_EQ(neighbour_pairs(particles, found), brute_force_pairs(particles, found.radius()))
        << thirds;
  }
}

TYPED_TEST(AllSearches, FindCoincidentPoints) {
  using V = typename TestFixture::Point;
  this->expect_right({V::Zero(), V::Zero(), V::Zero(), V::Ones()}, 0.5);
}

TYPED_TEST(AllSearches, FindNothingAmongZeroAndOneParticle) {
  using V = typename TestFixture::Point;
  this->expect_right({}, 1);
  this->expect_right({V::Ones()}, 1);
}

TYPED_TEST(AllSearches, ExcludePairsAtExactlyTheRadius) {
  using V = typename TestFixture::Point;
  using Real = typename TestFixture::Number;
  const auto unit = [](Real x) { return V(x * V::Unit(0)); };
  const Box<TestFixture::dimension, Real> space;
  EXPECT_EQ(this->pair_count({unit(0), unit(1)}, 1, space), 0u);
  EXPECT_EQ(this->pair_count({unit(0), unit(std::nextafter(Real(1), Real(0)))}, 1, space), 1u);
}

TYPED_TEST(AllSearches, FindPairsAcrossEveryCombinationOfPeriodicSides) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  for (unsigned sides = 1; sides < 1u << dim; ++sides) {
    auto box = cube<dim, Real>(-1, 2);
    box.upper[0] = 1;
    for (std::size_t k = 0; k < dim; ++k) box.periodic[k] = sides >> k & 1u;
    this->expect_right(random_points(120, box, sides), 0.4, box);
    this->expect_right(random_points(40, box, sides), 0.8, box);
  }
}

TYPED_TEST(AllSearches, FindAPairAcrossASideAnEdgeAndACorner) {
  using Real = typename TestFixture::Number;
  using V = typename TestFixture::Point;
  constexpr int dim = TestFixture::dimension;
  auto box = cube<dim, Real>(0, 1);
  box.periodic.fill(true);
  const V low = V::Constant(Real(0.0625));
  for (int sides = 1; sides <= dim; ++sides) {
    V high = low;
    for (int k = 0; k < sides; ++k) high[k] = Real(0.9375);
    auto particles = particles_at<dim, Real>({low, high}, box);
    auto found = TestFixture::search(0.25);
    found.update(particles);
    const auto reported = pairs(particles, found);
    ASSERT_EQ(reported.size(), 1u) << sides << " sides";
    // r_ij is −1/8 across each of the sides.
    for (int k = 0; k < dim; ++k) {
      EXPECT_EQ(std::get<2>(reported[0])[static_cast<std::size_t>(k)],
                k < sides ? Real(-0.125) : Real(0));
    }
  }
}

TYPED_TEST(AllSearches, FindPairsAcrossASideForCoordinatesOnTheSide) {
  using Real = typename TestFixture::Number;
  using V = typename TestFixture::Point;
  constexpr int dim = TestFixture::dimension;
  auto box = cube<dim, Real>(-1, 1);
  box.periodic.fill(true);
  const Real one = 1;
  const V inner = V::Constant(Real(-0.9));
  for (const Real edge : {std::nextafter(-one, Real(-2)), -one, std::nextafter(-one, Real(0)),
                          std::nextafter(one, Real(0)), one, std::nextafter(one, Real(2))}) {
    EXPECT_EQ(this->pair_count({V::Constant(edge), inner}, 0.25, box), 1u) << double(edge);
    // No pair at half the length of the box.
    EXPECT_EQ(this->pair_count({V::Constant(edge), V::Zero()}, 0.25, box), 0u) << double(edge);
  }
}

TYPED_TEST(AllSearches, FindTheSameAfterAddingRemovingAndReordering) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  for (const bool periodic : {false, true}) {
    auto box = cube<dim, Real>(0, 2);
    box.periodic.fill(periodic);
    auto particles = particles_at(random_points(150, box, 6), box);
    auto found = TestFixture::search(0.35);
    this->expect_right(particles, found);

    for (const auto& x : random_points(50, box, 7)) particles.add(x);
    this->expect_right(particles, found);

    particles.remove_if([](Index i) { return i % 3 == 0; });
    this->expect_right(particles, found);

    std::vector<Index> order(particles.size());
    std::iota(order.rbegin(), order.rend(), Index{0});
    particles.reorder(order);
    this->expect_right(particles, found);
  }
}

TYPED_TEST(AllSearches, FindTheSameAfterAnotherRadiusAndAnotherBox) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  auto box = cube<dim, Real>(0, 2);
  auto particles = particles_at(random_points(150, box, 8), box);
  auto found = TestFixture::search(0.3);
  this->expect_right(particles, found);
  found.set_radius(Real(0.5));
  this->expect_right(particles, found);
  box.periodic[0] = true;
  particles.set_box(box);
  this->expect_right(particles, found);
}

TYPED_TEST(AllSearches, FindEveryPairWhileParticlesMove) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  for (const bool periodic : {false, true}) {
    auto box = cube<dim, Real>(0, 2);
    box.periodic.fill(periodic);
    auto particles = particles_at(random_points(80, box, 9), box);
    auto found = TestFixture::search(0.4);
    for (unsigned step = 0; step < 40; ++step) {
      const auto moves = random_points(80, cube<dim, Real>(Real(-0.02), Real(0.02)), 100 + step);
      for (Index i = 0; i < particles.size(); ++i) particles[position][i] += moves[i];
      found.update(particles);
      // Rounding of x + period affects pairs at the radius; compare numbers, not bits.
      ASSERT_EQ(neighbour_pairs(particles, found).size(), [&] {
        auto wrapped = particles;
        for (auto& x : wrapped[position]) x = box.wrap(x);
        return brute_force_pairs(wrapped, found.radius()).size();
      }()) << step;
    }
  }
}

TYPED_TEST(AllSearches, RejectAPeriodicSideShorterThanTwoRadii) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  auto box = cube<dim, Real>(0, 1);
  box.periodic[1] = true;
  auto particles = particles_at(random_points(5, box, 1), box);
  auto found = TestFixture::search(0.75);
  EXPECT_TRUE(refuses([&] { found.update(particles); }, {"periodic side 1 m", "axis 1", "radius"}));
}

TYPED_TEST(AllSearches, RejectInvalidRadii) {
  using Real = typename TestFixture::Number;
  const Real nan = std::numeric_limits<Real>::quiet_NaN();
  const Real inf = std::numeric_limits<Real>::infinity();
  EXPECT_TRUE(refuses([&] { TestFixture::search(-1); }, {"radius = -1"}));
  EXPECT_TRUE(refuses([&] { TestFixture::search(nan); }, {"radius = nan"}));
  EXPECT_TRUE(refuses([&] { TestFixture::search(inf); }, {"radius = inf"}));
  auto found = TestFixture::search(1);
  for (const Real wrong : {nan, inf, Real(0), Real(-2)}) {
    EXPECT_TRUE(refuses([&] { found.set_radius(wrong); }, {"radius = " + to_text(double(wrong))}));
  }
  EXPECT_EQ(found.radius(), Real(1));
  auto particles = particles_at<TestFixture::dimension, Real>({TestFixture::Point::Zero()});
  auto unset = TestFixture::search(0);
  EXPECT_TRUE(refuses([&] { unset.update(particles); }, {"radius = 0"}));
}

TYPED_TEST(AllSearches, ReportTheParticleWhosePositionIsNotFinite) {
  using Real = typename TestFixture::Number;
  constexpr int dim = TestFixture::dimension;
  for (const bool periodic : {false, true}) {
    for (const Real wrong :
         {std::numeric_limits<Real>::quiet_NaN(), std::numeric_limits<Real>::infinity()}) {
      auto box = cube<dim, Real>(0, 2);
      box.periodic.fill(periodic);
      auto particles = particles_at(random_points(9, box, 1), box);
      particles.remove(3);
      particles[position][5][1] = wrong;
      auto found = TestFixture::search(0.5);
      EXPECT_TRUE(refuses([&] { found.update(particles); }, {"position", "particle 5", "id 6"}))
          << periodic << " " << double(wrong);
    }
  }
}

TEST(SearchRadius, IsCheckedWhenItIsUsed) {
  auto grains = crowd<2, double>(70, 1);
  EXPECT_TRUE(refuses([&] { UniformGrid<2>().sort(grains); }, {"UniformGrid: radius = 0"}));
  EXPECT_TRUE(refuses([&] { NeighbourList<2>().sort(grains); }, {"NeighbourList: radius = 0"}));
  EXPECT_TRUE(
      refuses([&] { LevelGrid<2>().sort(grains); }, {"LevelGrid: radius = 0", "positive"}));
  EXPECT_TRUE(
      refuses([&] { LevelGrid<2>().update(grains); }, {"LevelGrid: radius = 0", "positive"}));
  EXPECT_TRUE(refuses([] { UniformGrid<2>().set_radius(0); }, {"UniformGrid: radius = 0"}));
  EXPECT_TRUE(refuses([] { NeighbourList<2>().set_radius(0); }, {"NeighbourList: radius = 0"}));
  EXPECT_TRUE(refuses([] { LevelGrid<2>().set_radius(-1); }, {"LevelGrid: radius = -1"}));
}

}  // namespace
}  // namespace silt::test::all_searches_test
