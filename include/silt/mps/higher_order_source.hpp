// SPDX-License-Identifier: MIT
// The sources of Khayyer and Gotoh: the rate of change of the number density from the slope of the
// kernel (2009), and terms that compensate its errors without a free parameter (2011).
#pragma once

#include <silt/core/error.hpp>
#include <silt/mps/source.hpp>

#include <cmath>

namespace silt::mps {

/// −(ρ/Δt) (1/n0) Dn*/Dt + γ (ρ/Δt²) (n0 − n)/n0,  Dn/Dt = Σ w'(r) u_ij·r_ij/r      (HS)
struct HigherOrderSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool needs_divergence = false;
  static constexpr bool needs_density_rate = true;

  double gamma = 0.01;  ///< γ [-] in [0, 1], as in DivergenceSource

  void check() const { require_between("HigherOrderSource: gamma", gamma, {0, 1}); }
  double value(const SourceTerms& s) const {
    return -s.density / s.time_step * (s.density_rate + gamma / s.time_step * s.compression);
  }
};

/// The same, with two terms proportional to the errors instead of the term with γ; c = (n − n0)/n0:
///   −(ρ/Δt) [ (1/n0) Dn*/Dt + |c| (1/n0) Dn/Dt + |Δt (1/n0) Dn/Dt| c/Δt ]      (HS with ECS)
struct ErrorCompensatingSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool needs_divergence = false;
  static constexpr bool needs_density_rate = true;

  void check() const {}
  double value(const SourceTerms& s) const {
    const double c = s.compression;
    const double before = s.last_density_rate;
    return -s.density / s.time_step *
           (s.density_rate + std::abs(c) * before + std::abs(before) * c);
  }
};

}  // namespace silt::mps
