// SPDX-License-Identifier: MIT
// The semi-implicit step of MPS, [HwangLeePark2010] (8)–(12), (16) and Fig. 10, in its two orders.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>

namespace silt {

/// Original order: the predictor moves particles to r*, and a second search finds n*.
struct MovesParticles {
  static constexpr bool moves = true;
};

/// Improved order: the predictor changes velocities only.
struct KeepsParticles {
  static constexpr bool moves = false;
};

template <class Predictor = KeepsParticles>
class SemiImplicit {
 public:
  template <class P, class S, class F>
    requires PressureInteraction<F, P, S> && HasFields<P, velocity_t> &&
             (!requires { typename F::Predictor; } || std::same_as<typename F::Predictor, Predictor>)
  void step(P& particles, S& search, F& flow, double dt) {
    search.update(particles);
    flow.predict(particles, search, dt);  // u* = u + Δt (ν∇²u + F)
    if constexpr (Predictor::moves) {
      flow.advect(particles, dt);  // r* = r + Δt u*
      search.update(particles);
    }
    flow.collide(particles, search, dt);
    flow.project(particles, search, dt);  // n, free surface, source, ∇²P = source, u' = −Δt/ρ ∇P
    flow.correct(particles, dt);          // u = u* + u';  r = r* + Δt u', or r = r + Δt u
  }
};

}  // namespace silt
