// SPDX-License-Identifier: MIT
// Kernels, and their sums over the full lattice.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace silt::test::lattice_test {
namespace {

using mps::CubicKernel;
using mps::GaussianKernel;
using mps::InverseKernel;
using mps::Kernel;
using mps::lattice_values;
using mps::LatticeValues;

struct OnlyForDoubles {
  static double weight(double q) { return 1 - q; }
};
struct WithNumbers {
  double height = 1;

  template <class Real>
  Real weight(Real q) const {
    return Real(height) * (1 - q);
  }
};
static_assert(Kernel<InverseKernel> && Kernel<GaussianKernel> && Kernel<CubicKernel>);
static_assert(!Kernel<OnlyForDoubles> && !Kernel<double>);
static_assert(Kernel<WithNumbers>);

// n0, λ/l0² and N0 on the square lattice, to the digits given.
struct Row {
  double radius, n0, lambda;
  int neighbours;
};

TEST(LatticeValues, DependOnTheNumbersOfTheKernel) {
  const LatticeValues one = lattice_values<2, WithNumbers>(3.1);
  const LatticeValues two = lattice_values<2>(3.1, WithNumbers{.height = 2});
  EXPECT_DOUBLE_EQ(two.n0, 2 * one.n0);
  EXPECT_DOUBLE_EQ(two.lambda, one.lambda);
}

template <class K>
void expect_table(const std::vector<Row>& table) {
  for (const Row& row : table) {
    const LatticeValues values = lattice_values<2, K>(row.radius);
    EXPECT_NEAR(values.n0, row.n0, 0.5001e-4) << row.radius;
    EXPECT_NEAR(values.lambda, row.lambda, 0.5001e-4) << row.radius;
    EXPECT_EQ(values.neighbours, row.neighbours) << row.radius;
  }
}

TEST(LatticeValues, AreThoseOfTheSquareLattice) {
  expect_table<InverseKernel>(
      {{2.1, 6.5397, 1.3884, 12}, {3.1, 18.9764, 2.4485, 28}, {4.0, 35.6092, 3.7071, 44}});
  expect_table<GaussianKernel>(
      {{2.1, 1.2015, 1.2241, 12}, {3.1, 3.7789, 1.8976, 28}, {4.0, 6.9540, 2.8515, 44}});
  expect_table<CubicKernel>(
      {{2.1, 2.5053, 1.2644, 12}, {3.1, 6.5617, 2.2262, 28}, {4.0, 11.5723, 3.4844, 44}});
}

// Lattice points at each squared distance, as coefficients of the power (Σ_x t^(x²))^d.
std::vector<int> points_at_squared_distance(int dimension, int limit) {
  std::vector<int> along(static_cast<Index>(limit), 0);
  for (int x = 0; x * x < limit; ++x) along[static_cast<Index>(x * x)] = x == 0 ? 1 : 2;
  std::vector<int> product = along;
  for (int k = 1; k < dimension; ++k) {
    std::vector<int> next(along.size(), 0);
    for (Index a = 0; a < along.size(); ++a) {
      for (Index b = 0; a + b < along.size(); ++b) next[a + b] += product[a] * along[b];
    }
    product = next;
  }
  return product;
}

template <int Dim, class K>
void expect_sum_over_shells(double radius) {
  const auto points = points_at_squared_distance(Dim, 40);
  double n0 = 0;
  double moment = 0;
  int neighbours = 0;
  for (int k = 1; k < radius * radius; ++k) {
    const int shell = points[static_cast<Index>(k)];
    const double w = K::weight(std::sqrt(double(k)) / radius);
    n0 += shell * w;
    moment += shell * w * k;
    neighbours += shell;
  }
  const LatticeValues values = lattice_values<Dim, K>(radius);
  EXPECT_NEAR(values.n0, n0, 1e-13 * n0) << radius;
  EXPECT_NEAR(values.lambda, moment / n0, 1e-13 * values.lambda) << radius;
  EXPECT_EQ(values.neighbours, neighbours) << radius;
}

TEST(LatticeValues, AreSumsOverShellsOfEqualDistance) {
  for (const double radius : {1.5, 2.1, 3.1, 4.0, 5.5}) {
    expect_sum_over_shells<2, InverseKernel>(radius);
    expect_sum_over_shells<2, GaussianKernel>(radius);
    expect_sum_over_shells<2, CubicKernel>(radius);
    expect_sum_over_shells<3, InverseKernel>(radius);
    expect_sum_over_shells<3, GaussianKernel>(radius);
    expect_sum_over_shells<3, CubicKernel>(radius);
  }
}

TEST(LatticeValues, CountTheKnownShellsOfTheCubicLattice) {
  EXPECT_EQ((lattice_values<3, CubicKernel>(1.1).neighbours), 6);
  EXPECT_EQ((lattice_values<3, CubicKernel>(1.5).neighbours), 18);
  EXPECT_EQ((lattice_values<3, CubicKernel>(1.8).neighbours), 26);
  EXPECT_EQ((lattice_values<3, CubicKernel>(2.1).neighbours), 32);
  EXPECT_EQ((lattice_values<3, CubicKernel>(3.1).neighbours), 122);
}

TEST(LatticeValues, ExcludePointsExactlyAtTheRadius) {
  EXPECT_EQ((lattice_values<2, CubicKernel>(2.0).neighbours), 8);
  EXPECT_EQ((lattice_values<2, CubicKernel>(std::nextafter(2.0, 3.0)).neighbours), 12);
}

TEST(LatticeValues, OfTheNearestNeighboursAloneHaveTheirSquaredDistanceAsLambda) {
  EXPECT_DOUBLE_EQ((lattice_values<2, InverseKernel>(1.2).lambda), 1);
  EXPECT_DOUBLE_EQ((lattice_values<3, GaussianKernel>(1.2).lambda), 1);
}

TEST(LatticeValues, RejectARadiusWithoutNeighbours) {
  EXPECT_TRUE(refuses([] { lattice_values<2, CubicKernel>(1.0); }, {"radius = 1 "}));
  EXPECT_TRUE(refuses([] { lattice_values<3, CubicKernel>(-2); }, {"radius = -2 "}));
  EXPECT_TRUE(refuses([] { lattice_values<2, CubicKernel>(nan); }, {"radius = nan"}));
  EXPECT_TRUE(refuses([] { lattice_values<2, CubicKernel>(inf); }, {"radius = inf"}));
}

template <class K>
class Kernels : public ::testing::Test {};
using AllKernels = ::testing::Types<InverseKernel, GaussianKernel, CubicKernel>;
TYPED_TEST_SUITE(Kernels, AllKernels);

TYPED_TEST(Kernels, ArePositiveAndDecreaseWithDistance) {
  double before = inf;
  for (double q = 0.01; q < 1; q += 0.01) {
    const double w = TypeParam::weight(q);
    EXPECT_GT(w, 0);
    EXPECT_LT(w, before);
    before = w;
  }
}

TYPED_TEST(Kernels, AgreeInFloatAndDoubleToRoundOff) {
  for (float q = 0.1f; q < 0.9f; q += 0.05f) {
    const double exact = TypeParam::weight(double(q));
    EXPECT_NEAR(TypeParam::weight(q), exact, 1e-5 * exact);
  }
}

TEST(InverseKernel, DivergesAtZeroDistance) {
  EXPECT_GT(InverseKernel::weight(1e-300), 1e299);
  EXPECT_EQ(InverseKernel::weight(1.0), 0);
}

TEST(GaussianKernel, IsDiscontinuousByTwoThousandthsAtTheRadius) {
  EXPECT_NEAR(GaussianKernel::weight(1.0), 0.0018, 1e-4);
  EXPECT_EQ(GaussianKernel::weight(0.0), 1);
}

TEST(CubicKernel, IsTwiceDifferentiableAtTheRadius) {
  EXPECT_EQ(CubicKernel::weight(0.0), 1);
  EXPECT_EQ(CubicKernel::weight(1.0), 0);
  // Two derivatives vanish at the radius: halving the distance to it divides the weight by eight.
  const double ratio = CubicKernel::weight(1 - 1e-4) / CubicKernel::weight(1 - 0.5e-4);
  EXPECT_NEAR(ratio, 8, 1e-3);
}

}  // namespace
}  // namespace silt::test::lattice_test
