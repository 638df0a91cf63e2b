// SPDX-License-Identifier: MIT
// Particle shifting: small displacements in addition to the flow keep the particles evenly spread.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/any_particle_view.hpp>

#include <concepts>

namespace silt::mps {

/// Particles move with the flow only.
struct NoShifting {
  void check() const {}
};

/// δr = −A max|u_ij| Δt l0/n0 Σ w r_ij/r², at most a tenth of a spacing; after
/// [LindXuStansbyRogers2012], but with relative speeds, because strain is what aligns particles:
/// fluid at rest or in uniform motion is not shifted. Particles near a boundary of the fluid, where
/// one side is empty, are not shifted either, so that none is pushed out. Velocities and momentum
/// are unchanged. Among grains, with a scheme InMixture, the way of a particle past single grains
/// spoils the arrangement, and A is divided by ε³. With A alone, a bed that settled made energy, see
/// docs/theory_coupled.md.
struct ParticleShifting {
  double strength = 4;  ///< A [-], at most 1e6

  void check() const { require_between("ParticleShifting: strength", strength, {0, 1e6}); }

  template <class View>
  typename View::Vec displacement(const View& at) const {
    using Real = typename View::Real;
    using Vec = typename View::Vec;
    if (at.near_boundary()) return Vec::Zero();
    const Real volume = Real(at.bulk_volume());
    const Real strength_here = Real(strength) * volume * volume * volume;
    const Vec shift = (-strength_here * at.max_relative_speed() * Real(at.time_step())) *
                      at.concentration_gradient();
    const Real size = shift.norm();
    const Real max_size = at.spacing() / 10;
    return size > max_size ? Vec((max_size / size) * shift) : shift;
  }
};

/// displacement(at) returns the shift of one fluid particle [m], from its ParticleView.
template <class S>
concept Displaces = requires(const S shifting, const detail::AnyParticleView<2>& in_2d,
                             const detail::AnyParticleView<3>& in_3d) {
  { shifting.displacement(in_2d) } -> std::convertible_to<Vec<2>>;
  { shifting.displacement(in_3d) } -> std::convertible_to<Vec<3>>;
};
/// Displaces particles, or is NoShifting.
template <class S>
concept Shifting = (Displaces<S> || std::same_as<S, NoShifting>) &&
                   requires(const S shifting) { shifting.check(); };

}  // namespace silt::mps
