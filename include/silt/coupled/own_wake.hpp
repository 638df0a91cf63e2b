// SPDX-License-Identifier: MIT
// The velocity of the fluid around a grain that is by the grain itself. Drag laws take the
// undisturbed velocity; a grain that drags the fluid with it would be slowed down too little, by a
// quarter at d = l0/2.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>
#include <numbers>

namespace silt::coupled {

/// An impulse J on a grain leaves −J in the fluid, spread with the weights W, of a standard
/// deviation σ along each axis, and read with them. Of it, the pressure leaves (Dim − 1)/Dim, which
/// then spreads by viscosity, is left behind by a grain that moves through the fluid with w, and is
/// slowed down by other grains at a rate λ, as in a porous medium:
///
///   du_s/dt = −K F − u_s/τ,   K = (Dim − 1)/Dim / (ρ (4 π σ²)^(Dim/2))
///   1/τ = ν/(2 σ²) + 0.56 w/σ + λ
///
/// τ is such that u_s of a constant force is right where one of the three is much faster than the
/// others: in Stokes flow, that of a Gaussian force, F/(6 π μ σ √π) in 3D.
template <int Dim>
struct OwnWake {
  double density;    ///< ρ [kg/m³]
  double viscosity;  ///< ν [m²/s]
  double width;      ///< σ [m]

  /// K [1/kg].
  double mobility() const {
    const double area = 4 * std::numbers::pi * squared(width);
    return (Dim - 1.0) / Dim / (density * (Dim == 2 ? area : area * std::sqrt(area)));
  }
  /// 1/τ of a speed w [m/s] and a rate λ [1/s].
  double decay(double speed, double of_others) const {
    return viscosity / (2 * squared(width)) + 0.56 * speed / width + of_others;
  }
  /// u_s after a time [s] in which the grain had an impulse [N s] by drag, added mass and lift.
  template <class V>
  V after(const V& wake, const V& impulse, double speed, double of_others, double time) const {
    // exp(−t/τ), and its mean over the step, to t³: the last bit of std::exp is that of a C
    // library.
    const double t = decay(speed, of_others) * time;
    const double left = 1 / (1 + t * (1 + t / 2 * (1 + t / 3)));
    const double mean = left * (1 + t / 2 * (1 + t / 3));
    using Real = typename V::Scalar;
    return Real(left) * wake - Real(mobility() * mean) * impulse;
  }
};

}  // namespace silt::coupled
