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
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/contact/grain_rows.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <array>
#include <limits>

namespace silt::dem::detail {

/// The energy of a grain's motion, including rotation, with this velocity and spin [J].
template <class P, class Velocity, class Spin>
double energy_of_motion(const P& grains, Index i, const Velocity& v, const Spin& w) {
  return (double(grains[mass][i]) * in_double(v).squaredNorm() +
          double(grains[inertia][i]) * squared_norm(in_double(w))) /
         2;
}

/// Throws if the contacts gave more energy than they had: if the kinetic energy rose to more than
/// ContactSettings::max_energy_gain times what explains it. `rows` are the grains with which the law was
/// evaluated; energy_of_contacts(before, mean) returns the ContactEnergy for the grains then, and with
/// the mean of their velocities then and now.
template <class P, class EnergyOfContacts>
[[gnu::cold]] void check_energy(const P& grains,
                                const GrainRows<P::dimension, typename P::Real>& rows,
                                const ContactSettings& settings, const FinishedStep& step,
                                EnergyOfContacts&& energy_of_contacts) {
  const double most = settings.max_energy_gain;
  const auto before = [&](Index i) {
    return energy_of_motion(grains, i, rows.velocity_of(i), rows.spin_of(i));
  };
  const auto after = [&](Index i) {
    return energy_of_motion(grains, i, grains[velocity][i], grains[spin][i]);
  };
  const auto [energy_before, energy_after] =
      silt::detail::sum_of_all(grains, std::array{ordered_sum(grains.size(), 0.0, before),
                                                  ordered_sum(grains.size(), 0.0, after)});
  if (!(energy_after > most * energy_before)) return;

  P then = grains;
  P mean = grains;
  silt::detail::refresh_halo(mean);
  const auto x = then.halo_to_change(position);
  const auto v = then.halo_to_change(velocity);
  const auto w = then.halo_to_change(spin);
  const auto mean_v = mean.halo_to_change(velocity);
  const auto mean_w = mean.halo_to_change(spin);
  for_each(grains.local(), [&](Index i) {
    x[i] = rows.position_of(i);
    v[i] = rows.velocity_of(i);
    w[i] = rows.spin_of(i);
    mean_v[i] = (mean_v[i] + v[i]) / 2;
    mean_w[i] = (mean_w[i] + w[i]) / 2;
  });
  const auto own = energy_of_contacts(then, mean);
  const auto [stored, work, work_of_walls] =
      silt::detail::sum_of_all(grains, std::array{own.stored, own.work, own.work_of_walls});
  const double by_rest = energy_after - energy_before - work - work_of_walls;
  const double by_others = std::max(0.0, by_rest);
  const double by_walls = std::max(0.0, work_of_walls);
  if (!(energy_after > most * (energy_before + stored + (by_others + by_walls)))) return;

  const auto gain = [&](Index i) { return after(i) - before(i); };
  Index fastest = no_index;
  for (Index i = 0; i < grains.size(); ++i) {
    if (fastest == no_index || gain(i) > gain(fastest)) fastest = i;
  }
  const double of_fastest =
      fastest == no_index ? -std::numeric_limits<double>::infinity() : gain(fastest);
  const double of_all = silt::detail::together(grains, [&] {
                          return Largest{.energy_gain = of_fastest};
                        }).energy_gain;
  if (of_fastest < of_all) return;  // it is a grain of another process
  fail({"dem::Contacts: the kinetic energy rose from ", energy_before, " J to ", energy_after,
        " J in a step of ", step.time_step, " s, more than max_energy_gain = ", most,
        " times the sum of ", energy_before, " J, the ", stored, " J in the springs of contacts",
        (by_walls > 0 ? ", the " + to_text(by_walls) + " J by moving walls" : ""), " and the ",
        by_others, " J by other forces; of all grains, this one with velocity = ",
        to_text(typename P::Vec(grains[velocity][fastest])),
        " m/s gained most; the law gives more energy than its springs hold: check its force and "
        "its elastic energy, lower the time step, or raise ContactSettings::max_energy_gain"},
       {.particle = fastest, .id = grains.id(fastest)});
}

}  // namespace silt::dem::detail
