// SPDX-License-Identifier: MIT
// Friction between particles, which takes away the noise of their velocities.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/any_particle_view.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/velocity_gradient.hpp>
#include <silt/mps/walls.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <vector>

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
///   δu_i = d/n0 Σ_j a_ij (w/r²) s_ij r_ij,   a_ij = rate Δt √(F/l0) ≤ 0.2
///   s_ij = u_ij·r_ij − r_ij·½(∇u_i + ∇u_j)·r_ij
///
/// F is the mean of |F_i| and |F_j|: fluid in free fall has no friction, as it has no pressure that
/// could make noise. The second term of s_ij never exceeds the first, nor has it another sign, so
/// that a pair never gains energy. Conserves momentum; linear flows, and pairs of which a particle
/// has too few neighbours for a gradient, have none. Not from the papers: it damps what the
/// gradient of the pressure and the divergence, which are not adjoint, leave of a random arrangement.
struct PairFriction {
  double rate = 0.3;  ///< [-], at least 0; of √(g/l0). At 1, jittered water is stiller, and swings die
                      ///< sooner.

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

  /// The velocity gradients of the fluid.
  template <FluidParticles P, class Operators>
  void find(const P& particles, const Operators& operators) {
    const auto u = particles.with_ghosts(velocity);
    const auto kinds = particles[kind];
    gradients_.assign(particles.size(), {});
    for_each(particles.size(), [&](Index i) {
      if (kinds[i] == Kind::fluid) gradients_[i] = velocity_gradient(u, i, operators);
    });
  }

  template <class View>
  Vec velocity_change(const View& at) const {
    constexpr Real max_share = Real(0.2);
    const auto& stencil = at.stencil();
    const Index i = at.index();
    const auto& own = gradients_[i];
    Vec change = Vec::Zero();
    if (!own.is_known) return change;
    const auto u = at.velocities();
    const auto kinds = at.kinds();
    const Vec u_i = at.velocity();
    const Real force = at.force().norm();
    const Real scale = rate_ * Real(at.time_step());
    for_each_weighted(
        at.neighbourhood(), i, stencil, [&](Index j, const Vec& r_ij, Real, Real w_r2) {
          if (kinds[j] != Kind::fluid) return;
          const auto& other = gradients_[at.owner(j)];
          if (!other.is_known) return;
          const Real along = (u[j] - u_i).dot(r_ij);
          const Real linear =
              (quadratic_form(own.value, r_ij) + quadratic_form(other.value, r_ij)) / 2;
          const Real rest = along - std::clamp(linear, std::min(along, Real(0)),
                                               std::max(along, Real(0)));
          const Real mean_force = (force + at.force(at.owner(j)).norm()) / 2;
          const Real share = std::min(max_share, scale * std::sqrt(mean_force / stencil.spacing));
          change += (share * w_r2 * rest) * r_ij;
        });
    return (Dim / stencil.n0) * change;
  }

 private:
  using Gradient = VelocityGradient<Dim, Real>;

  static Real quadratic_form(const typename Gradient::Matrix& m, const Vec& r) {
    Real sum = 0;
    for (int b = 0; b < Dim; ++b) sum += r[b] * m.col(b).dot(r);
    return sum;
  }

  Real rate_;
  std::vector<Gradient> gradients_;  // of owned particles
};

/// The friction of a flow in Dim dimensions:
///   find(particles, operators)   before the velocities are changed
///   velocity_change(at)          of a fluid particle [m/s], from its ParticleView
template <class F, int Dim>
concept FrictionInFlow =
    requires(F friction, const F found, const Fluid<Dim> particles,
             const detail::AnyOperators<Dim> operators, const detail::AnyParticleView<Dim> at) {
      friction.find(particles, operators);
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

}  // namespace silt::mps
