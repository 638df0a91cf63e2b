// SPDX-License-Identifier: MIT
// Periodic boundaries by ghosts: copies stored after the owned particles, so that only core/
// handles periodicity. A search makes the ghosts in its update; a step refreshes the fields that it
// changes.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/search/extent.hpp>

#include <string>

namespace silt {

/// Particles nearer to a periodic side than the sum of both have a ghost.
template <class Real>
struct GhostDepth {
  Real radius = 0;  ///< search radius [m]
  Real skin = 0;    ///< [m]; 0 without a neighbour list
};

/// Throws if a periodic side is shorter than twice radius plus skin, because a pair could then be
/// found twice.
template <int Dim, class Real>
void check_periodic_sides(const Box<Dim, Real>& box, const GhostDepth<Real>& depth) {
  for (int k = 0; k < Dim; ++k) {
    if (!box.periodic[static_cast<std::size_t>(k)]) continue;
    const Real side = box.upper[k] - box.lower[k];
    if (!(side < 2 * (depth.radius + depth.skin))) continue;
    const std::string reach = to_text(double(depth.radius)) + " m";
    const std::string margin = to_text(double(depth.skin)) + " m";
    fail({"Box: the periodic side ", double(side), " m along axis ", k,
          " is shorter than twice the search radius ",
          (depth.skin > 0 ? "plus skin, 2 (" + reach + " + " + margin +
                                "); enlarge the box, or set a smaller skin"
                          : reach + "; enlarge the box")});
  }
}

/// The number of ghosts beyond the sides across one axis, relative to that of particles and ghosts
/// [-]: of particles, owned and of the halo, within `depth` [m] of these sides; 0 if they are not
/// periodic.
template <class P>
double share_near_sides(const P& particles, int axis, typename P::Real depth) {
  const auto& box = particles.box();
  const auto x = particles.with_halo(position);
  if (!box.periodic[static_cast<std::size_t>(axis)] || x.empty()) return 0;
  const auto near = ordered_sum(x.size(), Index(0), [&](Index i) {
    return Index(x[i][axis] <= box.lower[axis] + depth) +
           Index(x[i][axis] >= box.upper[axis] - depth);
  });
  return double(near) / double(x.size());
}

/// Wraps owned particles into the periodic box, makes the ghosts of these and of the halo within
/// `depth` [m] of it, and returns the extent of all. Throws if a position is not finite, and as
/// check_periodic_sides does with the radius `depth`.
template <class P>
Extent<P::dimension, typename P::Real> make_ghosts(P& particles, typename P::Real depth) {
  using Vec = typename P::Vec;
  particles.clear_ghosts();
  const auto x = particles.with_halo(position);
  const auto extent = extent_of_points(x);
  if (!extent.is_finite()) {
    const auto is_broken = [&](Index i) { return !is_finite(x[i]); };
    const Index broken = first_where(x.size(), is_broken);
    fail({"search: position = ", to_text(typename P::Vec(x[broken])),
          " m is not finite; check the velocity of the particle"},
         {.particle = broken, .id = particles.id(broken)});
  }
  const auto& box = particles.box();
  if (!box.any_periodic()) return extent;

  const auto leaves = [&](Index i) { return x[i] != box.wrap(x[i]); };
  if (first_where(particles.size(), leaves) != no_index) {
    particles.keep(position);
    for (auto& each : particles[position]) each = box.wrap(each);
  }
  check_periodic_sides(box, {.radius = depth});
  for (int k = 0; k < P::dimension; ++k) {
    if (!box.periodic[static_cast<std::size_t>(k)]) continue;
    Vec shift = Vec::Zero();
    shift[k] = box.upper[k] - box.lower[k];
    const Index rows = particles.total();
    const auto is_low = [&](Index i) {
      return particles.with_ghosts(position)[i][k] <= box.lower[k] + depth;
    };
    const auto is_high = [&](Index i) {
      return particles.with_ghosts(position)[i][k] >= box.upper[k] - depth;
    };
    const auto ghosts = ordered_sum(
        rows, Index(0), [&](Index i) { return Index(is_low(i)) + Index(is_high(i)); });
    if (rows + ghosts > particles.capacity()) {
      double expected = double(rows + ghosts);
      for (int next = k + 1; next < P::dimension; ++next) {
        expected *= 1 + share_near_sides(particles, next, depth);
      }
      particles.reserve(static_cast<Index>(expected * (1 + 1.0 / 16)));
    }
    for (Index i = 0; i < rows; ++i) {
      if (is_low(i)) particles.add_ghost(i, shift);
      if (is_high(i)) particles.add_ghost(i, Vec(-shift));
    }
  }
  return extent_of_points(particles.with_ghosts(position));
}

}  // namespace silt
