// SPDX-License-Identifier: MIT
// Drag of grains that a flow does not resolve. Of a law, F = β (u − v): u is the velocity of the
// fluid between the grains (interstitial), v that of the grain. The force of the pressure gradient,
// and with it the buoyancy, is not part of it: model A of [Gidaspow1994].
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <numbers>

namespace silt::coupled {

/// A grain and the fluid around it, as a drag law sees them.
struct GrainInFluid {
  double diameter;        ///< d [m]
  double fluid_fraction;  ///< ε [-]
  double speed;           ///< |u − v| of the fluid between the grains [m/s]
  double density;         ///< ρ of the fluid [kg/m³]
  double viscosity;       ///< μ = ρ ν of the fluid [Pa s]

  /// ε ρ |u − v| d/μ: with the superficial velocity ε (u − v) [-].
  double reynolds() const { return fluid_fraction * density * speed * diameter / viscosity; }
  /// 3 π μ d [kg/s].
  double of_stokes() const { return 3 * std::numbers::pi * viscosity * diameter; }
};

/// coefficient(at) returns β [kg/s]; in 2D [kg/s] per metre of depth. A law with a member
/// `dimension` holds in this one only, and one whose is_none() is true needs no viscosity.
template <class D>
concept DragLaw = requires(const D law, const GrainInFluid& at) {
  { law.coefficient(at) } -> std::convertible_to<double>;
};

/// Whether a law holds in a dimension.
template <class D, int Dim>
constexpr bool holds_in_dimension() {
  if constexpr (requires { D::dimension; }) {
    return D::dimension == Dim;
  } else {
    return true;
  }
}

/// None.
struct NoDrag {
  /// Whether β is always 0: the fluid needs no viscosity.
  static constexpr bool is_none() { return true; }
  /// β [kg/s].
  static double coefficient(const GrainInFluid&) { return 0; }
};

/// 3 π μ d [Stokes1851]: a single sphere, Re ≪ 1.
struct StokesDrag {
  static constexpr int dimension = 3;
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) { return at.of_stokes(); }
};

/// 3 π μ d (1 + 0.15 Re^0.687) [SchillerNaumann1933]: a single sphere, Re < 800; above 1000, its
/// drag coefficient is 0.44.
struct SchillerNaumann {
  static constexpr int dimension = 3;
  /// Over that of Stokes [-].
  static double correction(double reynolds) {
    constexpr double turbulent = 1000;
    if (reynolds > turbulent) return 0.44 * reynolds / 24;
    return 1 + 0.15 * std::pow(reynolds, 0.687);
  }
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) {
    const double re = at.density * at.speed * at.diameter / at.viscosity;
    return at.of_stokes() * correction(re);
  }
};

/// 3 π μ d (1 + 0.15 Re^0.687) ε^−2.65, Re of the superficial velocity [WenYu1966]: suspensions, ε
/// above 0.8.
struct WenYu {
  static constexpr int dimension = 3;
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) {
    return at.of_stokes() * SchillerNaumann::correction(at.reynolds()) *
           std::pow(at.fluid_fraction, -2.65);
  }
};

/// V/(1 − ε) [150 (1 − ε)² μ/(ε d²) + 1.75 (1 − ε) ρ |u − v|/d] [Ergun1952]: packed beds, ε below
/// 0.8. V is the volume of the sphere.
struct Ergun {
  static constexpr int dimension = 3;
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) {
    const double d = at.diameter, volume = std::numbers::pi * d * d * d / 6;
    const double viscous =
        150 * (1 - at.fluid_fraction) * at.viscosity / (at.fluid_fraction * d * d);
    return volume * (viscous + 1.75 * at.density * at.speed / d);
  }
};

/// π/8 C ρ d² ε² |u − v| ε^−χ, C = (0.63 + 4.8/√Re)², χ = 3.7 − 0.65 exp(−(1.5 − log₁₀ Re)²/2), Re
/// of the superficial velocity [DiFelice1994]: from a single sphere to a packed bed, at any Re.
struct DiFelice {
  static constexpr int dimension = 3;
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) {
    // In the limit of Re = 0 it is 0.96 of that of Stokes.
    const double re = std::max(at.reynolds(), 1e-12);
    const double exponent = 3.7 - 0.65 * std::exp(-squared(1.5 - std::log10(re)) / 2);
    // C Re = (0.63 √Re + 4.8)²
    return std::numbers::pi / 8 * at.viscosity * at.diameter * squared(0.63 * std::sqrt(re) + 4.8) *
           std::pow(at.fluid_fraction, 1 - exponent);
  }
};

/// Ergun where ε < 0.8, otherwise WenYu [Gidaspow1994].
struct GidaspowDrag {
  static constexpr int dimension = 3;
  /// β [kg/s].
  static double coefficient(const GrainInFluid& at) {
    return at.fluid_fraction < 0.8 ? Ergun::coefficient(at) : WenYu::coefficient(at);
  }
};

}  // namespace silt::coupled
