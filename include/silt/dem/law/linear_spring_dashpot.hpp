// SPDX-License-Identifier: MIT
// Normal component: a linear spring, and a dashpot given by the restitution.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/law_components.hpp>

#include <cmath>

namespace silt::dem {

/// F = k δ + c v_n with c = 2 ζ √(k m*). Without other forces, an impact at any speed has exactly
///
///   e = exp(−π ζ/√(1 − ζ²)), t_c = π/(ω √(1 − ζ²)), ω = √(k/m*).
/// With Δt = t_c/50 the restitution is within 0.5 % of the given e.
struct LinearSpringDashpot {
  double normal_stiffness = 0;   ///< k [N/m], above 0
  Restitution restitution = {};  ///< e [-] in (0, 1]
  /// Limits the dashpot so that the normal force is never attractive; the restitution is then the
  /// larger e_clip(ζ) of [SchwagerPoeschel2007].
  bool limit_damping = false;

  template <int, class Real>
  using History = CentredDashpot::History<Real>;

  void check() const {
    check_magnitude("LinearSpringDashpot: normal_stiffness", normal_stiffness);
    restitution.check("LinearSpringDashpot: restitution");
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real k = Real(normal_stiffness);
    const Real beta = dashpot_over_spring(contact.effective_mass);
    const Real spring = k * contact.overlap;
    const Real dashpot = CentredDashpot::force(contact, history, k, beta * k);
    return {.spring = spring,
            .dashpot = limited_dashpot(limit_damping, spring, dashpot),
            .stiffness = k,
            .beta = beta};
  }

  template <class C, class M>
  double elastic_energy(const C& contact, const M&) const {
    return normal_stiffness * squared(double(contact.overlap)) / 2;
  }

  template <class C>
  Stiffness stiffness(const C& contact) const {
    return {.normal = normal_stiffness,
            .beta = CentredDashpot::stability_factor *
                    double(dashpot_over_spring(contact.effective_mass))};
  }

  /// Springs in series (equal stiffnesses are kept), the lower restitution; the dashpot is limited
  /// if either one is.
  static LinearSpringDashpot mix(const LinearSpringDashpot& a, const LinearSpringDashpot& b) {
    return {.normal_stiffness = in_series(a.normal_stiffness, b.normal_stiffness),
            .restitution = Restitution::mix(a.restitution, b.restitution),
            .limit_damping = a.limit_damping || b.limit_damping};
  }

 private:
  // c/k = 2 ζ √(m*/k) [s].
  template <class Real>
  Real dashpot_over_spring(Real effective_mass) const {
    using std::sqrt;
    return Real(2 * restitution.damping_ratio / std::sqrt(normal_stiffness)) * sqrt(effective_mass);
  }
};

}  // namespace silt::dem
