// SPDX-License-Identifier: MIT
// Global damping: drag on every particle, proportional to its mass and velocity.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// Plain leapfrog, [SahChoi2004] (17) (18).
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
  double alpha = 0;  ///< rate at which a free particle loses its velocity α [1/s]; 0: none

  /// Throws if alpha is negative or not finite.
  void check() const { require_not_negative("GlobalDamping: alpha", alpha); }

  /// Throws if α Δt is above 2: the step would turn velocities round.
  void check(double time_step) const {
    if (alpha * time_step > 2) {
      fail("GlobalDamping: alpha = " + to_text(alpha) + " 1/s turns velocities round in a step of " +
           to_text(time_step) + " s; take at most " + to_text(2 / alpha) + " s");
    }
  }

  /// v^{N+½} = { v^{N−½} (1 − α Δt/2) + a Δt } / (1 + α Δt/2)        (32), and (33) for the spin
  template <class Value, class Real>
  Value kicked(const Value& v, const Value& acceleration, Real dt) const {
    const Real half = Real(alpha) * dt / 2;
    return (v * (1 - half) + acceleration * dt) / (1 + half);
  }

  /// v^{N−½} = v^N (1 + α Δt/2) − a Δt/2: what makes v^N the mean (27) of its two half steps.
  template <class Value, class Real>
  Value half_step_before(const Value& v, const Value& acceleration, Real dt) const {
    return v * (1 + Real(alpha) * dt / 2) - (dt / 2) * acceleration;
  }

  /// Its part of the acceleration, −α v^N [m/s²].
  template <class Value>
  Value drag(const Value& v) const {
    return -alpha * v;
  }
};

}  // namespace silt
