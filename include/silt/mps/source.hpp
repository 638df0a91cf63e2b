// SPDX-License-Identifier: MIT
// Sources of the pressure equation ∇²P = source, [HwangLeePark2010] (9), (16). A compressed
// particle (n > n0) gets a negative source, and with it a higher pressure.
#pragma once

#include <silt/core/error.hpp>

#include <concepts>

namespace silt::mps {

/// What a source is made from, at one particle.
struct SourceTerms {
  double density = 0;         ///< ρ [kg/m³]
  double time_step = 0;       ///< Δt [s]
  double compression = 0;     ///< (n − n0)/n0 [-]
  double divergence = 0;      ///< ∇·u* [1/s]
};

/// Has value(terms) [Pa/m²] and says whether its n is that of moved particles.
template <class S>
concept PressureSource = requires(const S source, SourceTerms terms) {
  { source.value(terms) } -> std::convertible_to<double>;
  { S::needs_moved_particles } -> std::convertible_to<bool>;
  { S::needs_divergence } -> std::convertible_to<bool>;
  source.check();
};

/// −(ρ/Δt²) (n* − n0)/n0, n* after the predictor moved the particles (9): the original.
struct DensitySource {
  static constexpr bool needs_moved_particles = true;
  static constexpr bool needs_divergence = false;

  void check() const {}
  double value(const SourceTerms& s) const {
    return -s.density / (s.time_step * s.time_step) * s.compression;
  }
};

/// (ρ/Δt) ∇·u* + γ (ρ/Δt²) (n0 − n^k)/n0 (16), Tanaka and Masunaga (2010).
struct DivergenceSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool needs_divergence = true;

  double gamma = 0.01;  ///< γ [-] in [0, 1]: how much of the density error is corrected in a step

  void check() const { require_between("DivergenceSource: gamma", gamma, {0, 1}); }
  double value(const SourceTerms& s) const {
    return s.density / s.time_step * s.divergence -
           gamma * s.density / (s.time_step * s.time_step) * s.compression;
  }
};

}  // namespace silt::mps
