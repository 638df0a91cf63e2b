// SPDX-License-Identifier: MIT
// When the contacts that are near are to be found anew, and how.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/near_contacts.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt::dem {

/// Whether something else than the near contacts might touch: two grains come closer by at most the
/// sum of what they moved.
template <class P, class S, class Validity>
bool is_stale(const P& grains, const S& search, const Validity& validity) {
  if (validity.revision != grains.revision() || validity.since.size() != grains.size()) return true;
  if constexpr (KnowsTravel<S>) {
    if (search.travel().is_within(double(validity.margin / 2), validity.travel)) return false;
  }
  const auto x = grains[position];
  const auto near = squared(validity.margin / 2);
  // Not "beyond": a NaN is not near.
  return first_where(x.size(), [&](Index i) {
           return !((x[i] - validity.since[i]).squaredNorm() <= near);
         }) != nowhere;
}

/// Notes that all is found at these positions; `reach` [m] is how far contacts reach.
template <class P, class S, class Validity>
void renew_validity(const P& grains, const S& search, typename P::Real reach, double dt,
                    Validity& validity) {
  using Real = typename P::Real;
  // Near enough to be few, far enough to last for some steps; no farther than the search sees.
  constexpr double lasting_steps = 20;
  const auto v = grains[velocity];
  const Real fastest =
      std::sqrt(largest(v.size(), Real(0), [&](Index i) { return v[i].squaredNorm(); }));
  const Real wanted = std::clamp<Real>(Real(2 * lasting_steps * dt) * fastest,
                                       Real(0.002) * reach, Real(0.1) * reach);
  const Real seen = search.radius() + margin_of<Real>(search) - reach;
  validity.margin = std::clamp<Real>(wanted, 0, std::max<Real>(seen, 0));
  validity.revision = grains.revision();
  const auto x = grains[position];
  validity.since.assign(x.begin(), x.end());
  if constexpr (KnowsTravel<S>) validity.travel = search.travel();
}

/// Pairs and grains at walls whose gap is below `margin` [m].
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
          // Of the two images of a pair, that in which the lower id is no ghost.
          if (j >= grains.size() && grains.id(j) < grains.id(i)) return;
          const Real limit = R[i] + R[j] + margin;
          if (!((x[j] - x[i]).squaredNorm() < squared(limit))) return;
          const bool in_order = grains.id(i) < grains.id(j);
          add({static_cast<std::uint32_t>(in_order ? i : j),
               static_cast<std::uint32_t>(in_order ? j : i)});
        });
      },
      [&](Index i, auto&& add) {
        walls.for_each([&](const auto& wall, Index w) {
          if (wall.nearest(x[i]).distance < R[i] + margin) add(static_cast<std::uint32_t>(w));
        });
      },
      found);
}

}  // namespace silt::dem
