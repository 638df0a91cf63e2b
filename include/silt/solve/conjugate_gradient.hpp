// SPDX-License-Identifier: MIT
// Preconditioned conjugate gradients (Hestenes and Stiefel 1952), bitwise identical for any number
// of threads.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/jacobi.hpp>
#include <silt/solve/solve_settings.hpp>
#include <silt/solve/vector_sums.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace silt {

/// A LinearSolver with the preconditioner M; [HestenesStiefel1952].
template <Preconditioner M = Jacobi>
class ConjugateGradient {
 public:
  static constexpr bool shares_unknowns = requires { requires M::shares_unknowns; };

  ConjugateGradient() = default;
  /// Throws if the settings are out of range.
  explicit ConjugateGradient(const SolveSettings& settings, M preconditioner = {})
      : settings_(settings), preconditioner_(std::move(preconditioner)) {
    check();
  }

  /// Throws if the settings are out of range.
  void check() const { settings_.check(); }

  const SolveSettings& settings() const noexcept { return settings_; }
  /// The preconditioner, after the last solve.
  const M& preconditioner() const noexcept { return preconditioner_; }

  /// Iterates from x until the residual is within the tolerance. Does not throw; failure is
  /// reported in SolveReport::reason.
  SolveReport solve(const LinearSystem& system, std::vector<double>& x) {
    const Index n = system.size();
    SolveReport report{.unknowns = Index(system.sum_of_all(double(n)))};
    const double size_of_b =
        std::sqrt(system.sum_of_all(dot(system.right_side, system.right_side)));
    if (size_of_b == 0) {
      for_each(n, [&](Index i) { x[i] = 0; });
      return report;
    }
    for (auto* v : {&r_, &z_, &q_}) v->resize(n);
    p_.resize(system.columns());
    preconditioner_.prepare(system);
    system.sum_of_all(0.0);  // it may have failed in one process

    // Restarted if, because of round-off, the recursive residual differs from the true one.
    for (int round = 0; round < 3; ++round) {
      report.residual = find_residual(system, x) / size_of_b;
      const bool can_start = is_finite(report.residual);
      report.reason = can_start ? SolveReport::Reason::converged : SolveReport::Reason::broke_down;
      if (!can_start || report.residual <= settings_.tolerance) return report;

      system.remove_constants(r_);  // due to round-off; iterations would not reduce them
      const double of_start = precondition(system);
      for_each_chunk(n, [&](Chunk chunk) {
        std::copy_n(z_.data() + chunk.first, chunk.last - chunk.first, p_.data() + chunk.first);
      });
      double rho = system.sum_of_all(of_start);
      double residual = report.residual;
      // After a reduction by 1e-14, the recursive residual is only round-off.
      const double goal = std::max(settings_.tolerance, 1e-14 * residual);
      while (true) {
        const bool diverged = !is_finite(residual);
        const double curvature = diverged ? 0 : multiply(system);  // q = A p;  p·q
        if (diverged || !(curvature > 0) || report.iterations == settings_.max_iterations) {
          report.reason = !diverged && curvature > 0 ? SolveReport::Reason::not_converged
                                                    : SolveReport::Reason::broke_down;
          report.residual = find_residual(system, x) / size_of_b;
          if (settings_.is_met_by(report.residual)) report.reason = SolveReport::Reason::converged;
          return report;
        }
        const double alpha = rho / curvature;
        const double of_r = reduce_residual(alpha);  // r −= α q
        ++report.iterations;
        double next = 0;  // r·z
        if (system.shared) {
          // Processes wait for each sum: once more than needed is M applied to save half of them.
          const auto sums = system.sum_of_all(std::array{of_r, precondition(system)});
          residual = std::sqrt(sums[0]) / size_of_b;
          next = sums[1];
        } else {
          residual = std::sqrt(of_r) / size_of_b;
          if (!(residual <= goal)) next = precondition(system);
        }
        advance(alpha, x, next / rho);  // x += α p;  p = z + β p
        if (residual <= goal) break;
        rho = next;
      }
    }
    report.residual = find_residual(system, x) / size_of_b;
    report.reason = settings_.is_met_by(report.residual) ? SolveReport::Reason::converged
                                                      : SolveReport::Reason::not_converged;
    return report;
  }

 private:
  // r = b − A x, and |r|.
  double find_residual(const LinearSystem& system, std::vector<double>& x) {
    system.refresh(x);
    const double of_r = sum_over_rows(system, [&](Index first, Index last) {
      system.multiply(first, last, x,
                      [&](Index i, double product) { r_[i] = system.right_side[i] - product; });
      return detail::dot_product()(&r_[first], &r_[first], last - first);
    });
    return std::sqrt(system.sum_of_all(of_r));
  }

  // q = A p, and p·q.
  double multiply(const LinearSystem& system) {
    system.refresh(p_);
    return system.sum_of_all(sum_over_rows(system, [&](Index first, Index last) {
      system.multiply(first, last, p_, [&](Index i, double product) { q_[i] = product; });
      return detail::dot_product()(&q_[first], &p_[first], last - first);
    }));
  }

  // r −= α q, and r·r.
  double reduce_residual(double alpha) {
    return sum_over_chunks(r_.size(), [&](Chunk chunk) {
      return detail::add_and_square()(&r_[chunk.first], -alpha, &q_[chunk.first],
                                      chunk.last - chunk.first);
    });
  }

  // x += α p, then p = z + β p: together, because both read p.
  void advance(double alpha, std::vector<double>& x, double beta) {
    for_each_chunk(z_.size(), [&](Chunk chunk) {
      detail::step_and_turn()(&x[chunk.first], alpha, &p_[chunk.first], &z_[chunk.first], beta,
                              chunk.last - chunk.first);
    });
  }

  // z = M⁻¹ r, and r·z of this process.
  double precondition(const LinearSystem& system) {
    if constexpr (requires { preconditioner_.apply_and_multiply(r_, z_); }) {
      if (system.closed_bodies == 0) return preconditioner_.apply_and_multiply(r_, z_);
    }
    preconditioner_.apply(r_, z_);
    system.remove_constants(z_);
    return dot(r_, z_);
  }

  double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return sum_over_chunks(a.size(), [&](Chunk chunk) {
      return detail::dot_product()(&a[chunk.first], &b[chunk.first], chunk.last - chunk.first);
    });
  }

  // Σ f(chunk), in the order of the chunks.
  template <class F>
  double sum_over_chunks(Index n, F&& f) {
    partial_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) { partial_[chunk.number] = f(chunk); });
    return sum_of_parts();
  }
  // Σ f(first, last) over the rows that are stored together, in their order.
  template <class F>
  double sum_over_rows(const LinearSystem& system, F&& f) {
    partial_.resize(row_sets(system.size()));
    for_each_range<rows_together>(system.size(), [&](Index first, Index last) {
      partial_[first / rows_together] = f(first, last);
    });
    return sum_of_parts();
  }
  double sum_of_parts() const {
    double sum = 0;
    for (const double part : partial_) sum += part;
    return sum;
  }

  SolveSettings settings_;
  M preconditioner_{};
  std::vector<double> r_, z_, p_, q_;
  std::vector<double> partial_;  // sums of chunks, or of rows stored together
};

}  // namespace silt
