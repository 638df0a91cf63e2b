// SPDX-License-Identifier: MIT
// Initial arrangements of grains used by many tests, and quantities measured in them.
#pragma once

#include "support/points.hpp"

#include <silt/dem.hpp>
#include <silt/measure/energy.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace silt::test {

inline constexpr dem::Grain pebble{.radius = 0.01, .density = 2500};

/// For overlaps and speeds that a program should not have, see dem::ContactSettings.
inline constexpr dem::ContactSettings without_limits{
    .max_overlap = std::numeric_limits<double>::infinity(),
    .max_displacement = std::numeric_limits<double>::infinity()};

/// One pebble at x with velocity v.
template <int Dim>
dem::Grains<Dim> one_grain(const Vec<Dim>& x, const Vec<Dim>& v, const dem::Grain& grain = pebble) {
  dem::Grains<Dim> grains;
  dem::add_grain(grains, x, grain);
  grains[velocity][0] = v;
  return grains;
}

/// Two equal pebbles along the first axis, `gap` apart; the first is at rest, the second has
/// velocity v.
template <int Dim>
dem::Grains<Dim> two_grains(double gap, const Vec<Dim>& v, const dem::Grain& grain = pebble) {
  dem::Grains<Dim> grains;
  dem::add_grain(grains, Vec<Dim>(Vec<Dim>::Zero()), grain);
  dem::add_grain(grains, Vec<Dim>((2 * grain.radius + gap) * Vec<Dim>::Unit(0)), grain);
  grains[velocity][1] = v;
  return grains;
}

/// A randomly disturbed lattice of grains with small overlaps, random velocities and spins.
template <int Dim, class Real>
dem::Grains<Dim, Real> crowd(Index along_each_axis, unsigned seed) {
  const Real spacing = Real(0.0205);
  const auto box = cube<Dim, Real>(0, Real(along_each_axis) * spacing);
  auto points = lattice(box, spacing);
  const auto jitter = random_points(points.size(), cube<Dim, Real>(Real(-5e-4), Real(5e-4)), seed);
  for (Index i = 0; i < points.size(); ++i) points[i] += jitter[i];
  auto grains = dem::make_grains(points, pebble);
  const auto v = random_points(points.size(), cube<Dim, Real>(-1, 1), seed + 1);
  for (Index i = 0; i < points.size(); ++i) {
    grains[velocity][i] = v[i];
    if constexpr (Dim == 2) {
      grains[spin][i] = 50 * v[i][0];
    } else {
      grains[spin][i] = 50 * v[i].reverse();
    }
  }
  return grains;
}

/// Translational and rotational kinetic energy [J].
template <class P>
double energy_of_motion(const P& grains) {
  return kinetic_energy(grains) + rotational_energy(grains);
}

/// Steps of dt until a contact has begun and ended; returns its maximum overlap, 0 if none began.
template <class Sim>
double through_contact(Sim& sim, double dt, int max_steps = 100000) {
  double max_overlap = 0;
  for (int k = 0; k < max_steps; ++k) {
    sim.step(dt);
    sim.interaction().for_each_contact(
        sim.particles(), [&](Index, Index, const auto& contact, const auto&) {
          max_overlap = std::max(max_overlap, double(contact.overlap));
        });
    if (max_overlap > 0 && sim.interaction().size() == 0) return max_overlap;
  }
  return 0;
}

}  // namespace silt::test
