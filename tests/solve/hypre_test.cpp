// SPDX-License-Identifier: MIT
// The multigrid of hypre with the interface of a Silt preconditioner.
#include "support/check.hpp"

#include <silt/solve/conjugate_gradient.hpp>
#include <silt/solve/hypre.hpp>

#include <gtest/gtest.h>
#include <mpi.h>

#include <cmath>
#include <vector>

// MPI does not free all its memory.
extern "C" const char* __asan_default_options() { return "detect_leaks=0"; }

namespace silt::test::hypre_test {
namespace {

static_assert(Preconditioner<BoomerAmg>);
static_assert(LinearSolver<ConjugateGradient<BoomerAmg>>);

// MPI must be initialised once, before the first solve.
class Mpi : public ::testing::Environment {
 public:
  void SetUp() override { MPI_Init(nullptr, nullptr); }
  void TearDown() override { MPI_Finalize(); }
};
const auto* const mpi = ::testing::AddGlobalTestEnvironment(new Mpi);

// −∇²u at n × n inner points of a square with u = 0 on the boundary.
LinearSystem square_of(Index n) {
  LinearSystem system;
  system.diagonal.assign(n * n, 4);
  system.off_diagonal.build(n * n, [n](Index i, auto&& add) {
    if (i >= n) add(i - n, -1.0);
    if (i % n > 0) add(i - 1, -1.0);
    if (i % n + 1 < n) add(i + 1, -1.0);
    if (i + n < n * n) add(i + n, -1.0);
  });
  system.right_side.assign(n * n, 0);
  return system;
}

std::vector<double> uneven(Index n) {
  std::vector<double> x(n);
  for (Index i = 0; i < n; ++i) x[i] = std::sin(double(3 * i)) + 0.1 * double(i % 7);
  return x;
}

void put_right_side(LinearSystem& system, const std::vector<double>& x) {
  for (Index i = 0; i < system.size(); ++i) system.right_side[i] += system.diagonal[i] * x[i];
  for (Index i = 0; i < system.size(); ++i) {
    system.off_diagonal.for_each_entry(
        i, [&](Index column, double value) { system.right_side[column] += value * x[i]; });
  }
}

TEST(BoomerAmg, FindsTheKnownSolution) {
  auto system = square_of(30);
  const auto exact = uneven(900);
  put_right_side(system, exact);
  ConjugateGradient<BoomerAmg> solver({.tolerance = 1e-12});
  std::vector<double> x(900, 0);
  const SolveReport report = solver.solve(system, x);
  EXPECT_EQ(report.reason, SolveReport::Reason::converged);
  EXPECT_EQ(report.unknowns, 900u);
  EXPECT_LE(report.residual, 1e-12);
  for (Index i = 0; i < 900; ++i) EXPECT_NEAR(x[i], exact[i], 1e-9);
}

TEST(BoomerAmg, NeedsAboutAsManyIterationsForMoreUnknowns) {
  const auto iterations = [](Index n) {
    auto system = square_of(n);
    system.right_side = uneven(n * n);
    ConjugateGradient<BoomerAmg> solver({.tolerance = 1e-6});
    std::vector<double> x(n * n, 0);
    return solver.solve(system, x).iterations;
  };
  EXPECT_LE(iterations(20), 12);
  EXPECT_LE(iterations(80), 12);
}

TEST(BoomerAmg, SolvesSystemsOfDifferentSizesAndCanBeCopied) {
  ConjugateGradient<BoomerAmg> solver({.tolerance = 1e-10});
  for (const Index n : {10u, 5u, 12u}) {
    auto system = square_of(n);
    system.right_side = uneven(n * n);
    std::vector<double> x(n * n, 0), again(n * n, 0);
    EXPECT_EQ(solver.solve(system, x).reason, SolveReport::Reason::converged);
    auto copy = solver;
    copy.solve(system, again);
    EXPECT_EQ(again, x);
  }
}

TEST(BoomerAmg, RejectsSettingsOutOfRange) {
  EXPECT_TRUE(refuses([] { BoomerAmg({.strong_threshold = 1.5}); },
                      {"BoomerAmg: strong_threshold = 1.5"}));
}

}  // namespace
}  // namespace silt::test::hypre_test
