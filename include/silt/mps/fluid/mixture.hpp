// SPDX-License-Identifier: MIT
// The fluid of a mixture with a second phase, such as grains, which is not resolved: what a flow
// has to know of it, of each particle.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>

namespace silt::mps {

inline constexpr struct fluid_fraction_t : scalar_field {
} fluid_fraction{};  ///< ε: share of the volume around the particle that is fluid, in (0, 1] [-]
inline constexpr struct fluid_fraction_rate_t : scalar_field {
} fluid_fraction_rate{};  ///< Dε/Dt of the particle, in the next step [1/s]
inline constexpr struct momentum_exchange_t : vector_field {
} momentum_exchange{};  ///< acceleration by the second phase, in the next step [m/s²]
inline constexpr struct pressure_gradient_t : vector_field {
} pressure_gradient{};  ///< ∇P that changed the velocity in the last step [Pa/m]
inline constexpr struct response_t : scalar_field {
} response{};  ///< R: the second phase accelerates by −R ε/((1 − ε) ρ) of a change of ∇P [-]

/// Fluid for a flow with a scheme InMixture. Whoever adds particles gives them a fluid_fraction.
template <int Dim, class Real = double, Field... Further>
using FluidInMixture = Fluid<Dim, Real, fluid_fraction_t, fluid_fraction_rate_t,
                             momentum_exchange_t, pressure_gradient_t, response_t, Further...>;

/// P has the fields of mps::FluidInMixture.
template <class P>
concept ParticlesInMixture =
    FluidParticles<P> && HasFields<P, fluid_fraction_t, fluid_fraction_rate_t, momentum_exchange_t,
                                   pressure_gradient_t, response_t>;

}  // namespace silt::mps
