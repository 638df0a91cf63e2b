// SPDX-License-Identifier: MIT
// Preconditioned conjugate gradients (Hestenes and Stiefel 1952), bitwise identical for any number
// of threads.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/solve/jacobi.hpp>
#include <silt/solve/solve_settings.hpp>

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
      precondition(system);         // z = M⁻¹ r
      std::copy(z_.begin(), z_.end(), p_.begin());
      double rho = system.sum_of_all(dot(r_, z_));
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
        const double of_r = advance(rho / curvature, x);  // x += α p;  r −= α q
        ++report.iterations;
        double next = 0;  // r·z
        if (system.shared) {
          // Processes wait for each sum: once more than needed is M applied to save half of them.
          precondition(system);
          const auto sums = system.sum_of_all(std::array{of_r, dot(r_, z_)});
          residual = std::sqrt(sums[0]) / size_of_b;
          next = sums[1];
          if (residual <= goal) break;
        } else {
          residual = std::sqrt(of_r) / size_of_b;
          if (residual <= goal) break;
          precondition(system);
          next = dot(r_, z_);
        }
        update_direction(next / rho);  // p = z + β p
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
    const auto subtract = [&](Index i, double product) { r_[i] = system.right_side[i] - product; };
    for_each_range<rows_together>(system.size(), [&](Index first, Index last) {
      system.multiply(first, last, x, subtract);
    });
    return std::sqrt(system.sum_of_all(dot(r_, r_)));
  }

  double multiply(const LinearSystem& system) {
    system.refresh(p_);
    const auto store = [&](Index i, double product) { q_[i] = product; };
    for_each_range<rows_together>(system.size(), [&](Index first, Index last) {
      system.multiply(first, last, p_, store);
    });
    return system.sum_of_all(dot(q_, p_));
  }

  double advance(double alpha, std::vector<double>& x) {
    return sum_over_chunks(r_.size(), [&](Chunk chunk) {
      add(chunk, x, alpha, p_);
      add(chunk, r_, -alpha, q_);
      return dot(chunk, r_, r_);
    });
  }

  void precondition(const LinearSystem& system) {
    preconditioner_.apply(r_, z_);
    system.remove_constants(z_);
  }

  void update_direction(double beta) {
    for_each(z_.size(),
             [beta, p = p_.data(), z = z_.data()](Index i) { p[i] = z[i] + beta * p[i]; });
  }

  double dot(const std::vector<double>& a, const std::vector<double>& b) {
    return sum_over_chunks(a.size(), [&](Chunk chunk) { return dot(chunk, a, b); });
  }

  // a += scale b
  static void add(Chunk chunk, std::vector<double>& a, double scale, const std::vector<double>& b) {
    double* const to = a.data();
    const double* const from = b.data();
    for (Index i = chunk.first; i < chunk.last; ++i) to[i] += scale * from[i];
  }

  // Eight independent partial sums, so that additions can overlap in time. Written in packs,
  // because g++ would keep an array in memory.
  static double dot(Chunk chunk, const std::vector<double>& a, const std::vector<double>& b) {
    constexpr Index sums = 8;
    constexpr Index lanes = simd::lanes<double>;
    simd::Pack<double> packs[sums / lanes]{};
    Index i = chunk.first;
    for (; i + sums <= chunk.last; i += sums) {
      for (Index k = 0; k < sums; k += lanes) {
        packs[k / lanes] += simd::load(&a[i + k]) * simd::load(&b[i + k]);
      }
    }
    std::array<double, sums> sum;
    for (Index k = 0; k < sums; ++k) sum[k] = packs[k / lanes][k % lanes];
    for (; i < chunk.last; ++i) sum[0] += a[i] * b[i];
    return ((sum[0] + sum[4]) + (sum[2] + sum[6])) + ((sum[1] + sum[5]) + (sum[3] + sum[7]));
  }

  // Σ f(chunk), in the order of the chunks.
  template <class F>
  double sum_over_chunks(Index n, F&& f) {
    partial_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) { partial_[chunk.number] = f(chunk); });
    double sum = 0;
    for (const double part : partial_) sum += part;
    return sum;
  }

  SolveSettings settings_;
  M preconditioner_{};
  std::vector<double> r_, z_, p_, q_;
  std::vector<double> partial_;  // sums of the chunks
};

}  // namespace silt
