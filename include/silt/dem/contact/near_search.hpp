// SPDX-License-Identifier: MIT
// When and how the list of near contacts is rebuilt.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/near_contacts.hpp>
#include <silt/dem/setup/grains.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace silt::dem {

/// Whether pairs other than the near ones may touch at this time [s]: two grains, or a grain and a
/// wall, approach by at most the sum of their displacements. `walls` is a WallSet.
template <class P, class S, class Walls, class Validity>
bool is_stale(const P& grains, const S& search, const Walls& walls, double time,
              const Validity& validity) {
  if (validity.revision != grains.revision() || validity.since.size() != grains.size()) return true;
  if constexpr (Walls::move) {
    const auto moved = walls.max_displacement({.from = validity.time, .to = time}, validity.extent);
    if (!(moved <= validity.margin / 2)) return true;
  }
  if constexpr (HasTravel<S>) {
    if (search.travel().is_within(double(validity.margin / 2), validity.travel)) return false;
  }
  const auto x = grains[position];
  const auto near = squared(validity.margin / 2);
  // Written as !(… <= …) so that the list is rebuilt if a position is NaN.
  return first_where(x.size(), [&](Index i) {
           return !((x[i] - validity.since[i]).squaredNorm() <= near);
         }) != no_index;
}

/// The box around all grains.
template <class P>
auto extent_of(const P& grains) {
  using Real = typename P::Real;
  const auto x = grains[position];
  Box<P::dimension, Real> box;
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  for (int k = 0; k < P::dimension; ++k) {
    box.upper[k] = largest(x.size(), -infinity, [&](Index i) { return x[i][k]; });
    box.lower[k] = -largest(x.size(), -infinity, [&](Index i) { return -x[i][k]; });
  }
  return box;
}

/// Records the positions of a rebuild in this step and chooses the margin; `reach` [m] is the
/// interaction range of contacts.
template <class P, class S, class Walls, class Step, class Validity>
void renew_validity(const P& grains, const S& search, const Walls& walls, const Step& step,
                    typename P::Real reach, Validity& validity) {
  using Real = typename P::Real;
  // A small margin gives few near pairs, a large one few rebuilds; the search limits it.
  constexpr double lasting_steps = 20;
  const auto v = grains[velocity];
  Real fastest = std::sqrt(largest(v.size(), Real(0), [&](Index i) { return v[i].squaredNorm(); }));
  if constexpr (Walls::move) {
    if (grains.size() > 0) {
      validity.extent = extent_of(grains);
      fastest = std::max(fastest, walls.max_speed(step.time, validity.extent));
    }
  }
  const Real wanted = std::clamp<Real>(Real(2 * lasting_steps * step.time_step) * fastest,
                                       Real(0.002) * reach, Real(0.1) * reach);
  const Real seen = search.radius() + margin_of<Real>(search) - reach;
  validity.margin = std::clamp<Real>(wanted, 0, std::max<Real>(seen, 0));
  validity.reach = reach;
  validity.revision = grains.revision();
  validity.owned_revision = grains.owned_revision();
  validity.time = step.time;
  validity.extent.lower.array() -= validity.margin / 2;
  validity.extent.upper.array() += validity.margin / 2;
  const auto x = grains[position];
  validity.since.assign(x.begin(), x.end());
  if constexpr (HasTravel<S>) validity.travel = search.travel();
}

/// Finds all pairs of grains, and of grains and walls, with a gap below `margin` [m]; `walls` is a
/// WallsAtTime.
template <class P, class S, class Walls>
void find_near(const P& grains, const S& search, const Walls& walls, typename P::Real margin,
               NearContacts& near, NearContacts::Found& found) {
  using Real = typename P::Real;
  const auto x = grains.with_ghosts(position);
  const auto R = grains.with_ghosts(radius);
  near.find_all(
      grains,
      [&](Index i, auto&& add) {
        for_each_candidate(search, i, [&](Index j) {
          // Of the two images of a pair, use the one in which the lower id is not a ghost.
          if (j >= grains.size() && grains.id(j) < grains.id(i)) return;
          const Real limit = R[i] + R[j] + margin;
          if (!((x[j] - x[i]).squaredNorm() < squared(limit))) return;
          const bool in_order = grains.id(i) < grains.id(j);
          add({static_cast<std::uint32_t>(in_order ? i : j),
               static_cast<std::uint32_t>(in_order ? j : i)});
        });
      },
      [&](Index i, auto&& add) {
        walls.for_each_element_near(typename P::Vec(x[i]), Real(R[i] + margin),
                                    [&](Index place) { add(static_cast<std::uint32_t>(place)); });
      },
      found);
}

}  // namespace silt::dem
