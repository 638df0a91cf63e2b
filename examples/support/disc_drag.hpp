// SPDX-License-Identifier: MIT
// Drag of discs, per metre of depth, for the examples with grains in water in 2D.
#pragma once

#include <silt/coupled/drag.hpp>

#include <cmath>

namespace support {

/// β = ½ C ρ d |u − v| ε^−1.7 with C = 1 + 10 Re^−2/3 + 1/Re, Re of the superficial velocity: that
/// of a single cylinder (F.M. White, Viscous Fluid Flow, 1974), and finite at rest. There is no
/// such law of many discs: the factor of ε is that of spheres [DiFelice1994] at small and large Re.
struct DiscDrag {
  static constexpr int dimension = 2;
  /// [kg/s] per metre of depth.
  static double coefficient(const silt::coupled::GrainInFluid& at) {
    const double re = at.reynolds();
    const double drag_times_re = re + 10 * std::cbrt(re) + 1;
    return drag_times_re * at.viscosity / 2 * std::pow(at.fluid_fraction, -2.7);
  }
};

}  // namespace support
