// SPDX-License-Identifier: MIT
// Restitution, and a dashpot along the normal that gives it to second order in the time step.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace silt::dem {

/// Restitution e of a head-on impact whose contact ends at zero overlap (the dashpot may pull
/// there), with the damping ratio that gives it: ζ = −ln e / √(π² + ln² e).
struct Restitution {
  double value = 1;
  double damping_ratio = 0;

  constexpr Restitution() = default;
  Restitution(double e)
      : value(e),
        damping_ratio(-std::log(e) /
                      std::sqrt(std::numbers::pi * std::numbers::pi + squared(std::log(e)))) {}

  /// Throws unless 0 < e ≤ 1.
  void check(std::string_view name) const {
    require_positive(name, value);
    require_between(name, value, {0, 1});
  }

  /// The lower one.
  static Restitution mix(const Restitution& a, const Restitution& b) {
    return b.value < a.value ? b : a;
  }
};

/// Weight [-] of a force that begins and ends with a jump, such as a dashpot's, at this overlap [m]
/// of a contact that goes way_of_a_step [m] in a step.
///
/// A contact begins and ends somewhere within a step. With u steps since the beginning (or before
/// the end), the steps u and u + 1 must together carry u + 3/2 steps' worth of the force; this is
/// the continuous weight that does and that is 1 from u = 2 on.
template <class Real>
Real share_of_step(Real overlap, Real way_of_a_step) {
  const Real u = overlap / way_of_a_step;
  return u < 1 ? u * 3 / 2 : std::max(Real(1), 2 - u / 2);
}

/// D_n = c v_n with the velocity at N itself: second order in Δt.
struct CentredDashpot {
  template <class Real>
  struct History {
    Real approach_speed = 0;  ///< v_n of the half step before the last [m/s]
    Real was_there = 0;       ///< 1 once approach_speed is known [-]
  };

  /// D_n [N] of a dashpot c_n beside a spring of (tangent) stiffness k_n, (22) of [SahChoi2004]
  /// with v_n^N in place of v_n^{N−½}, which is half a step late: extrapolated from the last two
  /// half steps, v_n^N = v_n^{N−½} + ½ (v_n^{N−½} − v_n^{N−3/2}).
  template <class C, class M>
  static typename C::Real force(const C& contact, M& history, typename C::Real k_n,
                                typename C::Real c_n) {
    using Real = typename C::Real;
    const Real v_half = contact.approach_speed();
    // Before it touched, it flew freely.
    const Real v_n = v_half + history.was_there * (v_half - history.approach_speed) / 2;
    history.approach_speed = v_half;
    history.was_there = 1;
    // Extrapolated, the velocity of an oscillation is too large by the factor 1 + ⅜ (ω Δt)².
    const Real swing = k_n * squared(contact.time_step) / contact.effective_mass;
    return c_n * v_n * share_of_step(contact.overlap, std::abs(v_n) * contact.time_step) /
           (1 + swing * 3 / 8);
  }

  /// Extrapolation makes a dashpot count twice in the limit of stability.
  static constexpr double lateness = 2;
};

/// The dashpot's force, where it may pull no harder than the spring pushes [N].
template <class Real>
Real limited_dashpot(Real spring, Real dashpot) {
  return spring + dashpot < 0 ? -spring : dashpot;
}

}  // namespace silt::dem
