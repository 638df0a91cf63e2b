// SPDX-License-Identifier: MIT
// Access to single contacts of a step: their sum for a grain, and the reconstruction of a law's
// input for observers and the stability check.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/four.hpp>
#include <silt/dem/contact/near_contacts.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/setup/grains.hpp>

#include <utility>

namespace silt::dem {

/// Both sides of a contact: indices of owned grains, or of an element of a wall.
struct Sides {
  Index i = no_index;
  Index j = no_index;     ///< `no_index`: a wall
  Index wall = no_index;  ///< index of the wall's element, see WallSet; `no_index`: a grain
};

/// A contact of a step with the result of its law.
template <int Dim, class Real, class Answer>
struct EvaluatedContact {
  Sides sides;  ///< indices in the given grains
  Id first;     ///< ids of the two; the second may be wall_id()
  Id second;
  Contact<Dim, Real> contact;       ///< input of the law
  Real shorter;                     ///< R minus the lever arm [m]
  Answer answer;                    ///< a force, ForceComponents or LoadComponents
  Vec<Dim, Real> wall_velocity;     ///< at the contact point at time N; 0 between grains [m/s]
  AngularVec<Dim, Real> wall_spin;  ///< at time N; 0 between grains [1/s]
  ElasticEnergies elastic{};        ///< zero for a law without elastic_energies()
};

/// Sides of near contact c, with the indices at the last rebuild.
template <class P>
Sides sides_of(const P& grains, const NearContacts& near, Index c) {
  if (near.is_of_wall(c)) return {.i = near.first(c), .wall = near.second(c)};
  return {.i = grains.owner(near.first(c)), .j = grains.owner(near.second(c))};
}

/// f(c, sides, row) for every contact of the last step whose grains still exist; row is a
/// ContactRow. Contacts are visited in the order of the grains in memory, those of a grain in the
/// order of the partners' ids, so that sums do not depend on when the near contacts were found.
template <class P, class T, class F>
void for_each_touch(const P& grains, const T& touches, F&& f) {
  const auto& near = touches.near();
  if (touches.seen().at.size() != near.size()) return;
  near.for_each_contact_by_grain([&](Index c) {
    if (!touches.seen().touches(c)) return;
    const auto* const row = touches.seen().row_of(c);
    const bool at_wall = near.is_of_wall(c);
    const Sides sides{.i = grains.index_of(near.first_id(c)),
                      .j = at_wall ? no_index : grains.index_of(near.second_id(c)),
                      .wall = at_wall ? near.second(c) : no_index};
    if (sides.i != no_index && (at_wall || sides.j != no_index)) f(c, sides, row);
  });
}

/// A contact with only mass and radius set, which do not change from step to step.
template <class P>
auto constants_of(const P& grains, const Sides& sides) {
  using Real = typename P::Real;
  Contact<P::dimension, Real> contact;
  const Real m = grains[mass][sides.i];
  const Real R = grains[radius][sides.i];
  contact.effective_mass = m;
  contact.effective_radius = R;
  if (sides.j != no_index) {
    const Real m_j = grains[mass][sides.j];
    const Real R_j = grains[radius][sides.j];
    contact.effective_mass = m * m_j / (m + m_j);
    contact.effective_radius = R * R_j / (R + R_j);
  }
  return contact;
}

/// Contact point from the row of a contact [m].
template <class P, class Row>
typename P::Vec contact_point(const P& grains, const typename P::Real* row, const Sides& sides) {
  const auto arm = grains[radius][sides.i] - row[Row::shorter];
  typename P::Vec point = grains[position][sides.i];
  for (int k = 0; k < P::dimension; ++k) point[k] -= arm * row[Row::n + k];
  return point;
}

/// A contact of the last step from its row, with the velocities of the given grains and walls (a
/// WallsAtTime).
template <class P, class Seen, class Walls>
auto contact_of(const P& grains, const Seen& seen, const typename P::Real* row, const Sides& sides,
                const Walls& walls) {
  using Row = typename Seen::Row;
  using Vec = typename P::Vec;
  auto contact = constants_of(grains, sides);
  for (int k = 0; k < P::dimension; ++k) contact.normal[k] = row[Row::n + k];
  contact.overlap = row[Row::overlap];
  contact.time_step = seen.time_step;
  const auto surface = [&](Index i, typename P::Real towards) {
    const auto arm = towards * (grains[radius][i] - row[Row::shorter]);
    // This order of operations reproduces the law's input bitwise.
    return Vec(grains[velocity][i] + arm * cross(grains[spin][i], contact.normal));
  };
  contact.relative_velocity = surface(sides.i, -1);
  contact.relative_spin = grains[spin][sides.i];
  if (sides.j != no_index) {
    contact.relative_velocity -= surface(sides.j, 1);
    contact.relative_spin -= grains[spin][sides.j];
  } else if constexpr (Walls::move) {
    const auto velocity = walls.velocity(sides.wall);
    contact.relative_velocity -= velocity.at(contact_point<P, Row>(grains, row, sides));
    contact.relative_spin -= velocity.spin;
  }
  return contact;
}

/// Adds Σ F and Σ M (14) of the last evaluation to grains [first, last), in the order of the
/// partners' ids.
template <class P, class T>
void add_rows(P& grains, const T& touches, Index first, Index last) {
  using Real = typename P::Real;
  using Row = typename T::Row;
  const auto& seen = touches.seen();
  const auto forces = grains[force];
  const auto torques = grains[torque];
  const auto radii = std::as_const(grains)[radius];
  constexpr int first_angular = 3 - angular_size<P::dimension>;  // in 2D a torque is about z
  // Rows are fetched in a loop of its own, which does not depend on the number of contacts of each
  // grain: processors cannot predict it.
  for (const auto part : touches.near().of(first, last)) {
    __builtin_prefetch(seen.row_of(part.contact()));
  }
  for (Index i = first; i < last; ++i) {
    const Real R = radii[i];
    Four<Real> sum{};
    Four<Real> turning{};
    [[maybe_unused]] Four<Real> couples{};
    for (const auto part : touches.near().of(i)) {
      const Real* const row = seen.row_of(part.contact());
      Four<Real> n, F, F_x_n;
      load_four(row + Row::n, n);
      load_four(row + Row::F, F);
      sum += part.template sign<Real>() * F;
      cross_turned(n, F, F_x_n);
      turning += (R - row[Row::shorter]) * F_x_n;
      if constexpr (T::couples) {
        Four<Real> couple;
        load_four(row + Row::couple, couple);
        couples += part.template sign<Real>() * couple;
      }
    }
    turn_back(turning);
    for (int k = 0; k < P::dimension; ++k) forces[i][k] += sum[k];
    for (int k = 0; k < angular_size<P::dimension>; ++k) {
      Real M = turning[first_angular + k];
      if constexpr (T::couples) M += couples[k];
      component(torques[i], k) += M;
    }
  }
}

}  // namespace silt::dem
