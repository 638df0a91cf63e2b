// SPDX-License-Identifier: MIT
// Preconditioned conjugate gradients (Hestenes and Stiefel 1952), the same bits for any number of
// threads.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/jacobi.hpp>

#include <cmath>
#include <vector>

namespace silt {

struct SolveSettings {
  double tolerance = 1e-6;    ///< |b − A x| ≤ tolerance |b| [-]
  int most_iterations = 5000;
};

template <Preconditioner M = Jacobi>
class ConjugateGradient {
 public:
  ConjugateGradient() = default;
  explicit ConjugateGradient(const SolveSettings& settings, M preconditioner = {})
      : settings_(settings), preconditioner_(std::move(preconditioner)) {
    check();
  }

  /// Throws if the settings are out of range.
  void check() const {
    require_positive("SolveSettings: tolerance", settings_.tolerance);
    require_positive("SolveSettings: most_iterations", settings_.most_iterations);
  }

  const SolveSettings& settings() const noexcept { return settings_; }

  /// Improves x until the residual is within the tolerance. Never throws: read the report's reason.
  SolveReport solve(const LinearSystem& system, std::vector<double>& x) {
    const std::vector<double>& b = system.right_side;
    const Index n = system.size();
    SolveReport report{.unknowns = n};
    const double size_of_b = std::sqrt(dot(b, b));
    if (n == 0 || size_of_b == 0) {
      for_each(n, [&](Index i) { x[i] = 0; });
      return report;
    }
    for (auto* v : {&r_, &z_, &p_, &q_}) v->resize(n);
    preconditioner_.prepare(system);

    // A second round starts where rounding has parted the recurrence from the true residual.
    for (int round = 0; round < 3; ++round) {
      subtract_product(system, x, b, r_);  // r = b − A x
      report.residual = std::sqrt(dot(r_, r_)) / size_of_b;
      report.reason = SolveReport::Reason::converged;
      if (report.residual <= settings_.tolerance) return report;

      preconditioner_.apply(r_, z_);
      system.remove_constants(z_);
      p_ = z_;
      double rho = dot(r_, z_);
      double residual = report.residual;
      while (!(residual <= settings_.tolerance)) {  // a NaN goes in, to be named there
        if (report.iterations == settings_.most_iterations || !is_finite(residual)) {
          report.reason = is_finite(residual) ? SolveReport::Reason::not_converged
                                              : SolveReport::Reason::broke_down;
          report.residual = true_residual(system, x) / size_of_b;
          return report;
        }
        product(system, p_, q_);
        const double curvature = dot(p_, q_);
        if (!(curvature > 0)) {
          report.reason = SolveReport::Reason::broke_down;
          report.residual = true_residual(system, x) / size_of_b;
          return report;
        }
        const double alpha = rho / curvature;
        for_each(n, [&](Index i) {
          x[i] += alpha * p_[i];
          r_[i] -= alpha * q_[i];
        });
        preconditioner_.apply(r_, z_);
        system.remove_constants(z_);
        const double next = dot(r_, z_);
        const double beta = next / rho;
        rho = next;
        for_each(n, [&](Index i) { p_[i] = z_[i] + beta * p_[i]; });
        residual = std::sqrt(dot(r_, r_)) / size_of_b;
        ++report.iterations;
      }
    }
    report.residual = true_residual(system, x) / size_of_b;
    // Within a hundred rounding errors of the tolerance is as good as there.
    const bool close = report.residual <= settings_.tolerance * (1 + 1e-3) + 1e-13;
    report.reason = close ? SolveReport::Reason::converged : SolveReport::Reason::not_converged;
    return report;
  }

 private:
  // |b − A x|
  double true_residual(const LinearSystem& system, const std::vector<double>& x) {
    subtract_product(system, x, system.right_side, r_);
    return std::sqrt(dot(r_, r_));
  }

  static double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return ordered_sum(a.size(), 0.0, [&](Index i) { return a[i] * b[i]; });
  }

  static double row_times(const LinearSystem& system, Index i, const std::vector<double>& x) {
    double sum = system.diagonal[i] * x[i];
    for (const auto& [column, value] : system.off_diagonal[i]) sum += value * x[column];
    return sum;
  }

  static void product(const LinearSystem& system, const std::vector<double>& x,
                      std::vector<double>& y) {
    for_each(system.size(), [&](Index i) { y[i] = row_times(system, i, x); });
  }

  static void subtract_product(const LinearSystem& system, const std::vector<double>& x,
                               const std::vector<double>& b, std::vector<double>& r) {
    for_each(system.size(), [&](Index i) { r[i] = b[i] - row_times(system, i, x); });
  }

  SolveSettings settings_;
  M preconditioner_{};
  std::vector<double> r_, z_, p_, q_;
};

}  // namespace silt
