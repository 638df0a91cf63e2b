// SPDX-License-Identifier: MIT
// The pressures of images in walls, in the pressure equation and in the gradient.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/view/particle_view.hpp>
#include <silt/mps/wall/walls.hpp>

#include <algorithm>

namespace silt::mps {

/// The pressure of an image above that of its particle [Pa], in one step. ∂P/∂n = (ρ/Δt) u*·n at
/// walls stops the flow towards them. Where it is not continued, P rises as at rest: particles on
/// the free surface are held, but neither stopped before they arrive nor, by walls that lean over
/// them, drawn: P is not negative a quarter of the way to the image, where a particle half a
/// spacing from the wall sees those of others up to 1.5 spacings from it. Valid as long as the
/// StepView. The free surface must have been found, velocities and pressures of ghosts must be up
/// to date.
template <class Scheme, FluidParticles P>
class PressureRise {
 public:
  using Real = typename P::Real;

  /// For the images of this step.
  explicit PressureRise(const StepView<Scheme, P>& step)
      : step_(step), time_step_over_density_(Real(step.time_step) / Real(step.settings.density)) {}

  Real operator()(const auto& image) const {
    if (!counts_flow_to_walls<Scheme> && image.continues_flow()) {
      return image.rise_along(u_) / time_step_over_density_;
    }
    const Index j = step_.particles.owner(image.index);
    const Real at_rest = rise_at_rest(image, step_.at(j).weight(), Real(step_.settings.density));
    return on_surface_[j] ? std::max(-4 * p_[image.index], at_rest) : at_rest;
  }

 private:
  const StepView<Scheme, P>& step_;
  typename ParticleView<Scheme, P>::Velocities u_ = step_.particles.with_ghosts(velocity);
  decltype(step_.particles.with_ghosts(pressure)) p_ = step_.particles.with_ghosts(pressure);
  decltype(step_.particles.with_halo(surface)) on_surface_ = step_.particles.with_halo(surface);
  Real time_step_over_density_;
};

}  // namespace silt::mps
