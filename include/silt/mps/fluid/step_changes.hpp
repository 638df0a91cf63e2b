// SPDX-License-Identifier: MIT
// What the stages of a step change, particle by particle. The changes of a stage are all found
// before any of them is applied, and are kept for the energy balance.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/run_inlined.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <type_traits>

namespace silt::mps {

/// Change of the velocity of each particle by each stage of a step [m/s] (`friction` and
/// `collision` of pairs, `pressure`), and its shift [m]; empty for a stage without effect.
template <class Vec>
struct StepChanges {
  Buffer<Vec> predictor;    ///< gravity, force and viscosity
  Buffer<Vec> wall_stress;  ///< the part of it that is by the viscous stress of walls of faces
  Buffer<Vec> friction;
  Buffer<Vec> collision;
  Buffer<Vec> pressure;
  Buffer<Vec> shift;

  void clear() {
    for (auto* changes : {&predictor, &wall_stress, &friction, &collision, &pressure, &shift}) {
      changes->clear();
    }
  }
};

/// f(i) for every fluid particle.
template <FluidParticles P, class F>
void for_each_of_fluid(const P& particles, F&& f) {
  for_each(particles.size(), [&f, kinds = particles[kind]](Index i) {
    if (kinds[i] == Kind::fluid) f(i);
  });
}

/// changes[i] = change_of(i) for every fluid particle.
template <FluidParticles P, class Vec, class F>
void find_changes(const P& particles, Buffer<Vec>& changes, F&& change_of) {
  // An expression of Eigen could refer to temporary objects.
  static_assert(std::is_same_v<std::invoke_result_t<F, Index>, Vec>);
  changes.resize(particles.size());
  for_each_inlined(particles.size(), [&, kinds = particles[kind]](Index i) {
    if (kinds[i] == Kind::fluid) changes[i] = change_of(i);
  });
}

/// Adds the changes to the velocity, or position, of every fluid particle.
template <class Vec, FluidParticles P, Field F>
void apply_changes(const Buffer<Vec>& changes, P& particles, F field) {
  const auto values = particles[field];
  for_each_of_fluid(particles, [&](Index i) { values[i] += changes[i]; });
}

}  // namespace silt::mps
