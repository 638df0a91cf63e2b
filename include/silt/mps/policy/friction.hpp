// SPDX-License-Identifier: MIT
// Friction between particles, which takes away the noise of their velocities.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/step_changes.hpp>
#include <silt/mps/operator/velocity_gradient.hpp>
#include <silt/mps/policy/any_particle_view.hpp>
#include <silt/mps/policy/friction_of_pairs.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>

namespace silt::mps {

/// Pairs of particles have no friction but that of the viscosity.
struct NoFriction {
  void check() const {}

  template <int Dim, class Real>
  struct InFlow {
    explicit InFlow(const NoFriction&) {}
  };
};

/// Friction of pairs of fluid particles along r_ij, on the part of their relative velocity that no
/// linear flow has:
///
///   δu_i = d/n0 Σ_j ½(a_i + a_j) (w/r²) s_ij r_ij,   a_i = rate Δt √(|F_i|/l0) ≤ 0.2
///   s_ij = u_ij·r_ij − r_ij·½(∇u_i + ∇u_j)·r_ij
///
/// Without a force there is no friction, as fluid at rest then has no pressure to make noise. The
/// second term of s_ij never exceeds the first, nor has it another sign, so
/// that a pair never gains energy. Conserves momentum; linear flows, and pairs of which a particle
/// has too few neighbours for a gradient, have none. Not from the papers: it damps what the
/// gradient of the pressure and the divergence, which are not adjoint, leave of a random arrangement.
struct PairFriction {
  /// [-], at least 0; of √(g/l0). At 1, surfaces are stiller, and swings die sooner.
  double rate = 0.2;

  void check() const { require_not_negative("PairFriction: rate", rate); }

  template <int Dim, class RealType>
  class InFlow;
};

template <int Dim, class RealType>
class PairFriction::InFlow {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  explicit InFlow(const PairFriction& friction) : rate_(Real(friction.rate)) {}

  /// Finds the strain of the flow around each particle, before its velocities are changed.
  template <class Step>
  void find(const Step& step) {
    const auto& particles = step.particles;
    const auto u = particles.with_ghosts(velocity);
    const auto kinds = particles[kind];
    const Real per_root = rate_ * Real(step.time_step) / std::sqrt(Real(step.settings.spacing));
    strains_.resize(particles.total());
    for_each_inlined(particles.size(), [&](Index i) {
      Strain& strain = strains_[i];
      if (kinds[i] != Kind::fluid) return strain.set_unknown();
      const auto gradient = velocity_gradient(u, i, step.operators);
      if (!gradient.is_known) return strain.set_unknown();
      constexpr Real max_share = Real(0.2);
      strain.share() = std::min(max_share, per_root * std::sqrt(step.force[i].norm())) / 2;
      // Only its symmetric part stretches r_ij. A pair has half of each particle.
      for (int a = 0; a < Dim; ++a) {
        strain.rate(a, a) = gradient.value(a, a) / 2;
        for (int b = 0; b < a; ++b) {
          strain.rate(a, b) = (gradient.value(a, b) + gradient.value(b, a)) / 2;
        }
      }
    });
    silt::detail::share(particles, strains_);
    for_each(particles.total() - particles.local(), [&](Index ghost) {
      const Index j = particles.local() + ghost;
      strains_[j] = strains_[particles.owner(j)];
    });
  }

  template <class View>
  Vec velocity_change(const View& at) const {
    if (!strains_[at.index()].is_known()) return Vec::Zero();
    return (Dim / at.stencil().n0) *
           SILT_FOR_PROCESSOR_UP_TO_AVX2(friction_of_pairs<Dim, Real, View>)(at, strains_.data());
  }

 private:
  using Strain = StrainForFriction<Dim, Real>;

  Real rate_;
  Buffer<Strain> strains_;  // with ghosts
};

/// The friction of a flow in Dim dimensions:
///
///   find(step)            from a StepView, before the velocities are changed
///   velocity_change(at)   of a fluid particle [m/s], from its ParticleView
template <class F, int Dim>
concept FrictionInFlow = requires(const F found, const detail::AnyParticleView<Dim>& at) {
  { found.velocity_change(at) } -> std::convertible_to<Vec<Dim>>;
};

/// F::InFlow<Dim, Real> is the friction of a flow, constructed from an F. What it keeps is neither
/// restored after a throw nor saved in a checkpoint: find() has to set all of it.
template <class F>
concept HasFriction = std::constructible_from<typename F::template InFlow<2, double>, const F&> &&
                      std::constructible_from<typename F::template InFlow<3, double>, const F&> &&
                      FrictionInFlow<typename F::template InFlow<2, double>, 2> &&
                      FrictionInFlow<typename F::template InFlow<3, double>, 3>;
/// Has friction, or is NoFriction.
template <class F>
concept Friction = (HasFriction<F> || std::same_as<F, NoFriction>) &&
                   requires(const F friction) { friction.check(); };

/// Finds the change of the velocity of every fluid particle by a FrictionInFlow [m/s], from a
/// StepView.
template <class InFlow, class Step, class Vec>
void find_friction(InFlow& friction, const Step& step, Buffer<Vec>& changes) {
  static_assert(requires { friction.find(step); },
                "mps: find() of the friction cannot be called with a const StepView");
  friction.find(step);
  find_changes(step.particles, changes,
               [&](Index i) -> Vec { return friction.velocity_change(step.at(i)); });
}

}  // namespace silt::mps
