// SPDX-License-Identifier: MIT
// The linear flow around a particle, where it has no neighbours: beyond walls, and where they are
// missing by the scatter of their positions.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/velocity_gradient.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>

namespace silt::mps {

/// The gradients of the velocity with which the flow is extrapolated, of each particle.
template <int Dim, class RealType>
class ExtrapolatedFlow {
 public:
  using Real = RealType;

  /// The velocity gradient of one particle, and where the flow is extrapolated with it.
  struct OfParticle {
    VelocityGradient<Dim, Real> gradient;
    bool is_beyond_walls = false;    ///< whether the flow is extrapolated beyond walls
    bool misses_neighbours = false;  ///< see divergence_with_images()
  };

  /// None is, of this number of particles.
  void clear(Index number) { particles_.assign(number, {}); }
  const OfParticle& operator[](Index i) const { return particles_[i]; }

  /// Of the velocities now. Beyond walls, except on the free surface, beside protruding edges, around
  /// which no linear flow goes, and between walls that are oblique to each other, where half way to an
  /// image in both is not on a wall: extrapolated there, fluid at rest would begin to circulate.
  template <FluidParticles P, class Operators>
  void find(const P& particles, const Operators& operators, const FacesNearParticles<Dim>& near) {
    const auto u = particles.with_ghosts(velocity);
    const auto on_surface = particles[surface];
    const auto n = particles[number_density];
    for_each_inlined(particles.size(), [&](Index i) {
      const bool is_beyond_walls = near.has_faces(i) && !on_surface[i] &&
                                   near[i].has_right_angles_only() &&
                                   !near[i].has_protruding_edge();
      const Real full = operators.stencil().n0;
      const bool misses_neighbours = n[i] >= least_even * full && n[i] < least_full * full;
      if (is_beyond_walls || misses_neighbours) {
        particles_[i] = {velocity_gradient(u, i, operators), is_beyond_walls, misses_neighbours};
      }
    });
    silt::detail::share(particles, particles_);
  }

 private:
  // n/n0 [-] of the second row below an even surface is 0.93. Above these, neighbours are missing by
  // the scatter of their positions only; where more are missing, in splashes, the velocities of the
  // missing ones cannot be told from those of the others, and energy would rise.
  static constexpr Real least_even = Real(0.9);
  static constexpr Real least_full = Real(0.97);

  Buffer<OfParticle> particles_;
};

}  // namespace silt::mps
