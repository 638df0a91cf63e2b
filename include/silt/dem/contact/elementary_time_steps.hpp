// SPDX-License-Identifier: MIT
// Elementary time steps of DEM: the paper's critical one, the contact duration, and the stability
// limit of a damped oscillator.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <numbers>

namespace silt::dem {

/// A mass at a spring to the ground, or the effective mass m* of a pair and the spring between.
struct Spring {
  double mass = 0;       ///< m [kg], above 0
  double stiffness = 0;  ///< k [N/m], above 0

  void check() const {
    require_positive("Spring: mass", mass);
    require_positive("Spring: stiffness", stiffness);
  }
};

/// Δt_critical = 2 √(m/k), [SahChoi2004] (34) [s]; the paper uses 0.8 of it. It is the limit of one
/// particle connected to the ground by one spring. It is NOT safe between particles: the limit of a
/// pair is √2 √(m/k), and it is lower with more contacts. Contacts throws if Δt is unstable.
inline double sah_choi_critical_time_step(const Spring& spring) {
  spring.check();
  return 2 * std::sqrt(spring.mass / spring.stiffness);
}

/// Half a period of an undamped contact, π √(m*/k) [s]; `mass` is the effective mass m*. Throws if
/// the mass or the stiffness is not positive.
inline double contact_duration(const Spring& spring) {
  spring.check();
  return std::numbers::pi * std::sqrt(spring.mass / spring.stiffness);
}

/// A damped oscillator: its `angular_frequency` ω without damping [1/s], and `beta`, β = c/k [s],
/// of its dashpot c and spring k.
struct Oscillator {
  double angular_frequency = 0;
  double beta = 0;
};
/// Largest stable Δt of leapfrog [s] with dashpots that use the velocity of the previous half step:
/// (2/ω) (√(1 + ζ²) − ζ), ζ = β ω/2.
inline double stable_time_step(const Oscillator& o) {
  const double zeta = o.beta * o.angular_frequency / 2;
  return 2 / o.angular_frequency * (std::sqrt(1 + zeta * zeta) - zeta);
}

}  // namespace silt::dem
