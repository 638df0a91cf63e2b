// SPDX-License-Identifier: MIT
// The pressure equation: properties of the linear system and of its solution.
#include "support/check.hpp"
#include "support/fluid.hpp"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace silt::test::pressure_test {
namespace {

using mps::CubicKernel;
using mps::Kind;
using mps::PressureEquation;
using Reason = SolveReport::Reason;

// Particles and their pressure equation, with its search and stencil.
template <int Dim, class Real = double>
struct Problem {
  static constexpr Real l0 = Real(0.1);

  explicit Problem(mps::Fluid<Dim, Real> fluid) : particles(std::move(fluid)) {
    search.set_radius(stencil.re);
    search.update(particles);
  }

  // Marks particles within one and a half spacings of the faces of the cube as free surface.
  void open(int along) {
    for (Index i = 0; i < particles.size(); ++i) {
      const auto& x = particles[position][i];
      particles[mps::surface][i] =
          x.minCoeff() < Real(1.5) * l0 || x.maxCoeff() > (Real(along) - Real(1.5)) * l0;
    }
  }

  template <class F>
  void assemble(F&& source) {
    equation.assemble(particles, search, stencil, source);
  }
  void assemble_uniform(double source) {
    assemble([source](Index) { return source; });
  }
  SolveReport solve(const SolveSettings& settings = {.tolerance = 1e-11}) {
    ConjugateGradient<> solver(settings);
    return equation.solve(particles, solver);
  }

  const LinearSystem& system() const { return equation.system(); }

  Eigen::MatrixXd matrix() const {
    const auto n = static_cast<Eigen::Index>(system().size());
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (Index row = 0; row < system().size(); ++row) {
      const auto r = static_cast<Eigen::Index>(row);
      a(r, r) = system().diagonal[row];
      system().off_diagonal.for_each_entry(row, [&](Index column, double value) {
        a(r, static_cast<Eigen::Index>(column)) += value;
      });
    }
    return a;
  }

  double laplacian_of_pressure(Index i) {
    particles.refresh_ghosts(mps::pressure);
    return double(
        mps::laplacian(search, stencil, i, particles.with_ghosts(mps::pressure)));
  }

  mps::Fluid<Dim, Real> particles;
  UniformGrid<Dim, Real> search;
  mps::Stencil<Dim, Real, CubicKernel> stencil{{.spacing = l0, .radius = 3.1}};
  PressureEquation equation;
};

template <class S>
class Equations : public ::testing::Test {};
TYPED_TEST_SUITE(Equations, Spaces);

TYPED_TEST(Equations, OfOpenFluidAreSymmetricAndPositiveDefinite) {
  using Real = typename TypeParam::Real;
  constexpr int along = TypeParam::dimension == 2 ? 12 : 7;
  Problem<TypeParam::dimension, Real> problem(
      blob<TypeParam::dimension, Real>(along, Real(0.1), Real(0.25)));
  problem.open(along);
  problem.assemble_uniform(-1);
  const auto a = problem.matrix();
  ASSERT_GT(a.rows(), 20);
  EXPECT_TRUE(a == a.transpose()) << "bitwise";
  EXPECT_EQ(a.llt().info(), Eigen::Success);
  // No positive off-diagonal entry and no negative row sum: a maximum principle holds.
  for (Eigen::Index r = 0; r < a.rows(); ++r) {
    EXPECT_LE(a.row(r).sum() - a(r, r), 0);
    EXPECT_GE(a.row(r).sum(), -1e-12 * a(r, r));
  }
}

TYPED_TEST(Equations, OfAPeriodicBoxAreSymmetricToRoundOff) {
  using Real = typename TypeParam::Real;
  Problem<TypeParam::dimension, Real> problem(
      full_box<TypeParam::dimension, Real>(7, Real(0.1), Real(0.25)));
  problem.assemble_uniform(-1);
  const auto a = problem.matrix();
  EXPECT_EQ(a.rows(), static_cast<Eigen::Index>(problem.particles.size()));
  EXPECT_LE((a - a.transpose()).norm(), double(TypeParam::rounding) * a.norm());
}

TYPED_TEST(Equations, GiveCompressedFluidAPositivePressureEverywhere) {
  using Real = typename TypeParam::Real;
  constexpr int along = TypeParam::dimension == 2 ? 12 : 7;
  for (const double sign : {1.0, -1.0}) {
    Problem<TypeParam::dimension, Real> problem(
        blob<TypeParam::dimension, Real>(along, Real(0.1), Real(0.25)));
    problem.open(along);
    problem.assemble_uniform(-1e6 * sign);
    ASSERT_EQ(problem.solve().reason, Reason::converged);
    for (Index i = 0; i < problem.particles.size(); ++i) {
      const double p = sign * double(problem.particles[mps::pressure][i]);
      if (problem.particles[mps::surface][i]) {
        EXPECT_EQ(p, 0);
      } else {
        EXPECT_GT(p, 0);
      }
    }
  }
}

template <int Dim>
void expect_that_the_laplacian_is_the_source() {
  constexpr int along = Dim == 2 ? 14 : 8;
  Problem<Dim> problem(blob<Dim, double>(along, 0.1, 0.25));
  problem.open(along);
  const auto source = [](Index i) { return 1e5 * std::sin(double(i)) - 3e4; };
  problem.assemble(source);
  const SolveReport report = problem.solve();
  EXPECT_EQ(report.reason, Reason::converged);
  EXPECT_EQ(report.unknowns, problem.system().size());
  Index unknowns = 0;
  for (Index i = 0; i < problem.particles.size(); ++i) {
    if (problem.particles[mps::surface][i]) continue;
    ++unknowns;
    EXPECT_NEAR(problem.laplacian_of_pressure(i), source(i), 1e-2);
  }
  EXPECT_EQ(unknowns, report.unknowns);
}

TEST(PressureEquation, HasASolutionWhoseLaplacianIsTheSource) {
  expect_that_the_laplacian_is_the_source<2>();
  expect_that_the_laplacian_is_the_source<3>();
}

TEST(PressureEquation, OfAClosedFullBoxHasASolutionWithMinimumPressureZero) {
  Problem<2> problem(full_box<2, double>(10, 0.1, 0.2));
  const auto source = [](Index i) { return 1e5 * std::sin(double(i)) - 3e4; };
  problem.assemble(source);
  ASSERT_EQ(problem.solve().reason, Reason::converged);
  const auto p = problem.particles[mps::pressure];
  EXPECT_EQ(*std::min_element(p.begin(), p.end()), 0);
  // A closed body cannot expand: the mean of the source is subtracted.
  double mean = 0;
  for (Index i = 0; i < p.size(); ++i) mean += source(i) / double(p.size());
  for (Index i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(problem.laplacian_of_pressure(i), source(i) - mean, 1e-2);
  }
}

TEST(PressureEquation, ChoosesTheConstantOfEachClosedBodySeparately) {
  auto points = jittered<2, double>(6, 0.1, 0.2);
  const Index one_body = points.size();
  for (Index i = 0; i < one_body; ++i) points.push_back(points[i] + Vec<2>(5, 0));
  Problem<2> problem(fluid_at(points));
  problem.assemble([&](Index i) { return (i < one_body ? 1e4 : 7e5) * std::cos(double(i)); });
  ASSERT_EQ(problem.solve().reason, Reason::converged);
  const auto p = problem.particles[mps::pressure];
  EXPECT_EQ(*std::min_element(p.begin(), p.begin() + std::ptrdiff_t(one_body)), 0);
  EXPECT_EQ(*std::min_element(p.begin() + std::ptrdiff_t(one_body), p.end()), 0);
}

TEST(PressureEquation, ExcludesIsolatedParticles) {
  auto points = jittered<2, double>(6, 0.1, 0.1);
  points.push_back({3, 3});
  Problem<2> problem(fluid_at(points));
  problem.particles[mps::pressure].back() = 12;
  problem.particles[mps::surface][0] = 1;
  problem.assemble_uniform(-1e5);
  EXPECT_EQ(problem.system().size(), points.size() - 2);
  ASSERT_EQ(problem.solve().reason, Reason::converged);
  EXPECT_EQ(problem.particles[mps::pressure].back(), 0);
  for (const double p : problem.particles[mps::pressure]) EXPECT_TRUE(is_finite(p));
}

TEST(PressureEquation, HasUnknownsForFluidAndWallsButNotForDummies) {
  auto tank = small_dam<2>();
  Problem<2> problem(std::move(tank));
  problem.assemble_uniform(-1);
  EXPECT_EQ(problem.system().size(), mps::count(problem.particles, Kind::fluid) +
                                         mps::count(problem.particles, Kind::wall));
}

TEST(PressureEquation, WithoutUnknownsHasNothingToSolve) {
  Problem<2> problem(blob<2, double>(5, 0.1, 0.1));
  for (auto& each : problem.particles[mps::surface]) each = 1;
  for (auto& p : problem.particles[mps::pressure]) p = 5;
  problem.assemble_uniform(-1);
  const SolveReport report = problem.solve();
  EXPECT_EQ(report.reason, Reason::nothing_to_solve);
  EXPECT_EQ(report.unknowns, 0u);
  for (const double p : problem.particles[mps::pressure]) EXPECT_EQ(p, 0);

  Problem<2> empty(mps::Fluid<2>{});
  empty.assemble_uniform(-1);
  EXPECT_EQ(empty.solve().reason, Reason::nothing_to_solve);
}

TEST(PressureEquation, WithoutSourceHasNoPressure) {
  Problem<2> problem(blob<2, double>(12, 0.1, 0.1));
  problem.open(12);
  for (auto& p : problem.particles[mps::pressure]) p = 5;
  problem.assemble_uniform(0);
  EXPECT_EQ(problem.solve().iterations, 0);
  for (const double p : problem.particles[mps::pressure]) EXPECT_EQ(p, 0);
}

TEST(PressureEquation, UsesThePresentPressuresAsInitialGuess) {
  Problem<2> problem(blob<2, double>(16, 0.1, 0.1));
  problem.open(16);
  problem.assemble_uniform(-1e4);
  const SolveSettings settings{.tolerance = 1e-8};
  EXPECT_GT(problem.solve(settings).iterations, 3);
  const auto before = state_of(problem.particles);
  EXPECT_EQ(problem.solve(settings).iterations, 0);
  EXPECT_TRUE(state_of(problem.particles) == before);
}

TEST(PressureEquation, LeavesThePressuresUnchangedIfTheSolveFails) {
  Problem<2> problem(blob<2, double>(16, 0.1, 0.1));
  problem.open(16);
  for (auto& p : problem.particles[mps::pressure]) p = 77;
  problem.assemble([](Index i) { return std::sin(double(i)); });
  const auto before = state_of(problem.particles);
  const SolveReport report = problem.solve({.tolerance = 1e-12, .max_iterations = 2});
  EXPECT_EQ(report.reason, Reason::not_converged);
  EXPECT_TRUE(state_of(problem.particles) == before);
}

// A weight that does not depend on the distance; right sides are minus the sources.
struct UniformWeight {
  static constexpr int dimension = 2;
  double spacing = 1;
  double re = 1.5;
  double n0 = 1;
  double lambda = 4;
  double value = 1;

  double weight(double) const { return value; }
};

template <class Source>
LinearSystem system_with(const std::vector<Vec<2>>& points, const UniformWeight& stencil,
                         Source&& source) {
  auto fluid = fluid_at(points);
  UniformGrid<2> search({.radius = stencil.re});
  search.update(fluid);
  PressureEquation equation;
  equation.assemble(fluid, search, stencil, source);
  return equation.system();
}

TEST(PressureEquation, IgnoresWeightsThatAreRoundOffOfAFullNeighbourhood) {
  const auto unknowns = [](double weight) {
    const auto source = [](Index i) { return double(i); };
    return system_with({{0, 0}, {1, 0}}, {.n0 = 4, .value = weight}, source).size();
  };
  EXPECT_EQ(unknowns(0x1p-24), 0u);
  EXPECT_EQ(unknowns(0x1p-24 * (1 + 0x1p-20)), 2u);
}

TEST(PressureEquation, HasNoSourceInAClosedBodyWhoseSourcesAreEqualToRoundOff) {
  // Two closed bodies; the sources of the second are much smaller.
  constexpr Index one_body = 30;
  std::vector<Vec<2>> points;
  for (Index i = 0; i < 2 * one_body; ++i) {
    points.push_back({double(i % one_body), i < one_body ? 0.0 : 9.0});
  }
  const auto right_side = [&](double difference) {
    const LinearSystem system = system_with(points, {}, [=](Index i) {
      return i < one_body ? 0.1 * (i % 2 == 0 ? 1 + difference : 1 - difference)
                          : 1e-20 * double(i);
    });
    EXPECT_EQ(system.closed_bodies, 2u);
    const auto& b = system.right_side;
    for (Index i = one_body; i < 2 * one_body; ++i) {
      EXPECT_NEAR(b[i], 1e-20 * (1.5 * one_body - 0.5 - double(i)), 1e-32);
    }
    return std::vector<double>(b.begin(), b.begin() + std::ptrdiff_t(one_body));
  };
  for (const double difference : {0.0, 2e-16, 7e-15}) {
    EXPECT_EQ(right_side(difference), std::vector<double>(one_body, 0)) << difference;
  }
  for (const double b : right_side(1.5e-14)) EXPECT_NEAR(std::abs(b), 1.5e-15, 1e-16);
}

}  // namespace
}  // namespace silt::test::pressure_test
