// SPDX-License-Identifier: MIT
// The energy of a step of contacts. The work of all forces is the change of the kinetic energy, by
// identity; what distinguishes a law that is wrong is that its contacts give more than they had. A
// step is refused if the kinetic energy E after it exceeds
//
//   max_energy_gain · (E before + energy in the springs + work of moving walls, if above 0,
//                      + work of all other forces, including adhesion, if above 0),
//
// where the work of all other forces is the change of E minus that of the springs and dashpots.
//
// This never refuses springs that are right, in a step within their stability limit, whatever
// else acts: linear springs at that limit change the velocities by Δv with Σ ½ m Δv² ≤ 4 times
// their energy, and they then give less than 9/10 of any E that exceeds ten times E before and that
// energy.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <utility>

namespace silt::dem::detail {

/// The energy of a grain's motion, including rotation, with this velocity and spin [J].
template <class P, class Velocity, class Spin>
double energy_of_motion(const P& grains, Index i, const Velocity& v, const Spin& w) {
  return (double(grains[mass][i]) * in_double(v).squaredNorm() +
          double(grains[inertia][i]) * squared_norm(in_double(w))) /
         2;
}

/// Throws if the contacts gave more energy than they had, see ContactSettings::max_energy_gain.
/// `rows` are the grains with which the law was evaluated; energy_of_contacts(before, mean) returns
/// the ContactEnergy for the grains then, and with the mean of their velocities then and now.
template <class P, class EnergyOfContacts>
void check_energy(const P& grains, const GrainRows<P::dimension, typename P::Real>& rows,
                  const ContactSettings& settings, const FinishedStep& step,
                  EnergyOfContacts&& energy_of_contacts) {
  const double most = settings.max_energy_gain;
  if (step.max_energy_gain <= most) return;
  const auto before = [&](Index i) {
    return energy_of_motion(grains, i, rows.velocity_of(i), rows.spin_of(i));
  };
  const auto after = [&](Index i) {
    return energy_of_motion(grains, i, grains[velocity][i], grains[spin][i]);
  };
  const double energy_before = ordered_sum(grains.size(), 0.0, before);
  const double energy_after = ordered_sum(grains.size(), 0.0, after);
  if (!(energy_after > most * energy_before)) return;

  P then = grains;
  P mean = grains;
  const auto x = then[position];
  const auto v = then[velocity];
  const auto w = then[spin];
  const auto mean_v = mean[velocity];
  const auto mean_w = mean[spin];
  for_each(grains.size(), [&](Index i) {
    x[i] = rows.position_of(i);
    v[i] = rows.velocity_of(i);
    w[i] = rows.spin_of(i);
    mean_v[i] = (mean_v[i] + v[i]) / 2;
    mean_w[i] = (mean_w[i] + w[i]) / 2;
  });
  const auto contacts = energy_of_contacts(then, mean);
  const double by_rest = energy_after - energy_before - contacts.work - contacts.work_of_walls;
  const double by_others = std::max(0.0, by_rest);
  const double by_walls = std::max(0.0, contacts.work_of_walls);
  if (!(energy_after > most * (energy_before + contacts.stored + (by_others + by_walls)))) return;

  Index fastest = 0;
  for (Index i = 1; i < grains.size(); ++i) {
    if (after(i) - before(i) > after(fastest) - before(fastest)) fastest = i;
  }
  fail("dem::Contacts: the kinetic energy rose from " + to_text(energy_before) + " J to " +
           to_text(energy_after) + " J in a step of " + to_text(step.time_step) +
           " s, more than max_energy_gain = " + to_text(most) + " times the sum of " +
           to_text(energy_before) + " J, the " + to_text(contacts.stored) +
           " J in the springs of contacts" +
           (by_walls > 0 ? ", the " + to_text(by_walls) + " J by moving walls" : "") + " and the " +
           to_text(by_others) + " J by other forces; of all grains, this one with velocity = " +
           to_text(typename P::Vec(grains[velocity][fastest])) +
           " m/s gained most; the law gives more energy than its springs hold: check its force and "
           "its elastic energy, lower the time step, or raise ContactSettings::max_energy_gain",
       {.particle = fastest, .id = grains.id(fastest)});
}

}  // namespace silt::dem::detail
