// SPDX-License-Identifier: MIT
// Comparison of all solvers of the pressure equation: for the systems of a dam break and of a
// closed full tank, systems with a known solution, and systems that are difficult or invalid.
#include "support/check.hpp"
#include "support/fluid.hpp"
#include "support/slow_types.hpp"

#include <silt/solve/cell_multigrid.hpp>
#include <silt/solve/conjugate_gradient.hpp>
#include <silt/solve/eigen_conjugate_gradient.hpp>
#include <silt/solve/incomplete_cholesky.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::test::all_solvers_test {
namespace {

using Reason = SolveReport::Reason;

static_assert(LinearSolver<EigenConjugateGradient>);
static_assert(std::is_copy_assignable_v<EigenConjugateGradient>);

// A system and the initial guess of its solve.
struct Problem {
  LinearSystem system;
  std::vector<double> guess;
};

// The default solver, which stores the last problem.
class RecordingSolver {
 public:
  void check() const {}
  SolveReport solve(const LinearSystem& system, std::vector<double>& x) {
    *last_ = {system, x};
    return solver_.solve(system, x);
  }
  const Problem& last() const { return *last_; }

 private:
  std::shared_ptr<Problem> last_ = std::make_shared<Problem>();
  ConjugateGradient<CellMultigrid<2>> solver_;
};

// The pressure equation of the last of several steps of case 10.
Problem problem_of(mps::Fluid<2> water, int steps) {
  const RecordingSolver recording;
  Simulation sim{std::move(water), UniformGrid<2>{},
                 mps::Flow<mps::Case10, 2, double, RecordingSolver>(
                     {.spacing = 0.02, .max_time_step = 1e-3}, recording),
                 SemiImplicit{}};
  for (int k = 0; k < steps; ++k) sim.step();
  return recording.last();
}

const Problem& dam_break() {
  static const Problem problem = problem_of(small_dam<2>(), 60);
  return problem;
}

const Problem& closed_tank() {
  static const Problem problem = problem_of(
      mps::make_tank<2>({.column = {0.4, 0.3},
                         .size = {.length = 0.4, .height = 0.3},
                         .spacing = 0.02,
                         .lid = true}),
      20);
  return problem;
}

// The pressure equation of the particles; the free surface is that of their field.
LinearSystem equation_of(mps::Fluid<2>& fluid, const std::vector<double>& source,
                         double l0 = 0.02) {
  const mps::Stencil<2, double, mps::CubicKernel> stencil({.spacing = l0, .radius = 3.1});
  UniformGrid<2> search({.radius = stencil.re});
  search.update(fluid);
  mps::PressureEquation equation;
  equation.assemble(fluid, search, stencil, [&](Index i) { return source[i]; });
  return equation.system();
}

double max_abs(const std::vector<double>& x) {
  double max = 0;
  for (const double each : x) max = std::max(max, std::abs(each));
  return max;
}

double residual(const LinearSystem& system, const std::vector<double>& x) {
  std::vector<double> r = system.right_side;
  double of_b = 0;
  double of_r = 0;
  for (Index i = 0; i < system.size(); ++i) {
    of_b += r[i] * r[i];
    r[i] -= system.diagonal[i] * x[i];
    system.off_diagonal.for_each_entry(i, [&](Index j, double value) { r[i] -= value * x[j]; });
    of_r += r[i] * r[i];
  }
  return std::sqrt(of_r / of_b);
}

template <class S>
class AllSolvers : public ::testing::Test {};
using Solvers = AllOrUsual<
    ::testing::Types<ConjugateGradient<CellMultigrid<2>>, EigenConjugateGradient,
                     ConjugateGradient<Jacobi>, ConjugateGradient<IncompleteCholesky>>,
    ::testing::Types<ConjugateGradient<CellMultigrid<2>>, ConjugateGradient<IncompleteCholesky>>>;
TYPED_TEST_SUITE(AllSolvers, Solvers);

// Compares the solution by S with that by Eigen to a tolerance near round-off.
template <class S>
void expect_reference_solution(const Problem& problem) {
  std::vector<double> exact = problem.guess;
  ASSERT_EQ(EigenConjugateGradient({.tolerance = 1e-13}).solve(problem.system, exact).reason,
            Reason::converged);
  // The relative error of the pressures is up to 50 times the relative residual.
  for (const double tolerance : {1e-6, 1e-11}) {
    std::vector<double> x = problem.guess;
    const SolveReport report = S({.tolerance = tolerance}).solve(problem.system, x);
    EXPECT_EQ(report.reason, Reason::converged);
    EXPECT_EQ(report.unknowns, problem.system.size());
    EXPECT_GT(report.iterations, 2);
    EXPECT_LE(report.residual, tolerance * 1.001);
    EXPECT_NEAR(report.residual, residual(problem.system, x), 1e-13);
    double max_error = 0;
    for (Index i = 0; i < x.size(); ++i) max_error = std::max(max_error, std::abs(x[i] - exact[i]));
    EXPECT_LE(max_error, 50 * tolerance * max_abs(exact));
  }
}

TYPED_TEST(AllSolvers, AgreeOnADamBreak) {
  ASSERT_EQ(dam_break().system.closed_bodies, 0u);
  ASSERT_GT(dam_break().system.size(), 100u);
  expect_reference_solution<TypeParam>(dam_break());
}

TYPED_TEST(AllSolvers, AgreeOnAClosedFullTankIncludingTheConstant) {
  ASSERT_EQ(closed_tank().system.closed_bodies, 1u);
  expect_reference_solution<TypeParam>(closed_tank());
}

TYPED_TEST(AllSolvers, FindTheHydrostaticPressureOfAClosedFullTank) {
  // The right side for a linear pressure in a body without free surface.
  auto fluid = blob<2, double>(15, 0.02, 0.1);
  LinearSystem system = equation_of(fluid, std::vector<double>(fluid.size(), 0));
  ASSERT_EQ(system.closed_bodies, 1u);
  const auto hydrostatic = [&](Index i) { return 9810 * (0.3 - fluid[position][i][1]); };
  for (Index i = 0; i < system.size(); ++i) {
    system.right_side[i] = system.diagonal[i] * hydrostatic(i);
    system.off_diagonal.for_each_entry(
        i, [&](Index j, double value) { system.right_side[i] += value * hydrostatic(j); });
  }
  std::vector<double> x(system.size(), 0);
  EXPECT_EQ(TypeParam({.tolerance = 1e-11}).solve(system, x).reason, Reason::converged);
  const double constant = x[0] - hydrostatic(0);
  for (Index i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i] - constant, hydrostatic(i), 1e-5);
}

TYPED_TEST(AllSolvers, FindThePressureOfATaylorGreenVortex) {
  // −(ρ U²/4) (cos 4πx + cos 4πy) in a periodic square of edge 1 m; its Laplacian is the source.
  constexpr int along = 30;
  constexpr double l0 = 1.0 / along;
  constexpr double k = 4 * std::numbers::pi;
  auto fluid = full_box<2, double>(along, l0);
  const auto pressure = [&](Index i) {
    const auto& x = fluid[position][i];
    return -250 * (std::cos(k * x[0]) + std::cos(k * x[1]));
  };
  std::vector<double> source(fluid.size());
  for (Index i = 0; i < fluid.size(); ++i) source[i] = -k * k * pressure(i);
  const LinearSystem system = equation_of(fluid, source, l0);
  ASSERT_EQ(system.closed_bodies, 1u);
  std::vector<double> x(system.size(), 3);
  EXPECT_EQ(TypeParam({.tolerance = 1e-12}).solve(system, x).reason, Reason::converged);
  // On a lattice the wave is an eigenvector of the discrete Laplacian, with another eigenvalue.
  const double eigenvalue = (x[0] - x[7]) / (pressure(0) - pressure(7));
  EXPECT_NEAR(eigenvalue, 1, 0.04);  // 1 + O((k l0)²)
  for (Index i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i] - 3, eigenvalue * pressure(i), 1e-6);
}

TYPED_TEST(AllSolvers, ReportNothingToSolve) {
  std::vector<double> x;
  EXPECT_EQ(TypeParam().solve(LinearSystem{}, x).reason, Reason::nothing_to_solve);
  LinearSystem system = dam_break().system;
  system.right_side.assign(system.size(), 0);
  x.assign(system.size(), 7);
  const SolveReport report = TypeParam().solve(system, x);
  EXPECT_EQ(report.reason, Reason::nothing_to_solve);
  EXPECT_EQ(report.unknowns, system.size());
  EXPECT_EQ(x, std::vector<double>(system.size(), 0.0));
}

TYPED_TEST(AllSolvers, StartFromTheInitialGuess) {
  std::vector<double> x = dam_break().guess;
  TypeParam({.tolerance = 1e-8}).solve(dam_break().system, x);
  const auto solved = x;
  EXPECT_EQ(TypeParam({.tolerance = 1e-7}).solve(dam_break().system, x).iterations, 0);
  EXPECT_EQ(x, solved);
}

TYPED_TEST(AllSolvers, SolveBodiesOfOneTwoAndThreeParticles) {
  // The first particle is isolated and not an unknown. The last is almost at the radius of its
  // pair.
  const double re = 3.1 * 0.02;
  auto points = jittered<2, double>(6, 0.02, 0.1);
  for (const Vec<2>& x : {Vec<2>(9, 9), Vec<2>(3, 0), Vec<2>(3.03, 0), Vec<2>(5, 0),
                          Vec<2>(5.03, 0), Vec<2>(5.03, re * (1 - 1e-15))}) {
    points.push_back(x);
  }
  auto fluid = fluid_at(points);
  std::vector<double> source(fluid.size());
  for (Index i = 0; i < source.size(); ++i) source[i] = 1e5 * std::sin(double(i * i));
  const LinearSystem system = equation_of(fluid, source);
  EXPECT_EQ(system.closed_bodies, 3u);
  EXPECT_EQ(system.size(), points.size() - 2);
  std::vector<double> x(system.size(), 0);
  const SolveReport report = TypeParam({.tolerance = 1e-10}).solve(system, x);
  EXPECT_EQ(report.reason, Reason::converged);
  EXPECT_LE(residual(system, x), 1.01e-10);
}

TYPED_TEST(AllSolvers, SolveABodyWithAWeakConnectionToTheSurface) {
  for (const double gap : {1e-1, 1e-2, 4e-3, 3e-3, 2.5e-3, 2e-3, 1e-3, 1e-5, 1e-7, 1e-15}) {
    auto points = lattice<2, double>(cube<2, double>(0, 0.16), 0.02);
    points.push_back(points.back() + Vec<2>(3.1 * 0.02 * (1 - gap), 0));
    auto fluid = fluid_at(points);
    fluid[mps::surface].back() = 1;
    const LinearSystem system = equation_of(fluid, std::vector<double>(fluid.size(), -1e5));
    EXPECT_EQ(system.size(), points.size() - 1);
    std::vector<double> x(system.size(), 0);
    const Reason reason = TypeParam().solve(system, x).reason;
    EXPECT_EQ(reason, system.closed_bodies ? Reason::nothing_to_solve : Reason::converged) << gap;
    EXPECT_EQ(system.closed_bodies, gap < 2.3e-3 ? 1u : 0u) << gap;
  }
}

TYPED_TEST(AllSolvers, ConvergeFromAPoorInitialGuess) {
  for (const double size : {1e6, 1e12}) {
    for (const Problem* problem : {&dam_break(), &closed_tank()}) {
      std::vector<double> x(problem->guess.size());
      for (Index i = 0; i < x.size(); ++i) x[i] = size * std::sin(double(i));
      problem->system.remove_constants(x);  // as the pressure equation does
      EXPECT_EQ(TypeParam().solve(problem->system, x).reason, Reason::converged) << size;
    }
  }
}

TYPED_TEST(AllSolvers, ReportABreakdownForNonFiniteInput) {
  for (const double bad : {nan, inf}) {
    std::vector<double> x = dam_break().guess;
    x[5] = bad;
    EXPECT_EQ(TypeParam().solve(dam_break().system, x).reason, Reason::broke_down);
    LinearSystem system = dam_break().system;
    system.right_side[5] = bad;
    x = dam_break().guess;
    EXPECT_EQ(TypeParam().solve(system, x).reason, Reason::broke_down);
    system = dam_break().system;
    system.diagonal[5] = bad;
    x = dam_break().guess;
    EXPECT_EQ(TypeParam().solve(system, x).reason, Reason::broke_down);
  }
}

TYPED_TEST(AllSolvers, DoNotReportConvergenceWronglyIfNotPositiveDefinite) {
  LinearSystem system = dam_break().system;
  for (Index i = 0; i < system.size(); i += 3) system.diagonal[i] *= -1;
  std::vector<double> x(system.size(), 0);
  const SolveReport report = TypeParam({.max_iterations = 300}).solve(system, x);
  EXPECT_NE(report.reason, Reason::nothing_to_solve);
  EXPECT_TRUE(report.reason != Reason::converged || residual(system, x) <= 1.001e-6);
}

TYPED_TEST(AllSolvers, StopIfTheToleranceIsBelowRoundOff) {
  for (const Problem* problem : {&dam_break(), &closed_tank()}) {
    std::vector<double> x = problem->guess;
    const SolveReport report =
        TypeParam({.tolerance = 1e-300, .max_iterations = 2000}).solve(problem->system, x);
    EXPECT_LE(report.iterations, 2000);
    EXPECT_LE(report.residual, 1e-11);
    EXPECT_NE(report.reason, Reason::broke_down);
  }
}

TYPED_TEST(AllSolvers, ReportTheResidualAtTheMaximumNumberOfIterations) {
  std::vector<double> x(dam_break().system.size(), 0);
  const SolveReport report =
      TypeParam({.tolerance = 1e-12, .max_iterations = 3}).solve(dam_break().system, x);
  EXPECT_EQ(report.reason, Reason::not_converged);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_NEAR(report.residual, residual(dam_break().system, x), 1e-12);
}

TYPED_TEST(AllSolvers, RejectSettingsOutOfRange) {
  EXPECT_TRUE(refuses([] { TypeParam({.tolerance = 0}); }, {"SolveSettings: tolerance = 0 "}));
  EXPECT_TRUE(refuses([] { TypeParam({.max_iterations = 0}); }, {"max_iterations = 0 "}));
}

TEST(EigenConjugateGradient, NeedsAsManyIterationsAsConjugateGradientWithTheSameFactors) {
  for (const Problem* problem : {&dam_break(), &closed_tank()}) {
    const auto iterations = [&](auto solver) {
      std::vector<double> x = problem->guess;
      return solver.solve(problem->system, x).iterations;
    };
    EXPECT_NEAR(iterations(EigenConjugateGradient()),
                iterations(ConjugateGradient<IncompleteCholesky>()), 1);
  }
}

}  // namespace
}  // namespace silt::test::all_solvers_test
