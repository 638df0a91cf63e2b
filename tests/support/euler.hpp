// SPDX-License-Identifier: MIT
// A user-defined integrator that has nothing but step(): it tells neither how far particles moved
// nor how much energy they gained.
#pragma once

#include <silt/integrate/damping.hpp>
#include <silt/integrate/leapfrog_operations.hpp>

namespace silt::test {

/// First order: velocities first, then positions with the new ones.
struct Euler {
  template <class P, class S, class I>
  void step(P& particles, S& search, I& interaction, double time_step) {
    search.update(particles);
    clear(particles);
    interaction.accelerate(particles, search, time_step);
    kick(particles, NoDamping{}, time_step);
    drift(particles, time_step);
  }
};

}  // namespace silt::test
