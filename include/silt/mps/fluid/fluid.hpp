// SPDX-License-Identifier: MIT
// The particles of MPS: fluid, walls with a pressure, and dummies behind the walls.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <cstdint>

namespace silt::mps {

/// What a particle of a flow is.
enum class Kind : std::uint8_t {
  fluid,  ///< moves
  wall,   ///< fixed; its pressure is an unknown of the pressure equation
  dummy,  ///< fixed, behind a wall; enters number density, divergence and viscosity only
};
/// Whether the value is one of the enumeration's, and not another number, as from a damaged file.
constexpr bool is_enumerator(Kind value) { return value <= Kind::dummy; }

inline constexpr struct pressure_t : scalar_field {
} pressure{};  ///< P [Pa]
inline constexpr struct kind_t : field_of<Kind>, constant_field {
} kind{};  ///< what the particle is, see Kind
inline constexpr struct number_density_t : scalar_field, derived_field {
} number_density{};  ///< n_i of the last step, (5) [-]
inline constexpr struct surface_t : field_of<std::uint8_t>, derived_field {
} surface{};  ///< 1 on the free surface in the last step, where P = 0, (13) (17)

/// Fluid, wall and dummy particles, optionally with further fields.
template <int Dim, class Real = double, Field... Further>
using Fluid =
    Particles<Dim, Real, velocity_t, pressure_t, kind_t, number_density_t, surface_t, Further...>;

/// P has the fields of mps::Fluid.
template <class P>
concept FluidParticles = HasFields<P, velocity_t, pressure_t, kind_t, number_density_t, surface_t>;

/// Adds a particle at rest at x [m]; returns its index.
template <FluidParticles P>
Index add_particle(P& particles, const typename P::Vec& x, Kind of_kind) {
  const Index i = particles.add(x);
  particles[kind][i] = of_kind;
  return i;
}

/// Number of particles of one kind.
template <FluidParticles P>
Index count(const P& particles, Kind of_kind) {
  Index number = 0;
  for (const Kind each : particles[kind]) number += each == of_kind;
  return number;
}

}  // namespace silt::mps
