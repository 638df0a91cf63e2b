// SPDX-License-Identifier: MIT
// Resistance to rolling and, in 3D, to twisting: a spring, a dashpot and a slider that act on the
// relative spin, type C of Ai, Chen, Rotter and Ooi (2011).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_components.hpp>
#include <silt/dem/law/slider.hpp>

#include <algorithm>
#include <cmath>

namespace silt::dem {

/// M^N = M^{N−1} − k_r w Δt, limited to μ_r R* F_n, with k_r = 2.25 k_n (μ_r R*)² and w the
/// relative spin perpendicular to the normal; the vector M rotates with the contact plane. The
/// dashpot is 2 η √(I_r k_r), and 0 while the slider slides. [AiChenRotterOoi2011], with
/// I_r = 7/5 m* R*²: exact for a sphere at a wall; between equal spheres η corresponds to half of
/// that paper's.
///
/// In 3D the relative spin along the normal is resisted likewise, with μ_t instead of μ_r. A sphere
/// stays at rest on an incline of tan θ ≤ μ_r. If k_n depends on the overlap, so does k_r, and M is
/// rescaled as Mindlin's force is.
struct RollingResistance {
  double rolling_friction = 0;   ///< μ_r [-] in [0, 2]; 0: free rolling
  double twisting_friction = 0;  ///< μ_t [-] in [0, 2]; 0: free twisting; unused in 2D
  double damping_ratio = 0.3;    ///< η [-]

  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> rolling = Vec<Dim, Real>::Zero();  ///< spring couple on i, normal to n [N m]
    Real twisting = 0;                                ///< spring couple on i along n [N m]
    Real stiffness = 0;                               ///< k_n of the previous step [N/m]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("rolling", rolling);
      archive("twisting", twisting);
      archive("stiffness", stiffness);
    }
  };
  template <class Real>
  struct History<2, Real> {
    Real rolling = 0;    ///< spring couple on i [N m]
    Real stiffness = 0;  ///< k_n of the previous step [N/m]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("rolling", rolling);
      archive("stiffness", stiffness);
    }
  };

  void check() const {
    check_resistance("RollingResistance: rolling_friction", rolling_friction);
    check_resistance("RollingResistance: twisting_friction", twisting_friction);
    require_not_negative("RollingResistance: damping_ratio", damping_ratio);
  }

  template <class C, class M>
  RollingCouple<C> rolling_couple(const C& contact, const NormalForce<C>& normal,
                                  M& history) const {
    using Real = typename C::Real;
    using Number = Vec<1, Real>;
    const Real ratio = normal.stiffness / history.stiffness;
    history.stiffness = normal.stiffness;
    if constexpr (C::dimension == 2) {
      const auto roll = resist(Real(rolling_friction), contact, normal, ratio,
                               Number(history.rolling), Number(contact.relative_spin));
      history.rolling = roll.spring[0];
      return {.spring = roll.spring[0], .dashpot = roll.dashpot[0], .friction = roll.lost};
    } else {
      const auto& n = contact.normal;
      const Real about_n = contact.relative_spin.dot(n);
      const auto roll = resist(Real(rolling_friction), contact, normal, ratio,
                               rotated_into_plane(history.rolling, n),
                               typename C::Vec(contact.relative_spin - about_n * n));
      const auto twist = resist(Real(twisting_friction), contact, normal, ratio,
                                Number(history.twisting), Number(about_n));
      history.rolling = roll.spring;
      history.twisting = twist.spring[0];
      return {.spring = roll.spring + twist.spring[0] * n,
              .dashpot = roll.dashpot + twist.dashpot[0] * n,
              .friction = roll.lost + twist.lost};
    }
  }

  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    const double R = double(contact.effective_radius);
    const double k_n = double(history.stiffness);
    if constexpr (C::dimension == 2) {
      return energy_of_spring(Vec<1>(double(history.rolling)), of(rolling_friction, R, k_n));
    } else {
      return energy_of_spring(history.rolling, of(rolling_friction, R, k_n)) +
             energy_of_spring(Vec<1>(double(history.twisting)), of(twisting_friction, R, k_n));
    }
  }

  template <class C>
  Stiffness stiffness(const C& contact, Stiffness normal) const {
    const double R = double(contact.effective_radius);
    const double mu = std::max(rolling_friction, C::dimension == 2 ? 0 : twisting_friction);
    normal.rolling = of(mu, R, normal.normal);
    normal.rolling_dashpot = dashpot(mu, R, double(contact.effective_mass), normal.normal);
    return normal;
  }

  /// The smaller of both coefficients, the higher damping ratio.
  static RollingResistance mix(const RollingResistance& a, const RollingResistance& b) {
    return {.rolling_friction = std::min(a.rolling_friction, b.rolling_friction),
            .twisting_friction = std::min(a.twisting_friction, b.twisting_friction),
            .damping_ratio = std::max(a.damping_ratio, b.damping_ratio)};
  }

 private:
  // k_r [N m/rad].
  template <class Real>
  static Real of(Real mu, Real R, Real k_n) {
    return Real(2.25) * k_n * squared(mu * R);
  }

  // 2 η √(7/5 m k_r) R [N m s].
  template <class Real>
  Real dashpot(Real mu, Real R, Real m, Real k_n) const {
    using std::sqrt;
    return Real(2 * damping_ratio * sqrt(1.4 * 2.25)) * mu * squared(R) * sqrt(m * k_n);
  }

  // If not inlined early, this call would keep g++ from vectorising over eight contacts.
  template <class C, class V>
  [[gnu::always_inline]] SliderForce<V> resist(typename C::Real mu, const C& contact,
                                               const NormalForce<C>& normal, typename C::Real ratio,
                                               const V& before, const V& spin) const {
    using Real = typename C::Real;
    const Real R = contact.effective_radius;
    const Real k = of(mu, R, normal.stiffness);
    const Slider<Real> slider{.stiffness = k,
                              .dashpot = dashpot(mu, R, contact.effective_mass, normal.stiffness),
                              .limit = larger(Real(0), Real(mu * R * normal.spring))};
    const auto kept = with_stiffness(k, ratio, before, V(spin * contact.time_step));
    auto result = slide(slider, kept.force, spin, contact);
    result.lost += kept.lost;
    return result;
  }
};

}  // namespace silt::dem
