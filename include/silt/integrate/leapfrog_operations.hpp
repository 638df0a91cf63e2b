// SPDX-License-Identifier: MIT
// The operations of the leapfrog, each for all particles, for user-defined integrators.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/update_of_range.hpp>

#include <algorithm>
#include <cstddef>
#include <tuple>

namespace silt {

namespace detail {
// Changes every particle in place.
template <class P, class Change>
void change_motion(P& particles, const Change& change) {
  particles.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() == Role::state) particles.keep(field);
  });
  const FieldsOfMotion<P> fields(particles);
  const std::tuple changes{change};
  const UpdateOfRange<P> update(changes);
  for_each_range(particles.size(), [&](Index first, Index last) { update(fields, first, last); });
}
}  // namespace detail

/// Sets the forces and torques of particles [first, last) to zero.
template <class P>
void clear(P& particles, Index first, Index last) {
  const auto set_zero = [=](auto values) {
    using Value = typename decltype(values)::value_type;
    if constexpr (requires { values.data(); }) {
      // By number: g++ does not merge the stores of vectors.
      auto* const numbers = reinterpret_cast<typename P::Real*>(values.data() + first);
      std::fill_n(numbers, (last - first) * (sizeof(Value) / sizeof(*numbers)),
                  typename P::Real(0));
    } else {
      std::fill(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(last),
                zero_of<Value>());
    }
  };
  set_zero(particles[force]);
  if constexpr (HasFields<P, torque_t>) set_zero(particles[torque]);
}

/// Sets all forces and torques to zero.
template <class P>
void clear(P& particles) {
  for_each_chunk(particles.size(), [&](Chunk c) { clear(particles, c.first, c.last); });
}

/// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33); Δt in [s].
template <class P, class D>
void kick(P& particles, const D& damping, double time_step) {
  detail::change_motion(particles, detail::Kick{damping, time_step});
}

/// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
template <class P>
void drift(P& particles, double time_step) {
  detail::change_motion(particles, detail::Drift{time_step});
}

}  // namespace silt
