// SPDX-License-Identifier: MIT
// Restitution, and a normal dashpot that yields it to second order in the time step.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

namespace silt::dem {

/// Restitution e of a head-on impact whose contact ends at zero overlap (the total force may be
/// attractive just before), and the damping ratio that yields it: ζ = −ln e / √(π² + ln² e).
struct Restitution {
  double value = 1;          ///< e [-]
  double damping_ratio = 0;  ///< ζ [-]

  constexpr Restitution() = default;
  /// From e [-]; check() tests its range.
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

/// Weight [-] of a force that is discontinuous at the beginning and end of a contact, such as a
/// dashpot's, at this overlap [m], which changes by `change_per_step` [m] in a step.
///
/// A contact begins and ends somewhere within a step. With u steps since the beginning (or before
/// the end), the weights of the steps u and u + 1 must add up to u + 3/2; this is the continuous
/// weight that satisfies this and is 1 from u = 2 on.
template <class Real>
Real share_of_step(Real overlap, Real change_per_step) {
  const Real u = overlap / change_per_step;
  return choose(u < 1, Real(u * 3 / 2), larger(Real(1), Real(2 - u / 2)));
}

/// D_n = c v_n with v_n at the time N of the positions: second order in Δt.
struct CentredDashpot {
  /// An approach speed of no contact [m/s]; finite, so that a checkpoint may contain it.
  static constexpr float unknown = std::numeric_limits<float>::lowest();

  template <class Real>
  struct History {
    Real approach_speed = unknown;  ///< v_n^{N−3/2}; `unknown` before the first step [m/s]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("approach_speed", approach_speed);
    }
  };

  /// D_n [N] of a dashpot c_n parallel to a spring of (tangent) stiffness k_n: (22) of
  /// [SahChoi2004] with v_n^N instead of v_n^{N−½}, which lags by half a step. v_n^N is
  /// extrapolated from the last two half steps, v_n^N = v_n^{N−½} + ½ (v_n^{N−½} − v_n^{N−3/2}).
  template <class C, class M>
  static typename C::Real force(const C& contact, M& history, typename C::Real k_n,
                                typename C::Real c_n) {
    using std::abs;
    using Real = typename C::Real;
    const Real v_half = contact.approach_speed();
    // In the first step there is no previous value: v_n was constant before the contact.
    const Real v_before = history.approach_speed == unknown ? v_half : history.approach_speed;
    const Real v_n = v_half + (v_half - v_before) / 2;
    history.approach_speed = v_half;
    // The extrapolated velocity of an oscillation is too large by the factor 1 + ⅜ (ω Δt)².
    const Real m = contact.effective_mass;
    const Real dt = contact.kick();
    return c_n * v_n * share_of_step(contact.overlap, Real(abs(v_n) * dt)) * m /
           (m + k_n * squared(dt) * 3 / 8);
  }

  /// With the extrapolation a dashpot counts twice in the stability limit.
  static constexpr double stability_factor = 2;
};

/// The dashpot force [N]; if `limits`, limited so that the sum with the spring force is not
/// attractive.
template <class Real>
Real limited_dashpot(bool limits, Real spring, Real dashpot) {
  const Real limited = choose(spring + dashpot < 0, Real(-spring), dashpot);
  return choose(limits, limited, dashpot);
}

}  // namespace silt::dem
