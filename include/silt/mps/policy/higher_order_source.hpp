// SPDX-License-Identifier: MIT
// The sources of Khayyer and Gotoh: the rate of change of the number density from the slope of the
// kernel (2009), and terms that compensate its errors without a free parameter (2011).
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <cmath>

namespace silt::mps {

/// −(ρ/Δt) (1/n0) Dn*/Dt + γ (ρ/Δt²) (n0 − n)/n0,  Dn/Dt = Σ w'(r) u_ij·r_ij/r
/// (HS) [KhayyerGotoh2009]
struct HigherOrderSource {
  static constexpr bool needs_moved_particles = false;

  double gamma = 0.01;  ///< γ [-] in [0, 1], as in DivergenceSource

  void check() const { require_between("HigherOrderSource: gamma", gamma, {0, 1}); }
  double value(const auto& at) const {
    return -at.density() / at.time_step() *
           (at.density_rate() + gamma / at.time_step() * at.compression());
  }
};

/// The same, with two terms proportional to the errors instead of the term with γ
/// [KhayyerGotoh2011]; c = (n − n0)/n0:
///
///   −(ρ/Δt) [ (1/n0) Dn*/Dt + |c| (1/n0) Dn/Dt + |Δt (1/n0) Dn/Dt| c/Δt ]      (HS with ECS)
class ErrorCompensatingSource {
 public:
  static constexpr bool needs_moved_particles = false;

  void check() const {}
  /// Keeps Dn/Dt, of the velocities before the predictor.
  template <class StepView>
  void begin(const StepView& step) {
    last_rate_.resize(step.particles.size());
    for_each(last_rate_.size(), [&](Index i) { last_rate_[i] = step.at(i).density_rate(); });
  }
  double value(const auto& at) const {
    const double c = at.compression();
    const double before = last_rate_[at.index()];
    return -at.density() / at.time_step() *
           (at.density_rate() + std::abs(c) * before + std::abs(before) * c);
  }

 private:
  Buffer<double> last_rate_;  // (1/n0) Dn/Dt [1/s]
};

}  // namespace silt::mps
