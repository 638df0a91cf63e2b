// SPDX-License-Identifier: MIT
// The semi-implicit time step of MPS, [HwangLeePark2010] (8)–(12), (16) and Fig. 10, in its two
// variants.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>

namespace silt {

/// Original variant: the predictor moves the particles to r*, and a second search gives n*.
struct MovesParticles {
  /// Whether the predictor moves the particles.
  template <class Flow>
  static constexpr bool moves = true;
};

/// Improved variant: the predictor changes velocities only; one search per step.
struct KeepsParticles {
  /// Whether the predictor moves the particles.
  template <class Flow>
  static constexpr bool moves = false;
};

/// The variant that the source term of the flow requires.
struct OrderRequiredBySource {
  /// Whether the predictor moves the particles.
  template <class Flow>
  static constexpr bool moves = [] {
    if constexpr (requires { Flow::needs_moved_particles; }) return Flow::needs_moved_particles;
    return false;
  }();
};

/// Advances an incompressible flow, [HwangLeePark2010] (8)–(12), (16) and Fig. 10. Predictor is
/// MovesParticles, KeepsParticles or OrderRequiredBySource.
template <class Predictor = OrderRequiredBySource>
class SemiImplicit {
 public:
  template <class P, class S, class F>
    requires PressureInteraction<F, P, S> && HasFields<P, velocity_t>
  void step(P& particles, S& search, F& flow, double dt) {
    constexpr bool moves = Predictor::template moves<F>;
    static_assert(moves || !OrderRequiredBySource::template moves<F>,
                  "silt::SemiImplicit: this flow's pressure source needs the number density of "
                  "moved particles; use SemiImplicit<MovesParticles>");
    search.update(particles);
    flow.predict(particles, search, dt);  // u* = u + Δt (ν∇²u + F)
    if constexpr (moves) {
      flow.advect(particles, dt);  // r* = r + Δt u*
      detail::refresh_halo(particles);
      search.update(particles);
    }
    flow.collide(particles, search, dt);
    flow.project(particles, search, dt);  // n, free surface, source, ∇²P = source, u' = −Δt/ρ ∇P
    flow.correct(particles, dt);          // u = u* + u';  r = r + Δt u, or r* + Δt u'
  }
};

}  // namespace silt
