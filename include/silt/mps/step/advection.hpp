// SPDX-License-Identifier: MIT
// The moves of the particles of a flow with their velocities.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/step_changes.hpp>


namespace silt::mps {

/// r = r + Δt u at the end of a step; or, in the original MPS, r* = r + Δt u* before the pressure
/// is found, and the rest of the move after it.
template <class Vec>
class Advection {
 public:
  using Real = typename Vec::Scalar;

  /// No particle has been moved in the step.
  void begin() noexcept { moved_with_.clear(); }

  /// r* = r + Δt u*
  template <FluidParticles P>
  void move(P& particles, Real time_step) {
    const auto u = particles[velocity];
    const auto x = particles[position];
    moved_with_.assign(u.begin(), u.end());
    for_each_of_fluid(particles, [&](Index i) { x[i] += time_step * u[i]; });
  }

  /// The velocity [m/s] of particle i in the rest of its move, where u are the present velocities:
  /// u, or u' = u − u* if it was moved with u*.
  template <class U>
  Vec rest(const U& u, Index i) const {
    return moved_with_.empty() ? Vec(u[i]) : Vec(u[i] - moved_with_[i]);
  }

  /// r = r + Δt u, or r* + Δt u'
  template <FluidParticles P>
  void move_rest(P& particles, Real time_step) const {
    const auto u = particles[velocity];
    const auto x = particles[position];
    for_each_of_fluid(particles, [&](Index i) { x[i] += time_step * rest(u, i); });
  }

 private:
  Buffer<Vec> moved_with_;  // u* of move(); empty if the particles were not moved
};

}  // namespace silt::mps
