// SPDX-License-Identifier: MIT
// How far grains and walls may move in a step of contacts: so far that none passes through another
// without a contact, and that the motion of walls is resolved.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/dem/contact/contact_settings.hpp>

namespace silt::dem::detail {

/// Steps per period of a vibrating wall: at least, and by default.
inline constexpr double least_steps_per_period = 10;
inline constexpr double steps_per_period = 20;

/// Throws if a grain moved farther than settings.max_displacement times its radius.
/// smallest_radius [m] is that of all grains.
template <class P>
void check_displacements(const P& grains, double smallest_radius, const ContactSettings& settings,
                         const FinishedStep& step) {
  const auto R = grains[radius];
  const Index i =
      find_too_far_moved(grains, step, settings.max_displacement * smallest_radius,
                         [&](Index k) { return settings.max_displacement * double(R[k]); });
  if (i == no_index) return;
  const auto v = grains[velocity][i];
  fail({"dem::Contacts: velocity = ", to_text(typename P::Vec(v)),
        " m/s moved a grain with the radius ", R[i], " m by ", double(v.norm()) * step.time_step,
        " m in a step, more than max_displacement = ", settings.max_displacement,
        " of the radius; lower the time step, use a stiffer material, or raise "
        "ContactSettings::max_displacement"},
       {.particle = i, .id = grains.id(i)});
}

/// Throws if a wall of a WallSet moved farther, in the box of the grains, than
/// settings.max_displacement times the smallest radius [m], or if the step is too long for its
/// vibration.
template <int Dim, class Real, class Walls>
void check_motion_of_walls(const Walls& walls, const Box<Dim, Real>& extent, double smallest_radius,
                           const ContactSettings& settings, const FinishedStep& step) {
  const double period = walls.shortest_period();
  if (step.time_step * least_steps_per_period > period) {
    fail({"dem::Contacts: time_step = ", step.time_step, " s is longer than 1/",
          least_steps_per_period, " of the period ", period, " s of a vibrating wall; lower it"});
  }
  const double most = settings.max_displacement * smallest_radius;
  if (!is_finite(most)) return;
  const auto moved =
      double(walls.max_displacement({.from = step.time, .to = step.time + step.time_step}, extent));
  if (moved <= most) return;
  fail({"dem::Contacts: a wall moved ", moved, " m in a step, more than max_displacement = ",
        settings.max_displacement, " of the smallest radius ", smallest_radius,
        " m; lower the time step, or raise ContactSettings::max_displacement"});
}

}  // namespace silt::dem::detail
