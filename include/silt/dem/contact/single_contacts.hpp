// SPDX-License-Identifier: MIT
// Single contacts of a step, computed again for observers and the stability check.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>
#include <silt/dem/contact/step_time.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

namespace silt::dem {

/// Both bodies of a contact, i and j: indices of owned grains, or of an element of a wall.
struct ContactBodies {
  Index i = no_index;
  Index j = no_index;     ///< `no_index`: a wall
  Index wall = no_index;  ///< index of the wall's element, see WallSet; `no_index`: a grain
};

/// A contact of a step with the result of its law.
template <int Dim, class Real, class Answer>
struct EvaluatedContact {
  ContactBodies bodies;  ///< indices in the given grains
  Id first;              ///< ids of the two; the second may be wall_id()
  Id second;             ///< id of the other body
  Contact<Dim, Real> contact;       ///< input of the law
  Real arm_reduction;               ///< R minus the lever arm [m]
  Answer answer;                    ///< a force, ForceComponents or LoadComponents
  Vec<Dim, Real> wall_velocity;     ///< at the contact point at time N; 0 between grains [m/s]
  AngularVec<Dim, Real> wall_spin;  ///< at time N; 0 between grains [1/s]
  ElasticEnergies elastic{};        ///< zero for a law without elastic_energies()
};

namespace detail {

/// The bodies of contact c when the list was built.
inline ContactBodies bodies_of(const ContactList& list, Index c) {
  if (list.is_of_wall(c)) return {.i = list.first(c), .wall = list.second(c)};
  return {.i = list.first(c), .j = list.second(c)};
}

/// Contact point from the row of a contact [m].
template <class P, class Row>
typename P::Vec contact_point(const P& grains, const typename P::Real* row,
                              const ContactBodies& bodies) {
  const auto arm = grains.with_halo(radius)[bodies.i] - row[Row::arm_reduction];
  typename P::Vec point = grains.with_halo(position)[bodies.i];
  for (int k = 0; k < P::dimension; ++k) point[k] -= arm * row[Row::n + k];
  return point;
}

/// A contact of the last step from its row, with the velocities of the given grains and walls (a
/// WallsAtTime).
template <class Row, class P, class Walls>
auto contact_of(const P& grains, const typename P::Real* row, const ContactBodies& bodies,
                const Walls& walls, const StepTime& step) {
  using Vec = typename P::Vec;
  Contact<P::dimension, typename P::Real> contact;
  contact.effective_mass = row[Row::mass];
  contact.effective_radius = row[Row::radius];
  for (int k = 0; k < P::dimension; ++k) contact.normal[k] = row[Row::n + k];
  contact.overlap = row[Row::overlap];
  const auto times = step.of_contacts<typename P::Real>();
  contact.time_step = times.time_step;
  contact.first_time_step = times.first_time_step;
  const auto w = grains.with_halo(spin);
  const auto surface = [&](Index i, typename P::Real towards) {
    const auto arm = towards * (grains.with_halo(radius)[i] - row[Row::arm_reduction]);
    // This order of operations reproduces the law's input bitwise.
    return Vec(grains.with_halo(velocity)[i] + arm * cross(w[i], contact.normal));
  };
  contact.relative_velocity = surface(bodies.i, -1);
  contact.relative_spin = w[bodies.i];
  if (bodies.j != no_index) {
    contact.relative_velocity -= surface(bodies.j, 1);
    contact.relative_spin -= w[bodies.j];
  } else if constexpr (Walls::move) {
    const auto velocity = walls.velocity(bodies.wall);
    contact.relative_velocity -= velocity.at(contact_point<P, Row>(grains, row, bodies));
    contact.relative_spin -= velocity.spin;
  }
  return contact;
}

}  // namespace detail
}  // namespace silt::dem
