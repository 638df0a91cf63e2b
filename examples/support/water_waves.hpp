// SPDX-License-Identifier: MIT
// Linear theory of water waves, and the waves in a record of levels. Lengths in [m], times in [s].
#pragma once

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

namespace support {

/// A progressive wave of small amplitude (J. Lighthill, Waves in Fluids, 1978).
struct LinearWave {
  double period = 0;
  double depth = 0;
  double gravity = 9.81;  // [m/s²]

  double frequency() const { return 2 * std::numbers::pi / period; }  // ω [1/s]
  /// k [1/m] of ω² = g k tanh(k h), by Newton's method.
  double wave_number() const {
    const double deep = frequency() * frequency() * depth / gravity;
    double kh = std::max(deep, std::sqrt(deep));
    for (int step = 0; step < 50; ++step) {
      const double tanh = std::tanh(kh);
      kh -= (kh * tanh - deep) / (tanh + kh * (1 - tanh * tanh));
    }
    return kh / depth;
  }
  double length() const { return 2 * std::numbers::pi / wave_number(); }
  /// Of energy, and of the front of a train of waves [m/s].
  double group_speed() const {
    const double kh = wave_number() * depth;
    return frequency() / wave_number() * (0.5 + kh / std::sinh(2 * kh));
  }
  /// Height of the waves that a piston makes, over its stroke [Biesel1951].
  double height_by_piston() const {
    const double kh = wave_number() * depth;
    return 2 * (std::cosh(2 * kh) - 1) / (std::sinh(2 * kh) + 2 * kh);
  }
  /// The same of a flap that is hinged at the floor, over its stroke at the surface.
  double height_by_flap() const {
    const double kh = wave_number() * depth;
    return 4 * std::sinh(kh) / kh * (kh * std::sinh(kh) - std::cosh(kh) + 1) /
           (std::sinh(2 * kh) + 2 * kh);
  }
};

/// That of a wave maker [m]: S/2 sin(ω t), growing in the first two periods.
struct WaveMakerShift {
  double stroke = 0;  ///< S [m]
  double period = 0;  ///< [s]

  double operator()(double t) const {
    const double s = std::clamp(t / (2 * period), 0.0, 1.0);
    return stroke / 2 * s * s * (3 - 2 * s) * std::sin(2 * std::numbers::pi / period * t);
  }
};

/// Places of gauges [m] at distances that tell waves of a length in both directions apart, from
/// `first` on.
inline std::vector<double> gauges_from(double first, double wave_length) {
  std::vector<double> x;
  for (const double share : {0.0, 0.1, 0.25, 0.45}) x.push_back(first + share * wave_length);
  return x;
}

/// From one time to another.
struct Window {
  double begin = 0;
  double end = 0;
};

/// A of y ≈ mean + Re(A exp(i ω t)) + Re(A₂ exp(2 i ω t)), by least squares in a window.
inline std::complex<double> amplitude_of(const std::vector<double>& t, const std::vector<double>& y,
                                         double frequency, const Window& window) {
  using Row = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> matrix = Eigen::Matrix<double, 5, 5>::Zero();
  Row right = Row::Zero();
  for (std::size_t k = 1; k < t.size(); ++k) {
    if (t[k] < window.begin || t[k] > window.end) continue;
    const double phase = frequency * t[k];
    const Row row{1, std::cos(phase), std::sin(phase), std::cos(2 * phase), std::sin(2 * phase)};
    const double weight = t[k] - t[k - 1];
    matrix += weight * row * row.transpose();
    right += weight * y[k] * row;
  }
  const Row solution = matrix.fullPivLu().solve(right);
  return {solution[1], -solution[2]};
}

/// Amplitudes of a wave along x and of one against it.
struct Waves {
  double incident = std::numeric_limits<double>::quiet_NaN();
  double reflected = std::numeric_limits<double>::quiet_NaN();
};

/// Those whose sum is closest to complex amplitudes at the places x: the method of
/// [MansardFunke1980], for a regular wave.
inline Waves separate(const std::vector<double>& x,
                      const std::vector<std::complex<double>>& amplitudes, double wave_number) {
  std::complex<double> twice = 0, along = 0, against = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    const auto turn = std::polar(1.0, wave_number * x[k]);
    twice += turn * turn;
    along += turn * amplitudes[k];
    against += std::conj(turn) * amplitudes[k];
  }
  const double n = double(x.size());
  const double determinant = n * n - std::norm(twice);
  return {.incident = std::abs(n * along - twice * against) / determinant,
          .reflected = std::abs(n * against - std::conj(twice) * along) / determinant};
}

}  // namespace support
