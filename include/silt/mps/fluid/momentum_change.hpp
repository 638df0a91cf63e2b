// SPDX-License-Identifier: MIT
// What changed the momentum of a particle in a step.
#pragma once

#include <silt/core/types.hpp>

namespace silt::mps {

/// What changed the velocity of one particle.
template <int Dim>
struct MomentumChange {
  Vec<Dim> position = Vec<Dim>::Zero();         ///< of the particle [m]
  Vec<Dim> velocity_change = Vec<Dim>::Zero();  ///< by pressure, collisions and friction [m/s]
  Vec<Dim> wall_stress = Vec<Dim>::Zero();      ///< change by the viscous stress of walls [m/s]
  double pressure = 0;                          ///< [Pa]
};

}  // namespace silt::mps
