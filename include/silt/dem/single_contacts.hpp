// SPDX-License-Identifier: MIT
// A look at single contacts, as observers and the check of stability need them: from what a step kept,
// back to the contact that the law saw.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/contact_lanes.hpp>
#include <silt/dem/grains.hpp>

namespace silt::dem {

/// Both sides of a contact: places of owned grains, or the number of a wall.
struct Sides {
  Index i = nowhere;
  Index j = nowhere;     ///< `nowhere`: a wall
  Index wall = nowhere;  ///< `nowhere`: a grain
};

/// Those of near contact c, as they were when it was found.
template <class P, class Near>
Sides sides_of(const P& grains, const Near& near, Index c) {
  if (near.is_of_walls(c / lanes)) return {.i = near.first_place(c), .wall = near.second_place(c)};
  return {.i = grains.owner(near.first_place(c)), .j = grains.owner(near.second_place(c))};
}

/// What the last step kept of contact c, see ContactLanes.
template <class P, class T>
const typename P::Real* row_of(const P&, const T& touches, Index c) {
  return &touches.seen().rows[c * ContactLanes<P::dimension, typename P::Real>::row_words];
}

/// f(c, sides) for every contact of the last step whose grains are still there.
template <class P, class T, class F>
void for_each_touch(const P& grains, const T& touches, F&& f) {
  using Lanes = ContactLanes<P::dimension, typename P::Real>;
  const auto& near = touches.near();
  if (touches.seen().rows.size() != near.size() * Lanes::row_words) return;
  for (Index c = 0; c < near.size(); ++c) {
    if (!near.is_contact(c) || !(row_of(grains, touches, c)[Lanes::overlap] > 0)) continue;
    const bool at_wall = near.is_of_walls(c / lanes);
    const Sides sides{.i = grains.index_of(near.first_id(c)),
                      .j = at_wall ? nowhere : grains.index_of(near.second_id(c)),
                      .wall = at_wall ? near.second_place(c) : nowhere};
    if (sides.i != nowhere && (at_wall || sides.j != nowhere)) f(c, sides);
  }
}

/// A contact of which only the masses and radii are filled in: they do not change from step to step.
template <class P>
auto constants_of(const P& grains, const Sides& sides) {
  using Real = typename P::Real;
  Contact<P::dimension, Real> contact;
  const Real m = grains[mass][sides.i];
  const Real R = grains[radius][sides.i];
  contact.effective_mass = m;
  contact.effective_radius = R;
  if (sides.j != nowhere) {
    const Real m_j = grains[mass][sides.j];
    const Real R_j = grains[radius][sides.j];
    contact.effective_mass = m * m_j / (m + m_j);
    contact.effective_radius = R * R_j / (R + R_j);
  }
  return contact;
}

/// Contact c of the last step; its velocity is that of the grains as they are given.
template <class P, class T>
auto contact_of(const P& grains, const T& touches, Index c, const Sides& sides) {
  using Lanes = ContactLanes<P::dimension, typename P::Real>;
  using Vec = typename P::Vec;
  const auto* const row = row_of(grains, touches, c);
  auto contact = constants_of(grains, sides);
  for (int k = 0; k < P::dimension; ++k) contact.normal[k] = row[Lanes::n + k];
  contact.overlap = row[Lanes::overlap];
  contact.time_step = touches.seen().time_step;
  const auto surface = [&](Index i, typename P::Real towards) {
    const auto arm = grains[radius][i] - row[Lanes::arm_share] * contact.overlap;
    return Vec(grains[velocity][i] + cross(grains[spin][i], Vec(towards * arm * contact.normal)));
  };
  contact.relative_velocity = surface(sides.i, -1);
  if (sides.j != nowhere) contact.relative_velocity -= surface(sides.j, 1);
  return contact;
}

}  // namespace silt::dem
