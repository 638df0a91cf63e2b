// SPDX-License-Identifier: MIT
// Eigen's conjugate gradients with its incomplete Cholesky factorisation: an independent reference
// for ConjugateGradient. The number of iterations grows with the number of unknowns.
#pragma once

#include <silt/core/eigen.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/incomplete_cholesky.hpp>
#include <silt/solve/solve_settings.hpp>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

#include <algorithm>
#include <span>
#include <vector>

namespace silt {

/// A LinearSolver for comparisons.
class EigenConjugateGradient {
 public:
  EigenConjugateGradient() = default;
  /// Throws if the settings are out of range.
  explicit EigenConjugateGradient(const SolveSettings& settings) : settings_(settings) { check(); }

  /// Throws if the settings are out of range.
  void check() const { settings_.check(); }
  const SolveSettings& settings() const noexcept { return settings_; }

  /// Iterates from x until the residual is within the tolerance. Does not throw; failure is
  /// reported in SolveReport::reason.
  SolveReport solve(const LinearSystem& system, std::vector<double>& x) const {
    using Vector = Eigen::VectorXd;
    const auto n = static_cast<Eigen::Index>(system.size());
    const Eigen::Map<const Vector> b(system.right_side.data(), n);
    Eigen::Map<Vector> solution(x.data(), n);
    SolveReport report{.unknowns = system.size()};
    const double size_of_b = b.norm();
    if (n == 0 || size_of_b == 0) {
      solution.setZero();
      return report;
    }
    const Matrix A = eigen_matrix(system);
    const auto residual = [&] { return (b - A * solution).norm() / size_of_b; };
    report.residual = residual();
    report.reason = SolveReport::Reason::converged;
    if (report.residual <= settings_.tolerance) return report;

    Solver solver;
    solver.preconditioner().use(system);
    solver.compute(A);
    // Below, nothing but round-off is left, and Eigen may divide zero by zero.
    solver.setTolerance(std::max(settings_.tolerance, 1e-14));
    // Restarted if, because of round-off, the recursive residual differs from the true one.
    for (int round = 0; round < 3 && is_finite(report.residual); ++round) {
      solver.setMaxIterations(settings_.max_iterations - report.iterations);
      solution = solver.solveWithGuess(b, Vector(solution));
      const bool has_converged = solver.info() == Eigen::Success;
      // Eigen does not count the last iteration.
      report.iterations += static_cast<int>(solver.iterations()) + has_converged;
      report.residual = residual();
      if (!has_converged || report.residual <= settings_.tolerance) break;
    }
    if (!is_finite(report.residual)) {
      report.reason = SolveReport::Reason::broke_down;
    } else if (!settings_.is_met_by(report.residual)) {
      report.reason = SolveReport::Reason::not_converged;
    }
    return report;
  }

 private:
  using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

  // IncompleteCholesky with the interface of an Eigen preconditioner.
  class Factors {
   public:
    void use(const LinearSystem& system) { system_ = &system; }

    Factors& compute(const Eigen::Ref<const Matrix>&) {
      factors_.prepare(*system_);
      return *this;
    }
    Eigen::ComputationInfo info() const { return Eigen::Success; }
    Eigen::VectorXd solve(const Eigen::VectorXd& r) const {
      Eigen::VectorXd z(r.size());
      const auto n = static_cast<Index>(r.size());
      factors_.apply({r.data(), n}, {z.data(), n});
      system_->remove_constants({z.data(), n});
      return z;
    }

   private:
    const LinearSystem* system_ = nullptr;
    IncompleteCholesky factors_;
  };
  using Solver = Eigen::ConjugateGradient<Matrix, Eigen::Lower | Eigen::Upper, Factors>;

  SolveSettings settings_;
};

}  // namespace silt
