// SPDX-License-Identifier: MIT
// A source of the pressure equation that keeps fluid at rest at rest.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/corrected_gradient.hpp>

#include <algorithm>

namespace silt::mps {

/// (16) in balance with body forces. Where neighbours are missing, the Laplacian (6) of a linear
/// pressure is not zero, and fluid at rest starts to move. The source therefore includes this
/// error, with the pressure gradient ρ F beyond walls and that of the previous step (k) elsewhere:
///
///   (ρ/Δt) ∇·u* + 2d/(λ n0) [ Σ_all w r_ij·⟨∇P^k⟩_i − Σ_without-pressure w r_ij·ρF ]
///     + γ (ρ/Δt²) (n0 − n)/n0
///
/// where walls and dummies have u* = Δt F, as fluid at rest has. Fluid at rest then stays at rest,
/// and fluid in free fall has no pressure, for any arrangement of particles. Near boundaries, where
/// n is low, only compression enters the last term.
struct BalancedSource {
  static constexpr bool needs_moved_particles = false;
  static constexpr bool uses_last_pressure = true;

  double gamma = 0.01;  ///< γ [-] in [0, 1]: fraction of the density error corrected per step

  void check() const { require_between("BalancedSource: gamma", gamma, {0, 1}); }
  double value(const auto& at) const {
    const double compression = at.compression();
    const double excess = at.near_boundary() ? std::max(0.0, compression) : compression;
    return at.density() / at.time_step() * divergence(at) + asymmetry(at) -
           gamma * at.density() / (at.time_step() * at.time_step()) * excess;
  }

 private:
  // u*, but with Δt F added for walls and dummies; or, if walls mirror the fluid, relative to Δt F
  // of the particle at which the divergence is taken, so that a mirrored fluid at rest is at rest.
  // Differences are the same.
  template <class View>
  struct BalancedVelocity {
    using Vec = typename View::Vec;

    const View& at;
    typename View::Velocities u = at.velocities();
    typename View::Kinds kinds = at.kinds();
    typename View::Real time_step = typename View::Real(at.time_step());
    Vec own_change = time_step * at.force(at.index());  // Δt F

    // Inlined, so that the sums over neighbours stay in registers.
    [[gnu::always_inline]] inline Vec operator[](Index j) const {
      if constexpr (View::has_images) {
        const bool is_fluid = View::all_have_pressure || kinds[j] == Kind::fluid;
        return is_fluid ? Vec(u[j] - own_change) : Vec(u[j]);
      } else {
        return kinds[j] == Kind::fluid ? Vec(u[j]) : Vec(u[j] + time_step * at.force(at.owner(j)));
      }
    }
  };
  template <class View>
  static double divergence(const View& at) {
    return double(at.divergence(BalancedVelocity<View>{.at = at}));
  }

  // The Laplacian of a linear pressure [Pa/m²].
  template <class View>
  [[gnu::flatten]] static double asymmetry(const View& at) {
    using Vec = typename View::Vec;
    const auto& stencil = at.laplacian_stencil();
    const Vec gradient = at.pressure_gradient(CorrectedGradient{});
    if constexpr (View::all_have_pressure) {  // Σ w r_ij · ∇P: both sums have the same factor
      return double(2 * View::dimension / (stencil.lambda * stencil.n0) *
                    gradient.dot(at.laplacian_moment()));
    }
    const Vec without_pressure = gradient - at.weight();
    typename View::Real sum = 0;
    at.for_each_in_laplacian([&](const auto& j) {
      sum += j.weight * j.r_ij.dot(at.has_pressure(j) ? gradient : without_pressure);
    });
    return double(2 * View::dimension / (stencil.lambda * stencil.n0) * sum);
  }
};

}  // namespace silt::mps
