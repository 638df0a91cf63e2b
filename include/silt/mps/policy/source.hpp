// SPDX-License-Identifier: MIT
// Sources of the pressure equation ∇²P = source, [HwangLeePark2010] (9), (16). A compressed
// particle (n > n0) gets a negative source, and with it a higher pressure.
#pragma once

#include <silt/core/error.hpp>
#include <silt/mps/policy/any_particle_view.hpp>

#include <concepts>
#include <type_traits>

namespace silt::mps {

// The name of a member is ambiguous in a class that derives from two with such a member.
namespace detail {

struct HasBegin {
  int begin;
};
template <class S>
struct BothBegin : S, HasBegin {};

}  // namespace detail

/// Whether a source that is not final has a member function begin(step), which may be a template.
template <class S>
concept BeginsSteps = !std::is_final_v<S> && !requires { &detail::BothBegin<S>::begin; };

/// value(at) returns ∇²P [Pa/m²] at a particle, from its ParticleView; needs_moved_particles
/// selects n*, of the particles moved with u*. Optionally, begin(step) is called before the
/// predictor with a StepView, so that the source may keep what is lost during the step. What it
/// keeps is neither restored after a throw nor saved in a checkpoint: begin() has to set all of it.
template <class S>
concept PressureSource = requires(const S source, const detail::AnyParticleView<2>& in_2d,
                                  const detail::AnyParticleView<3>& in_3d) {
  { source.value(in_2d) } -> std::convertible_to<double>;
  { source.value(in_3d) } -> std::convertible_to<double>;
  { S::needs_moved_particles } -> std::convertible_to<bool>;
  source.check();
};

/// Sources with uses_last_pressure = true are computed with the pressures of the previous step. In
/// the first step of a flow, the solve is repeated until these are its own.
template <class S>
concept UsesLastPressure = requires { requires S::uses_last_pressure; };

/// −(ρ/Δt²) (n* − n0)/n0, n* of the particles moved with u*, [HwangLeePark2010] (9): the original
/// MPS.
struct DensitySource {
  static constexpr bool needs_moved_particles = true;

  void check() const {}
  double value(const auto& at) const {
    return -at.density() / (at.time_step() * at.time_step()) * at.compression();
  }
};

/// (ρ/Δt) ∇·u* + γ (ρ/Δt²) (n0 − n^k)/n0, [HwangLeePark2010] (16), [TanakaMasunaga2010].
struct DivergenceSource {
  static constexpr bool needs_moved_particles = false;

  double gamma = 0.01;  ///< γ [-] in [0, 1]: fraction of the density error corrected per step

  void check() const { require_between("DivergenceSource: gamma", gamma, {0, 1}); }
  double value(const auto& at) const {
    return at.density() / at.time_step() * at.divergence() -
           gamma * at.density() / (at.time_step() * at.time_step()) * at.compression();
  }
};

}  // namespace silt::mps
