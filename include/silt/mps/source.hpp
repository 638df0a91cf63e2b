// SPDX-License-Identifier: MIT
// Sources of the pressure equation ∇²P = source, [HwangLeePark2010] (9), (16). A compressed
// particle (n > n0) gets a negative source, and with it a higher pressure.
#pragma once

#include <silt/core/error.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// Input of a source, for one particle.
struct SourceTerms {
  double density = 0;      ///< ρ [kg/m³]
  double time_step = 0;    ///< Δt [s]
  double compression = 0;  ///< (n − n0)/n0 [-]
  double divergence = 0;   ///< ∇·u* [1/s]
  /// Error of the Laplacian of a linear pressure where neighbours are missing on one side [Pa/m²];
  /// see BalancedSource.
  double asymmetry = 0;
  double density_rate = 0;       ///< (1/n0) Dn/Dt from u* [1/s]
  double last_density_rate = 0;  ///< the same from u before the predictor [1/s]
  /// The particle or a neighbour lies on the free surface, or a neighbour has no pressure; n is
  /// then not comparable with n0.
  bool near_boundary = false;
};

/// value(terms) returns ∇²P [Pa/m²]; needs_moved_particles selects n*, of the particles moved with
/// u*; needs_divergence requests the divergence. Optional, true if
///   balances_forces      asymmetry is used; in the divergence, walls and dummies have u* = Δt F
///   needs_density_rate   density_rate and last_density_rate are used
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

/// −(ρ/Δt²) (n* − n0)/n0, n* of the particles moved with u* (9): the original MPS.
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

  double gamma = 0.01;  ///< γ [-] in [0, 1]: fraction of the density error corrected per step

  void check() const { require_between("DivergenceSource: gamma", gamma, {0, 1}); }
  double value(const SourceTerms& s) const {
    return s.density / s.time_step * s.divergence -
           gamma * s.density / (s.time_step * s.time_step) * s.compression;
  }
};

/// (16) in balance with body forces. Where neighbours are missing, the Laplacian (6) of a linear
/// pressure is not zero, and fluid at rest starts to move. The source therefore includes this
/// error, with the pressure gradient ρ F beyond walls and that of the previous step (k) elsewhere:
///
///   (ρ/Δt) ∇·u* + 2d/(λ n0) [ Σ_all w r_ij·<∇P^k>_i − Σ_without-pressure w r_ij·ρF ]
///     + γ (ρ/Δt²) (n0 − n)/n0
///
/// where walls and dummies have u* = Δt F, as fluid at rest has. Fluid at rest then stays at rest,
/// and fluid in free fall has no pressure, for any arrangement of particles. Near boundaries, where
/// n is low, only compression enters the last term.
struct BalancedSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool needs_divergence = true;
  static constexpr bool balances_forces = true;

  double gamma = 0.01;  ///< γ [-] in [0, 1]: fraction of the density error corrected per step

  void check() const { require_between("BalancedSource: gamma", gamma, {0, 1}); }
  double value(const SourceTerms& s) const {
    const double excess = s.near_boundary ? std::max(0.0, s.compression) : s.compression;
    return s.density / s.time_step * s.divergence + s.asymmetry -
           gamma * s.density / (s.time_step * s.time_step) * excess;
  }
};

}  // namespace silt::mps
