// SPDX-License-Identifier: MIT
// Linear theory of sloshing in a rectangular tank (R.A. Ibrahim, Liquid Sloshing Dynamics, 2005).
// Lengths in [m], times in [s].
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace support {

struct SloshingTank {
  double length = 0;
  double depth = 0;
  double gravity = 9.81;  // [m/s²]

  /// Of the mode with n half waves along the tank.
  double natural_frequency(int n) const {
    const double k = n * std::numbers::pi / length;
    return std::sqrt(gravity * k * std::tanh(k * depth));
  }
  double natural_period(int n) const { return 2 * std::numbers::pi / natural_frequency(n); }
};

/// X = A (1 − cos(w t)), w = 2π/T, for some whole periods T, then 0.
struct Sway {
  double amplitude = 0;  // A
  double period = 0;     // T
  int periods = 0;

  double frequency() const { return 2 * std::numbers::pi / period; }  // w [1/s]
  double end() const { return periods * period; }
  double displacement(double t) const {
    return t < end() ? amplitude * (1 - std::cos(frequency() * t)) : 0;
  }
  /// X'' [m/s²].
  double acceleration(double t) const {
    return t < end() ? amplitude * frequency() * frequency() * std::cos(frequency() * t) : 0;
  }
};

/// Where the centre of the water is at a time, relative to the middle of the tank: with the surface
/// Σ q_n cos(nπx/L) over odd n,
///
///   q_n'' + ω_n² q_n = ω_n² 4 L X''/(g n² π²),   x_c = −2 L/(h π²) Σ q_n/n²
inline double centre_by_theory(const SloshingTank& tank, const Sway& sway, double time) {
  const double pi2 = std::numbers::pi * std::numbers::pi, w = sway.frequency();
  const double swayed = std::min(time, sway.end()), free = time - swayed;
  double centre = 0;
  for (int n = 1; n < 12; n += 2) {
    const double omega = tank.natural_frequency(n);
    const double forcing =
        omega * omega * 4 * tank.length / (tank.gravity * n * n * pi2) * sway.amplitude * w * w;
    // (cos wt − cos ωt)/(ω² − w²) and its derivative, finite at resonance.
    const double half_sum = (omega + w) / 2 * swayed, half_difference = (omega - w) / 2 * swayed;
    const double beat = half_difference != 0 ? std::sin(half_difference) / half_difference : 1;
    const double q = forcing / (omega + w) * swayed * beat * std::sin(half_sum);
    const double rate =
        forcing / (omega + w) * (omega * swayed * beat * std::cos(half_sum) + std::sin(w * swayed));
    const double now = q * std::cos(omega * free) + rate / omega * std::sin(omega * free);
    centre -= 2 * tank.length / (tank.depth * pi2) * now / (n * n);
  }
  return centre;
}

}  // namespace support
