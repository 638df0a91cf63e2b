// SPDX-License-Identifier: MIT
// Particle shifting: small displacements in addition to the flow keep the particles evenly spread.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// Input of a shifting model, for one fluid particle i.
template <int Dim, class RealType = double>
struct ShiftInput {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// l0/n0 Σ w r_ij/r² [-], in the direction of increasing particle concentration.
  Vec concentration_gradient = Vec::Zero();
  bool near_boundary = false;   ///< of the fluid, see SourceTerms::near_boundary
  Real max_relative_speed = 0;  ///< max |u_j − u_i| over the neighbours [m/s]
  Real spacing = 0;             ///< l0 [m]
  Real time_step = 0;           ///< Δt [s]
};

/// Particles move with the flow only.
struct NoShifting {
  static constexpr bool shifts = false;

  void check() const {}
  template <int Dim, class Real>
  Vec<Dim, Real> displacement(const ShiftInput<Dim, Real>&) const {
    return Vec<Dim, Real>::Zero();
  }
};

/// δr = −A max|u_ij| Δt l0/n0 Σ w r_ij/r², at most a tenth of a spacing; after Lind et al. (2012),
/// but with relative speeds, because strain is what aligns particles: fluid at rest or in uniform
/// motion is not shifted. Particles near a boundary of the fluid, where one side is empty, are not
/// shifted either, so that none is pushed out. Velocities and momentum are unchanged.
struct ParticleShifting {
  static constexpr bool shifts = true;

  double strength = 4;  ///< A [-], at most 1e6

  void check() const { require_between("ParticleShifting: strength", strength, {0, 1e6}); }

  template <int Dim, class Real>
  Vec<Dim, Real> displacement(const ShiftInput<Dim, Real>& input) const {
    using Vec = silt::Vec<Dim, Real>;
    if (input.near_boundary) return Vec::Zero();
    const Vec shift = (-Real(strength) * input.max_relative_speed * input.time_step) *
                      input.concentration_gradient;
    const Real size = shift.norm();
    const Real max_size = input.spacing / 10;
    return size > max_size ? Vec((max_size / size) * shift) : shift;
  }
};

/// displacement(input) returns the shift of one fluid particle [m].
template <class S>
concept Shifting = requires(const S shifting, ShiftInput<2> in_2d, ShiftInput<3> in_3d) {
  { S::shifts } -> std::convertible_to<bool>;
  { shifting.displacement(in_2d) } -> std::convertible_to<Vec<2>>;
  { shifting.displacement(in_3d) } -> std::convertible_to<Vec<3>>;
  shifting.check();
};

}  // namespace silt::mps
