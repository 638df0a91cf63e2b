// SPDX-License-Identifier: MIT
// Multigrid on background cells as a preconditioner: symmetric, positive definite and effective.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <silt/solve/cell_multigrid.hpp>
#include <silt/solve/conjugate_gradient.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace silt::test::cell_multigrid_test {
namespace {

static_assert(Preconditioner<CellMultigrid<2>> && Preconditioner<CellMultigrid<3>>);
static_assert(LinearSolver<ConjugateGradient<CellMultigrid<3>>>);

// The pressure equation of a cube of fluid, with or without a free surface on top.
template <int Dim>
LinearSystem pressure_equation(int along, bool open, int walls = 0) {
  const double l0 = 0.01;
  auto fluid = blob<Dim, double>(along, l0, 0.2);
  for (Index i = 0; i < fluid.size(); ++i) {
    // Walls of the minimum thickness that separates their sides, of three quarters of the height.
    const int column = int(fluid[position][i][0] / l0);
    const bool high = fluid[position][i][Dim - 1] > 0.75 * along * l0;
    for (int wall = 1; wall <= walls; ++wall) {
      const int from = wall * along / (walls + 1);
      if (!high && column >= from && column < from + 4) fluid[mps::kind][i] = mps::Kind::dummy;
    }
  }
  for (Index i = 0; i < fluid.size(); ++i) {
    fluid[mps::surface][i] = open && fluid[position][i][Dim - 1] > (along - 1) * l0;
  }
  const mps::Stencil<Dim, double, mps::CubicKernel> stencil({.spacing = l0, .radius = 3.1});
  UniformGrid<Dim> search({.radius = stencil.re});
  search.update(fluid);
  mps::PressureEquation equation;
  equation.assemble(fluid, search, stencil,
                    [](Index i) { return -1e4 - 2e3 * std::sin(double(i)); });
  return equation.system();
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (Index i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<double> waves(Index n, double number) {
  std::vector<double> x(n);
  for (Index i = 0; i < n; ++i) x[i] = std::cos(number * double(i)) + 0.2 * std::sin(double(i * i));
  return x;
}

template <int Dim>
void expect_symmetric_and_positive(int along, bool open, int walls = 0) {
  const LinearSystem system = pressure_equation<Dim>(along, open, walls);
  CellMultigrid<Dim> multigrid;
  multigrid.prepare(system);
  std::vector<std::vector<double>> r;
  std::vector<std::vector<double>> z;
  for (const double number : {0.001, 0.02, 0.3, 2.0}) {
    r.push_back(waves(system.size(), number));
    z.emplace_back(system.size());
    multigrid.apply(r.back(), z.back());
  }
  for (Index a = 0; a < r.size(); ++a) {
    EXPECT_GT(dot(r[a], z[a]), 0);
    for (Index b = 0; b < a; ++b) {
      const double size = std::sqrt(dot(r[a], z[a]) * dot(r[b], z[b]));
      EXPECT_NEAR(dot(r[a], z[b]), dot(r[b], z[a]), 1e-5 * size);  // single precision inside
    }
  }
}

TEST(CellMultigrid, IsSymmetricAndPositiveDefinite) {
  for (const bool open : {true, false}) {
    expect_symmetric_and_positive<2>(40, open);
    expect_symmetric_and_positive<2>(60, open, 3);
    expect_symmetric_and_positive<3>(12, open);
  }
}

template <class M>
SolveReport solved_by(const LinearSystem& system, std::vector<double>& x) {
  x.assign(system.size(), 0);
  return ConjugateGradient<M>({.tolerance = 1e-8}).solve(system, x);
}

TEST(CellMultigrid, GivesTheSameSolutionAsJacobi) {
  const LinearSystem system = pressure_equation<2>(30, true);
  std::vector<double> by_multigrid;
  std::vector<double> by_jacobi;
  EXPECT_EQ(solved_by<CellMultigrid<2>>(system, by_multigrid).reason,
            SolveReport::Reason::converged);
  solved_by<Jacobi>(system, by_jacobi);
  const double size = std::sqrt(dot(by_jacobi, by_jacobi));
  for (Index i = 0; i < system.size(); ++i) {
    EXPECT_NEAR(by_multigrid[i], by_jacobi[i], 1e-4 * size / std::sqrt(double(system.size())));
  }
}

TEST(CellMultigrid, NeedsAboutAsManyIterationsForMoreParticles) {
  std::vector<double> x;
  const auto iterations = [&](int along) {
    return solved_by<CellMultigrid<2>>(pressure_equation<2>(along, true), x).iterations;
  };
  const int few = iterations(25);
  const int many = iterations(100);
  EXPECT_LT(many, 1.6 * few);
  EXPECT_LT(2 * many, solved_by<Jacobi>(pressure_equation<2>(100, true), x).iterations);
}

TEST(CellMultigrid, SeparatesTheSidesOfThinWalls) {
  std::vector<double> x;
  const auto iterations = [&](int walls) {
    return solved_by<CellMultigrid<2>>(pressure_equation<2>(110, true, walls), x).iterations;
  };
  const int without = iterations(0);
  for (const int walls : {1, 3, 8}) EXPECT_LT(iterations(walls), 1.7 * without) << walls;
}

TEST(CellMultigrid, IsBitwiseIdenticalForAnyNumberOfThreads) {
  const LinearSystem system = pressure_equation<2>(80, true);
  const auto by = [&](int number) {
    return with_threads(number, [&] {
      std::vector<double> x;
      solved_by<CellMultigrid<2>>(system, x);
      return x;
    });
  };
  const auto serial = by(1);
  for (const int number : {2, 3, 4}) EXPECT_TRUE(by(number) == serial) << number;
}

TEST(CellMultigrid, WithoutPositionsOfTheUnknownsIsTheDiagonal) {
  LinearSystem system;
  system.diagonal = {2, 4, 8};
  system.off_diagonal.build(3, [](Index, auto&&) {});
  system.right_side = {1, 1, 1};
  CellMultigrid<2> multigrid;
  multigrid.prepare(system);
  std::vector<double> z(3);
  multigrid.apply({1, 1, 1}, z);
  EXPECT_EQ(z, (std::vector<double>{0.5, 0.25, 0.125}));
}

// A system of which the multigrid sees only diagonals and positions: on cells of two spacings, the
// stiffness of a point is twice its diagonal without the weights to the surface.
LinearSystem system_at(const std::vector<std::array<double, 3>>& points,
                       const std::vector<double>& diagonal, const std::vector<float>& to_surface) {
  LinearSystem system;
  system.diagonal = diagonal;
  system.off_diagonal.build(points.size(), [](Index, auto&&) {});
  system.right_side.assign(points.size(), 1);
  system.geometry.spacing = 1;
  system.geometry.full_diagonal = 4;
  system.geometry.second_moment = 16;
  system.geometry.points.assign(points);
  system.geometry.to_surface.assign(to_surface);
  return system;
}

// A closed square of along × along points.
LinearSystem closed_square(int along) {
  std::vector<std::array<double, 3>> points;
  for (int y = 0; y < along; ++y) {
    for (int x = 0; x < along; ++x) points.push_back({x + 0.5, y + 0.5, 0});
  }
  return system_at(points, std::vector<double>(points.size(), 4),
                   std::vector<float>(points.size(), 0));
}

// V r: what the multigrid adds to the diagonal.
std::vector<double> correction(CellMultigrid<2> multigrid, const LinearSystem& system,
                               const std::vector<double>& r) {
  multigrid.prepare(system);
  std::vector<double> z(r.size());
  multigrid.apply(r, z);
  for (Index i = 0; i < r.size(); ++i) z[i] -= r[i] / system.diagonal[i];
  return z;
}

TEST(CellMultigrid, SolvesTheEquationOfTwoCellsExactly) {
  // One point in the centre of each cell, both with mass 1; stiffnesses 4 and 8, conductance 6.
  const LinearSystem system = system_at({{1, 1, 0}, {3, 1, 0}}, {3, 5}, {1, 1});
  const auto even = correction({}, system, {1, 1});
  const auto odd = correction({}, system, {1, -1});
  for (const Index i : {0u, 1u}) EXPECT_NEAR(even[i], 1, 1e-6);
  EXPECT_NEAR(odd[0], 1 / (1 + 2 * 6.0), 1e-6);
  EXPECT_NEAR(odd[1], -1 / (1 + 2 * 6.0), 1e-6);
}

TEST(CellMultigrid, ExcludesRowsWithADiagonalBelowTheMinimum) {
  const auto second = [](double diagonal) {
    const LinearSystem system = system_at({{1, 1, 0}, {9, 9, 0}}, {4, diagonal}, {1, 0.5});
    return correction(CellMultigrid<2>({.min_diagonal = 0.25}), system, {1, 1})[1];
  };
  EXPECT_NEAR(second(1), 1 / 0.5, 1e-6);
  EXPECT_EQ(second(std::nextafter(1, 0)), 0);
}

TEST(CellMultigrid, CoarsensUntilTheMaximumNumberOfCellsIsReached) {
  const LinearSystem system = closed_square(16);  // 8 × 8 cells
  const auto levels = [&](Index max_coarsest_cells) {
    CellMultigrid<2> multigrid({.max_coarsest_cells = max_coarsest_cells});
    multigrid.prepare(system);
    return multigrid.levels();
  };
  EXPECT_EQ(levels(64), 1u);
  EXPECT_EQ(levels(63), 2u);
  EXPECT_EQ(levels(16), 2u);
  EXPECT_EQ(levels(15), 3u);
  EXPECT_EQ(levels(4), 3u);
  EXPECT_EQ(levels(3), 4u);
}

// The equation of a closed body determines the constant only by the minimum masses of its cells.
TEST(CellMultigrid, GivesAClosedBodyTheSameConstantWithAnyNumberOfLevels) {
  const LinearSystem system = closed_square(16);
  const auto mean = [&](Index max_coarsest_cells) {
    double sum = 0;
    for (const double z : correction(CellMultigrid<2>({.max_coarsest_cells = max_coarsest_cells}),
                                     system, std::vector<double>(system.size(), 1))) {
      sum += z / double(system.size());
    }
    return sum;
  };
  const double direct = mean(64);
  for (const Index cells : {16u, 4u, 1u}) EXPECT_NEAR(mean(cells) / direct, 1, 0.04) << cells;
}

TEST(CellMultigrid, RejectsSettingsOutOfRange) {
  EXPECT_TRUE(refuses([] { CellMultigrid<2>({.cell_size = 0.5}); },
                      {"CellMultigrid: cell_size = 0.5"}));
  EXPECT_TRUE(refuses([] { CellMultigrid<2>({.min_diagonal = -1}); },
                      {"CellMultigrid: min_diagonal = -1"}));
  EXPECT_TRUE(refuses([] { CellMultigrid<2>({.sweeps = 0}); }, {"CellMultigrid: sweeps = 0"}));
  EXPECT_TRUE(refuses([] { CellMultigrid<3>({.max_coarsest_cells = 0}); },
                      {"CellMultigrid: max_coarsest_cells = 0"}));
}

}  // namespace
}  // namespace silt::test::cell_multigrid_test
