// SPDX-License-Identifier: MIT
// Global damping: a drag force on every particle, proportional to its mass and velocity.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// No damping: undamped leapfrog, [SahChoi2004] (17), (18).
struct NoDamping {
  template <class Value, class Real>
  Value kicked(const Value& v, const Value& acceleration, Real dt) const {
    return v + dt * acceleration;
  }

  template <class Value>
  Value drag(const Value&) const {
    return zero_of<Value>();
  }
};

/// C = α m, C* = α I, [SahChoi2004] (31)–(33).
struct GlobalDamping {
  double alpha = 0;  ///< α: decay rate of the velocity of a free particle [1/s]; 0: none

  /// Throws if alpha is negative or not finite.
  void check() const { require_not_negative("GlobalDamping: alpha", alpha); }

  /// Throws if α Δt > 2 for the time step Δt [s]: a step would reverse the velocities.
  void check(double time_step) const {
    if (alpha * time_step > 2) {
      fail({"GlobalDamping: alpha = ", alpha, " 1/s reverses velocities in a step of ", time_step,
            " s; use a time step of at most ", 2 / alpha, " s"});
    }
  }

  /// v^{N+½} = { v^{N−½} (1 − α Δt/2) + a Δt } / (1 + α Δt/2)        (32), and (33) for the spin
  template <class Value, class Real>
  Value kicked(const Value& v, const Value& acceleration, Real dt) const {
    const Real half = Real(alpha) * dt / 2;
    return (v * (1 - half) + acceleration * dt) / (1 + half);
  }

  /// v^{N−½} = v^N (1 + α Δt/2) − a Δt/2, so that v^N is the mean (27) of its two half steps.
  template <class Value, class Real>
  Value half_step_before(const Value& v, const Value& acceleration, Real dt) const {
    return v * (1 + Real(alpha) * dt / 2) - (dt / 2) * acceleration;
  }

  /// Acceleration due to damping, −α v^N [m/s²].
  template <class Value>
  Value drag(const Value& v) const {
    return -alpha * v;
  }
};

/// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28), from v^{N−½} [m/s] and the acceleration at N [m/s²].
template <class D, class Real>
[[gnu::always_inline]] inline Real kicked_to_mean(const D& damping, Real v, Real a, Real dt) {
  return static_cast<Real>((damping.kicked(v, a, dt) + v) / 2);
}
/// v^{N−½} from v^N [m/s] and the acceleration at N [m/s²].
template <class D, class Real>
[[gnu::always_inline]] inline Real half_step_back(const D& damping, Real v, Real a, Real dt) {
  if constexpr (requires { damping.half_step_before(v, a, dt); }) {
    return static_cast<Real>(damping.half_step_before(v, a, dt));
  } else {
    return static_cast<Real>(v - a * (dt / 2));
  }
}

}  // namespace silt
