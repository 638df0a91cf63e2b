// SPDX-License-Identifier: MIT
#include "support/check.hpp"

#include <silt/solve/conjugate_gradient.hpp>
#include <silt/solve/incomplete_cholesky.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::test::conjugate_gradient_test {
namespace {

using Reason = SolveReport::Reason;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// M = 1.
struct NoPreconditioner {
  void prepare(const LinearSystem&) {}
  void apply(const std::vector<double>& r, std::vector<double>& z) const { z = r; }
};

static_assert(LinearSolver<ConjugateGradient<>>);
static_assert(LinearSolver<ConjugateGradient<NoPreconditioner>>);
static_assert(Preconditioner<Jacobi> && Preconditioner<NoPreconditioner>);
static_assert(Preconditioner<IncompleteCholesky>);

struct Unprepared {
  void apply(const std::vector<double>&, std::vector<double>&) const {}
};
static_assert(!Preconditioner<Unprepared> && !Preconditioner<LinearSystem>);

struct SilentSolver {
  void check() const {}
  void solve(const LinearSystem&, std::vector<double>&) {}
};
struct UncheckedSolver {
  SolveReport solve(const LinearSystem&, std::vector<double>&) { return {}; }
};
static_assert(!LinearSolver<SilentSolver> && !LinearSolver<UncheckedSolver>);
static_assert(!LinearSolver<Jacobi>);

// −u'' at n inner points of a line with u = 0 at both ends: diagonal 2, off-diagonal −1.
LinearSystem line_of(Index n) {
  LinearSystem system;
  system.diagonal.assign(n, 2);
  system.off_diagonal.build(n, [n](Index i, auto&& add) {
    if (i > 0) add(i - 1, -1.0);
    if (i + 1 < n) add(i + 1, -1.0);
  });
  system.right_side.assign(n, 0);
  return system;
}

// A x, computed column by column.
std::vector<double> times(const LinearSystem& system, const std::vector<double>& x) {
  std::vector<double> y(system.size(), 0);
  for (Index i = 0; i < system.size(); ++i) {
    y[i] += system.diagonal[i] * x[i];
    system.off_diagonal.for_each_entry(
        i, [&](Index column, double value) { y[column] += value * x[i]; });
  }
  return y;
}

double norm(const std::vector<double>& x) {
  double sum = 0;
  for (const double each : x) sum += each * each;
  return std::sqrt(sum);
}

double residual(const LinearSystem& system, const std::vector<double>& x) {
  auto r = times(system, x);
  for (Index i = 0; i < r.size(); ++i) r[i] = system.right_side[i] - r[i];
  return norm(r) / norm(system.right_side);
}

std::vector<double> uneven(Index n) {
  std::vector<double> x(n);
  for (Index i = 0; i < n; ++i) x[i] = std::sin(double(3 * i)) + 0.1 * double(i % 7);
  return x;
}

template <class M>
class ConjugateGradients : public ::testing::Test {};
using Preconditioners = ::testing::Types<Jacobi, NoPreconditioner>;
TYPED_TEST_SUITE(ConjugateGradients, Preconditioners);

TYPED_TEST(ConjugateGradients, FindTheKnownSolution) {
  const auto exact = uneven(50);
  auto system = line_of(50);
  for (Index i = 0; i < 50; ++i) system.diagonal[i] += double(i);
  system.right_side = times(system, exact);
  ConjugateGradient<TypeParam> solver({.tolerance = 1e-13});
  std::vector<double> x(50, 0);
  const SolveReport report = solver.solve(system, x);
  EXPECT_EQ(report.reason, Reason::converged);
  EXPECT_EQ(report.unknowns, 50u);
  for (Index i = 0; i < 50; ++i) EXPECT_NEAR(x[i], exact[i], 1e-11);
}

TYPED_TEST(ConjugateGradients, NeedAtMostAsManyIterationsAsEigenvalues) {
  // In exact arithmetic at most 40, the number of eigenvalues.
  auto system = line_of(40);
  system.right_side = uneven(40);
  ConjugateGradient<TypeParam> solver({.tolerance = 1e-9});
  std::vector<double> x(40, 0);
  EXPECT_LE(solver.solve(system, x).iterations, 42);
  // An eigenvector as right side needs one iteration.
  for (Index i = 0; i < 40; ++i) {
    system.right_side[i] = std::sin(double(i + 1) * std::numbers::pi / 41);
  }
  x.assign(40, 0);
  EXPECT_EQ(solver.solve(system, x).iterations, 1);
}

TYPED_TEST(ConjugateGradients, MeetTheToleranceTheyReport) {
  auto system = line_of(400);
  system.right_side = uneven(400);
  for (const double tolerance : {1e-2, 1e-6, 1e-10}) {
    ConjugateGradient<TypeParam> solver({.tolerance = tolerance});
    std::vector<double> x(400, 1.0);
    const SolveReport report = solver.solve(system, x);
    EXPECT_EQ(report.reason, Reason::converged);
    EXPECT_NEAR(report.residual, residual(system, x), 1e-13);
    EXPECT_LE(residual(system, x), tolerance * 1.01);
  }
}

TYPED_TEST(ConjugateGradients, StartFromTheInitialGuess) {
  auto system = line_of(300);
  system.right_side = uneven(300);
  ConjugateGradient<TypeParam> solver({.tolerance = 1e-8});
  std::vector<double> x(300, 0);
  ASSERT_GT(solver.solve(system, x).iterations, 10);
  const auto solved = x;
  const SolveReport again = solver.solve(system, x);
  EXPECT_EQ(again.reason, Reason::converged);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(x, solved);
}

TYPED_TEST(ConjugateGradients, AreBitwiseIdenticalForAnyNumberOfThreads) {
  auto system = line_of(5000);
  for (Index i = 0; i < 5000; ++i) system.diagonal[i] += 0.01 + double(i % 11);
  system.right_side = uneven(5000);
  const auto solved_by = [&](int number) {
    return with_threads(number, [&] {
      std::vector<double> x(5000, 0);
      ConjugateGradient<TypeParam>().solve(system, x);
      return x;
    });
  };
  const auto serial = solved_by(1);
  for (const int number : {2, 3, 4}) EXPECT_EQ(solved_by(number), serial) << number;
}

TYPED_TEST(ConjugateGradients, SolveASingularSystemWhoseRightSideIsInItsRange) {
  // A ring, whose null space is the constant vector.
  LinearSystem ring;
  const Index n = 60;
  ring.diagonal.assign(n, 2);
  ring.off_diagonal.build(n, [](Index i, auto&& add) {
    add((i + n - 1) % n, -1.0);
    add((i + 1) % n, -1.0);
  });
  const auto exact = uneven(n);
  ring.right_side = times(ring, exact);
  ConjugateGradient<TypeParam> solver({.tolerance = 1e-12});
  std::vector<double> x(n, 5);
  EXPECT_EQ(solver.solve(ring, x).reason, Reason::converged);
  for (Index i = 0; i < n; ++i) EXPECT_NEAR(x[i] - x[0], exact[i] - exact[0], 1e-9);
}

TEST(ConjugateGradient, NeedsFewerIterationsWithIncompleteCholeskyFactors) {
  // The five-point Laplacian on 30 × 30 points.
  constexpr Index along = 30;
  LinearSystem system;
  system.diagonal.assign(along * along, 4);
  system.off_diagonal.build(along * along, [](Index i, auto&& add) {
    if (i >= along) add(i - along, -1.0);
    if (i % along > 0) add(i - 1, -1.0);
    if (i % along + 1 < along) add(i + 1, -1.0);
    if (i + along < along * along) add(i + along, -1.0);
  });
  system.right_side = uneven(along * along);
  std::vector<double> x(along * along, 0);
  const int by_factors = ConjugateGradient<IncompleteCholesky>().solve(system, x).iterations;
  EXPECT_LE(residual(system, x), 1e-6);
  x.assign(along * along, 0);
  EXPECT_LT(2 * by_factors, ConjugateGradient<Jacobi>().solve(system, x).iterations);
}

TEST(ConjugateGradient, ReportsNothingToSolveWithoutUnknowns) {
  std::vector<double> x;
  const SolveReport report = ConjugateGradient<>().solve(line_of(0), x);
  EXPECT_EQ(report.reason, Reason::nothing_to_solve);
  EXPECT_EQ(report.unknowns, 0u);
}

TEST(ConjugateGradient, ReturnsZeroForAZeroRightSide) {
  std::vector<double> x(10, 3.0);
  const SolveReport report = ConjugateGradient<>().solve(line_of(10), x);
  EXPECT_EQ(report.reason, Reason::nothing_to_solve);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(x, std::vector<double>(10, 0.0));
}

TEST(ConjugateGradient, ReportsThatItHasNotConverged) {
  auto system = line_of(1000);
  system.right_side = uneven(1000);
  std::vector<double> x(1000, 0);
  const SolveReport report =
      ConjugateGradient<>({.tolerance = 1e-10, .max_iterations = 5}).solve(system, x);
  EXPECT_EQ(report.reason, Reason::not_converged);
  EXPECT_EQ(report.iterations, 5);
  EXPECT_GT(report.residual, 1e-10);
  EXPECT_NEAR(report.residual, residual(system, x), 1e-12);
}

TEST(ConjugateGradient, ReportsABreakdown) {
  std::vector<double> x(10, 0);
  auto indefinite = line_of(10);
  indefinite.right_side = uneven(10);
  for (double& each : indefinite.diagonal) each = -1;
  EXPECT_EQ(ConjugateGradient<>().solve(indefinite, x).reason, Reason::broke_down);

  auto not_a_number = line_of(10);
  not_a_number.right_side = uneven(10);
  not_a_number.right_side[3] = nan;
  x.assign(10, 0);
  EXPECT_EQ(ConjugateGradient<>().solve(not_a_number, x).reason, Reason::broke_down);
}

TEST(ConjugateGradient, StopsIfTheToleranceIsBelowRoundOff) {
  auto system = line_of(2000);
  system.right_side = uneven(2000);
  std::vector<double> x(2000, 0);
  const SolveReport report =
      ConjugateGradient<>({.tolerance = 1e-300, .max_iterations = 20000}).solve(system, x);
  EXPECT_LE(report.iterations, 20000);
  EXPECT_LT(report.residual, 1e-9);
}

TEST(ConjugateGradient, AcceptsAGuessWhoseResidualEqualsTheTolerance) {
  auto system = line_of(1);
  system.right_side = {1};
  std::vector<double> x{0.25};  // b − A x = 0.5
  const SolveReport report = ConjugateGradient<>({.tolerance = 0.5}).solve(system, x);
  EXPECT_EQ(report.reason, Reason::converged);
  EXPECT_EQ(report.residual, 0.5);
  EXPECT_EQ(report.iterations, 0);
  EXPECT_EQ(x, std::vector<double>{0.25});
}

TEST(SolveSettings, AreMetWithinAThousandthOfTheToleranceAndRoundOff) {
  for (const double tolerance : {1.0, 1e-6}) {
    const SolveSettings settings{.tolerance = tolerance};
    EXPECT_TRUE(settings.is_met_by(tolerance));
    EXPECT_TRUE(settings.is_met_by(1.0009 * tolerance));
    EXPECT_FALSE(settings.is_met_by(1.0011 * tolerance));
    EXPECT_FALSE(settings.is_met_by(nan));
  }
  const SolveSettings round_off{.tolerance = 1e-300};
  EXPECT_TRUE(round_off.is_met_by(1e-13));
  EXPECT_FALSE(round_off.is_met_by(std::nextafter(1e-13, 1)));
}

TEST(SolveSettings, AreRejectedOutOfRange) {
  EXPECT_TRUE(refuses([] { ConjugateGradient<>({.tolerance = 0}); }, {"tolerance = 0 "}));
  EXPECT_TRUE(refuses([] { ConjugateGradient<>({.tolerance = -1e-6}); }, {"tolerance = -1e-06"}));
  EXPECT_TRUE(refuses([] { ConjugateGradient<>({.tolerance = nan}); }, {"tolerance = nan"}));
  EXPECT_TRUE(
      refuses([] { ConjugateGradient<>({.max_iterations = 0}); }, {"max_iterations = 0 "}));
}

}  // namespace
}  // namespace silt::test::conjugate_gradient_test
