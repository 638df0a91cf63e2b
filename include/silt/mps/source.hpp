// SPDX-License-Identifier: MIT
// Sources of the pressure equation ∇²P = source, [HwangLeePark2010] (9), (16). A compressed
// particle (n > n0) gets a negative source, and with it a higher pressure.
#pragma once

#include <silt/core/error.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// What a source is made from, at one particle.
struct SourceTerms {
  double density = 0;      ///< ρ [kg/m³]
  double time_step = 0;    ///< Δt [s]
  double compression = 0;  ///< (n − n0)/n0 [-]
  double divergence = 0;   ///< ∇·u* [1/s]
  /// What the Laplacian sums up of a pressure without curvature where neighbours lie on one side
  /// only [Pa/m²]; see BalancedSource.
  double asymmetry = 0;
  double density_rate = 0;       ///< (1/n0) Dn/Dt by u* [1/s]
  double last_density_rate = 0;  ///< (1/n0) Dn/Dt by u before the predictor [1/s]
  /// Itself or a neighbour lies on the free surface, or a neighbour has no pressure: n is not that of
  /// the fluid alone.
  bool at_edge = false;
};

/// Has value(terms) [Pa/m²] and says whether its n is that of moved particles, and which of the
/// dearer terms it needs. It may also say that
///   balances_forces      it uses asymmetry; solids then have Δt F for u* in its divergence
///   needs_density_rate   it uses density_rate and last_density_rate
template <class S>
concept PressureSource = requires(const S source, SourceTerms terms) {
  { source.value(terms) } -> std::convertible_to<double>;
  { S::needs_moved_particles } -> std::convertible_to<bool>;
  { S::needs_divergence } -> std::convertible_to<bool>;
  source.check();
};

template <class S>
constexpr bool balances_forces() {
  if constexpr (requires { S::balances_forces; }) return S::balances_forces;
  return false;
}
template <class S>
constexpr bool needs_density_rate() {
  if constexpr (requires { S::needs_density_rate; }) return S::needs_density_rate;
  return false;
}

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

/// (16) in balance with body forces. Where neighbours are missing, the Laplacian (6) of a pressure
/// that only rises linearly is not zero, and without a remedy fluid moves until something makes up
/// for it. Beyond walls the pressure rises by ρ F, beyond the free surface as it did before (k):
///
///   (ρ/Δt) ∇·u* + 2d/(λ n0) [ Σ_all w r_ij·<∇P^k>_i − Σ_without-pressure w r_ij·ρF ]
///     + γ (ρ/Δt²) (n0 − n)/n0
///
/// with solids whose u* is Δt F, as the fluid's. Fluid at rest then stays at rest, and fluid in free
/// fall has no pressure, wherever its particles are. At edges, where n is low anyway, only
/// compression counts.
struct BalancedSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool needs_divergence = true;
  static constexpr bool balances_forces = true;

  double gamma = 0.01;  ///< γ [-] in [0, 1]: how much of the density error is corrected in a step

  void check() const { require_between("BalancedSource: gamma", gamma, {0, 1}); }
  double value(const SourceTerms& s) const {
    const double excess = s.at_edge ? std::max(0.0, s.compression) : s.compression;
    return s.density / s.time_step * s.divergence + s.asymmetry -
           gamma * s.density / (s.time_step * s.time_step) * excess;
  }
};

}  // namespace silt::mps
