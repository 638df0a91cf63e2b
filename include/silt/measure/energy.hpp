// SPDX-License-Identifier: MIT
// Energies and momenta of particles. Call these functions with a snapshot(), because positions and
// velocities must belong to the same time. Bitwise identical for any number of threads. Of particles
// that processes share, all call them, and get the sum of all.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// Σ m v [kg m/s].
template <class P>
  requires HasFields<P, velocity_t, mass_t>
Vec<P::dimension> momentum(const P& particles) {
  using Sum = Vec<P::dimension>;
  const auto v = particles[velocity];
  const auto m = particles[mass];
  const Sum own = ordered_sum(particles.size(), Sum(Sum::Zero()), [&](Index i) {
    return Sum(double(m[i]) * v[i].template cast<double>());
  });
  return detail::sum_of_all(particles, own);
}

/// Σ (x − about) × m v + I ω, orbital and spin, about a point [m] [kg m²/s]. Contacts conserve it
/// to round-off, also with velocities at half steps, except across periodic sides.
template <class P>
  requires HasFields<P, velocity_t, mass_t, spin_t, inertia_t>
AngularVec<P::dimension> angular_momentum(const P& particles, const typename P::Vec& about) {
  using Sum = AngularVec<P::dimension>;
  using Wide = Vec<P::dimension>;
  const auto x = particles[position];
  const auto v = particles[velocity];
  const auto m = particles[mass];
  const auto w = particles[spin];
  const auto inertias = particles[inertia];
  const Sum own = ordered_sum(particles.size(), zero_of<Sum>(), [&](Index i) {
    const Wide arm = (x[i] - about).template cast<double>();
    const Wide p = double(m[i]) * v[i].template cast<double>();
    return Sum(cross(arm, p) + double(inertias[i]) * in_double(w[i]));
  });
  return detail::sum_of_all(particles, own);
}

}  // namespace silt
