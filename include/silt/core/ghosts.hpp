// SPDX-License-Identifier: MIT
// Periodic sides as ghosts: copies behind the owned particles, so that nothing above core/ knows
// about periods. A search makes them when it is built; a step refreshes the fields it changes.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>

#include <string>

namespace silt {

/// Brings owned particles back into the periodic box and makes the ghosts that lie within `depth`
/// [m] of it. Throws if a position is not finite, or if a periodic side is shorter than 2 depth: a
/// pair could then meet twice.
template <class P>
void make_ghosts(P& particles, typename P::Real depth) {
  using Real = typename P::Real;
  using Vec = typename P::Vec;
  particles.clear_ghosts();
  const auto x_owned = particles[position];
  const Index broken = first_where(x_owned.size(), [&](Index i) { return !is_finite(x_owned[i]); });
  if (broken != no_index) {
    fail("search: a position is not finite; look at what moved the particle",
         {.particle = broken, .id = particles.id(broken)});
  }
  const auto& box = particles.box();
  if (!box.any_periodic()) return;

  const auto leaves = [&](Index i) { return x_owned[i] != box.wrap(x_owned[i]); };
  if (first_where(x_owned.size(), leaves) != no_index) particles.keep(position);
  for (auto& x : x_owned) x = box.wrap(x);
  for (int k = 0; k < P::dimension; ++k) {
    if (!box.periodic[static_cast<std::size_t>(k)]) continue;
    const Real side = box.upper[k] - box.lower[k];
    if (side < 2 * depth) {
      fail("Box: the periodic side " + to_text(double(side)) + " m along axis " +
           std::to_string(k) + " is shorter than twice the search radius " +
           to_text(double(depth)) + " m; widen the box");
    }
    Vec shift = Vec::Zero();
    shift[k] = side;
    const Index rows = particles.total();
    const auto is_low = [&](Index i) {
      return particles.with_ghosts(position)[i][k] <= box.lower[k] + depth;
    };
    const auto is_high = [&](Index i) {
      return particles.with_ghosts(position)[i][k] >= box.upper[k] - depth;
    };
    const auto ghosts = ordered_sum(
        rows, Index(0), [&](Index i) { return Index(is_low(i)) + Index(is_high(i)); });
    particles.reserve(rows + ghosts + ghosts / 8);
    for (Index i = 0; i < rows; ++i) {
      if (is_low(i)) particles.add_ghost(i, shift);
      if (is_high(i)) particles.add_ghost(i, Vec(-shift));
    }
  }
}

}  // namespace silt
