// SPDX-License-Identifier: MIT
// Particles moved a little beside the flow, so that they stay evenly spread.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// What a shift is made from, at one fluid particle.
template <int Dim, class RealType = double>
struct ShiftInput {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  Vec towards = Vec::Zero();  ///< l0/n0 Σ w r_ij/r²: to where its neighbours are crowded [-]
  bool at_edge = false;       ///< next to the free surface or a wall, see SourceTerms::at_edge
  Real speed = 0;             ///< largest |u_j − u_i| around [m/s]
  Real spacing = 0;           ///< l0 [m]
  Real time_step = 0;         ///< Δt [s]
};

/// Particles go with the flow only.
struct NoShifting {
  static constexpr bool shifts = false;

  void check() const {}
  template <int Dim, class Real>
  Vec<Dim, Real> displacement(const ShiftInput<Dim, Real>&) const {
    return Vec<Dim, Real>::Zero();
  }
};

/// δr = −A max|u_ij| Δt l0/n0 Σ w r_ij/r², at most a tenth of a spacing; after Lind et al. (2012), but
/// by relative speeds, since it is strain that draws particles into lines: fluid at rest or in
/// uniform motion is left alone. At the edges of the fluid, where one side is empty anyway,
/// particles stay: nothing is pushed out. Velocities stay as they are, and so does momentum.
struct ParticleShifting {
  static constexpr bool shifts = true;

  double strength = 4;  ///< A [-]

  void check() const { require_not_negative("ParticleShifting: strength", strength); }

  template <int Dim, class Real>
  Vec<Dim, Real> displacement(const ShiftInput<Dim, Real>& shift_input) const {
    using Vec = silt::Vec<Dim, Real>;
    if (shift_input.at_edge) return Vec::Zero();
    const Vec shift = (-Real(strength) * shift_input.speed * shift_input.time_step) * shift_input.towards;
    const Real size = shift.norm();
    const Real most = shift_input.spacing / 10;
    return size > most ? Vec((most / size) * shift) : shift;
  }
};

template <class S>
concept Shifting = requires(const S shifting, ShiftInput<2> in_2d, ShiftInput<3> in_3d) {
  { S::shifts } -> std::convertible_to<bool>;
  { shifting.displacement(in_2d) } -> std::convertible_to<Vec<2>>;
  { shifting.displacement(in_3d) } -> std::convertible_to<Vec<3>>;
  shifting.check();
};

}  // namespace silt::mps
