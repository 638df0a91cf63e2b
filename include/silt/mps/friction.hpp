// SPDX-License-Identifier: MIT
// Friction between particles, which takes away the noise of their velocities.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/four.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vec_pack.hpp>
#include <silt/mps/any_particle_view.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/velocity_gradient.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <type_traits>
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
///   δu_i = d/n0 Σ_j ½(a_i + a_j) (w/r²) s_ij r_ij,   a_i = rate Δt √(|F_i|/l0) ≤ 0.2
///   s_ij = u_ij·r_ij − r_ij·½(∇u_i + ∇u_j)·r_ij
///
/// Without a force there is no friction, as fluid at rest then has no pressure to make noise. The
/// second term of s_ij never exceeds the first, nor has it another sign, so
/// that a pair never gains energy. Conserves momentum; linear flows, and pairs of which a particle
/// has too few neighbours for a gradient, have none. Not from the papers: it damps what the
/// gradient of the pressure and the divergence, which are not adjoint, leave of a random arrangement.
struct PairFriction {
  double rate = 0.2;  ///< [-], at least 0; of √(g/l0). At 1, surfaces are stiller, and swings die sooner.

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

  template <class Step>
  void find(const Step& step) {
    const auto& particles = step.particles;
    const auto u = particles.with_ghosts(velocity);
    const auto kinds = particles[kind];
    const Real per_root = rate_ * Real(step.time_step) / std::sqrt(Real(step.settings.spacing));
    strains_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      Strain& strain = strains_[i];
      strain = {};
      if (kinds[i] != Kind::fluid) return;
      const auto gradient = velocity_gradient(u, i, step.operators);
      if (!gradient.is_known) return;
      constexpr Real max_share = Real(0.2);
      strain.share() = std::min(max_share, per_root * std::sqrt(step.force[i].norm())) / 2;
      // Only its symmetric part stretches r_ij. A pair has half of each particle.
      for (int a = 0; a < Dim; ++a) {
        strain.stretching[std::size_t(a)] = gradient.value(a, a) / 2;
        for (int b = 0; b < a; ++b) {
          strain.shearing[std::size_t(a + b - 1)] = (gradient.value(a, b) + gradient.value(b, a)) / 2;
        }
      }
    });
  }

  template <class View>
  [[gnu::flatten]] Vec velocity_change(const View& at) const {
    const auto& stencil = at.stencil();
    const Index i = at.index();
    const Strain own = strains_[i];
    if (!own.is_known()) return Vec::Zero();
    const auto& neighbourhood = at.neighbourhood();
    const auto row = neighbourhood[i];
    const auto x = neighbourhood.positions();
    const auto u = at.velocities();
    VecPack<Dim, Real> x_i, u_i, change;
    set_zero<Dim, Real>(change);
    load_vec(x[i], x_i);
    load_vec(u[i], u_i);
    for (Index k = 0; k < row.size(); ++k) {
      const Index j = row.index[k];
      const Strain& other = strains_[at.owner(j)];
      if (!other.is_known()) continue;
      VecPack<Dim, Real> r_ij, u_ij;
      load_vec(x[j], r_ij);
      load_vec(u[j], u_ij);
      r_ij -= x_i;
      u_ij -= u_i;
      const Real along = dot_of<Dim, Real>(u_ij, r_ij);
      const Real linear = Strain::along(own, other, r_ij);
      const Real rest =
          along - std::clamp(linear, std::min(along, Real(0)), std::max(along, Real(0)));
      const Real factor = (own.share() + other.share()) * Real(row.weight_over_square[k]) * rest;
      change += factor * r_ij;
    }
    return (Dim / stencil.n0) * to_vec<Dim, Real>(change);
  }

 private:
  // Numbers that are loaded together, and do not cross a cache line.
  struct alignas((Dim == 2 ? 4 : 8) * sizeof(Real)) Strain {
    static constexpr Real unknown = -1;

    std::array<Real, Dim == 2 ? 2 : 4> stretching{};
    std::array<Real, Dim == 2 ? 2 : 4> shearing = none();  // and, as the last one, the share

    Real& share() { return shearing.back(); }
    Real share() const { return shearing.back(); }
    bool is_known() const { return share() >= 0; }

    // r·∇u r of both.
    [[gnu::always_inline]] static inline Real along(const Strain& one, const Strain& other,
                                                    const VecPack<Dim, Real>& r) {
      if constexpr (Dim == 2 || !fits_in_register<Dim, Real>) {
        const auto of = [&](const Strain& strain) -> Real {
          const auto& [along_axes, across] = strain;
          Real sum = along_axes[0] * (r[0] * r[0]) + along_axes[1] * (r[1] * r[1]);
          if constexpr (Dim == 3) sum += along_axes[2] * (r[2] * r[2]);
          sum += across[0] * r[0] * r[1];
          if constexpr (Dim == 3) sum += (across[1] * r[0] + across[2] * r[1]) * r[2];
          return sum;
        };
        return of(one) + of(other);
      } else {
        Four<Real> a, b, c, d;
        load_four(one.stretching.data(), a);
        load_four(other.stretching.data(), b);
        load_four(one.shearing.data(), c);
        load_four(other.shearing.data(), d);
        const Four<Real> squares = r * r;
        const Four<Real> across = __builtin_shufflevector(r, r, 0, 0, 1, 3);  // the last one is 0
        a *= squares;
        b *= squares;
        c *= across;
        d *= across;
        // In two lanes: for one and the other.
        using Two = simd::Pack<Real, 2>;
        const auto both = []<int k>(const Four<Real>& p, const Four<Real>& q,
                                    std::integral_constant<int, k>) -> Two {
          return __builtin_shufflevector(p, q, k, 4 + k);
        };
        constexpr std::integral_constant<int, 0> first;
        constexpr std::integral_constant<int, 1> second;
        constexpr std::integral_constant<int, 2> third;
        Two sum = both(a, b, first) + both(a, b, second) + both(a, b, third);
        sum += both(c, d, first) * r[1];
        sum += (both(c, d, second) + both(c, d, third)) * r[2];
        return sum[0] + sum[1];
      }
    }

   private:
    static constexpr auto none() {
      std::array<Real, Dim == 2 ? 2 : 4> numbers{};
      numbers.back() = unknown;
      return numbers;
    }
  };

  Real rate_;
  std::vector<Strain> strains_;  // of owned particles
};

/// The friction of a flow in Dim dimensions:
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

}  // namespace silt::mps
