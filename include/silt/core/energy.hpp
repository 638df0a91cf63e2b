// SPDX-License-Identifier: MIT
// Kinetic and potential energies of particles, summed in double precision, of all processes that
// share them. Bitwise identical for any number of threads.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// Σ ½ m v² [J].
template <class P>
  requires HasFields<P, velocity_t, mass_t>
double kinetic_energy(const P& particles) {
  const auto v = particles[velocity];
  const auto m = particles[mass];
  return detail::sum_of_all(particles, ordered_sum(particles.size(), 0.0, [&](Index i) {
    return double(m[i]) * in_double(v[i]).squaredNorm() / 2;
  }));
}

/// −Σ m g·x [J] for the acceleration g [m/s²]; zero at the origin.
template <class P>
  requires HasFields<P, mass_t>
double potential_energy(const P& particles, const typename P::Vec& g) {
  const auto x = particles[position];
  const auto m = particles[mass];
  const double own = -ordered_sum(particles.size(), 0.0,
                                  [&](Index i) { return double(m[i]) * double(g.dot(x[i])); });
  return detail::sum_of_all(particles, own);
}

/// Σ ½ I ω² [J].
template <class P>
  requires HasFields<P, spin_t, inertia_t>
double rotational_energy(const P& particles) {
  const auto w = particles[spin];
  const auto inertias = particles[inertia];
  return detail::sum_of_all(particles, ordered_sum(particles.size(), 0.0, [&](Index i) {
    return double(inertias[i]) * squared_norm(in_double(w[i])) / 2;
  }));
}

}  // namespace silt
