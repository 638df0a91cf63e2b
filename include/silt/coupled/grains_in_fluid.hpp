// SPDX-License-Identifier: MIT
// Grains in a fluid that does not resolve them: what a grain knows of the fluid around it.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/mps/fluid/mixture.hpp>

namespace silt::coupled {

// Set before a step of the flow, and constant in the steps of the grains within it; but the impulse
// is summed in them.
inline constexpr struct fluid_velocity_t : vector_field, constant_field {
} fluid_velocity{};  ///< undisturbed u of the fluid around a grain [m/s]
inline constexpr struct fluid_acceleration_t : vector_field, constant_field {
} fluid_acceleration{};  ///< of that fluid by gravity, body force and pressure [m/s²]
inline constexpr struct fluid_vorticity_t : spin_field, constant_field {
} fluid_vorticity{};  ///< ∇ × u of that fluid [1/s]; set if there is a lift
inline constexpr struct own_wake_t : vector_field, constant_field {
} own_wake{};  ///< what the grain adds to u, see OwnWake [m/s]
inline constexpr struct fluid_share_t : scalar_field, constant_field {
} fluid_share{};  ///< ε of the fluid around a grain [-]
inline constexpr struct immersion_t : scalar_field, constant_field {
} immersion{};  ///< share χ of the grain that is in the fluid [-]
inline constexpr struct pressure_force_t : vector_field, constant_field {
} pressure_force{};  ///< −χ V ∇P [N]
inline constexpr struct fluid_mobility_t : scalar_field, constant_field {
} fluid_mobility{};  ///< change of u by an impulse on the grain [1/kg]
inline constexpr struct exchanged_impulse_t : vector_field {
} exchanged_impulse{};  ///< of drag, added mass and lift, since the last step of the flow [N s]

/// Grains for FluidForces.
template <int Dim, class Real = double, Field... Further>
using GrainsInFluid =
    dem::Grains<Dim, Real, fluid_velocity_t, fluid_acceleration_t, fluid_vorticity_t, own_wake_t,
                fluid_share_t, immersion_t, pressure_force_t, fluid_mobility_t, exchanged_impulse_t,
                Further...>;

/// P has the fields of GrainsInFluid.
template <class P>
concept ParticlesInFluid =
    HasFields<P, radius_t, mass_t, velocity_t, force_t, fluid_velocity_t, fluid_acceleration_t,
              fluid_vorticity_t, own_wake_t, fluid_share_t, immersion_t, pressure_force_t,
              fluid_mobility_t, exchanged_impulse_t>;

}  // namespace silt::coupled
