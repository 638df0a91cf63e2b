// SPDX-License-Identifier: MIT
// Leading edge and residual height of a collapsing column, as defined in the experiments.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <vector>

namespace silt {

/// Parameters that distinguish the edge of the fluid from spray.
struct FrontRule {
  double spacing = 0;              ///< l0 [m]: particles extend by half of it
  double band = 2;                 ///< height above the floor, or distance to the wall, over l0 [-]
  double neighbour_radius = 2.1;   ///< over l0 [-]; at most the search radius
  /// In that radius: a particle is at the edge, and not spray, if it or one of its neighbours has so
  /// many neighbours.
  int min_neighbours = 3;
};

/// What find_front() returns.
struct Front {
  double x = 0;       ///< largest x of the fluid along the floor [m]
  double height = 0;  ///< of the fluid at the back wall [m]
};

/// Edge of the fluid in a tank whose floor and back wall are at 0, with the neighbours of the last
/// update of the search; the last axis points up. is_fluid(i) selects the particles. Of particles that
/// processes share, all call it, and get the edge of all. Throws if a number is out of range.
template <ParticleSet P, NeighbourSearch<P> S, std::predicate<Index> IsFluid>
Front find_front(const P& particles, const S& search, const FrontRule& rule, IsFluid&& is_fluid) {
  require_positive("FrontRule: spacing", rule.spacing);
  require_not_negative("FrontRule: band", rule.band);
  require_not_negative("FrontRule: neighbour_radius", rule.neighbour_radius);
  if (rule.neighbour_radius * rule.spacing > double(search.radius()) * (1 + 1e-6)) {
    fail({"FrontRule: neighbour_radius = ", rule.neighbour_radius, " times the spacing ",
          rule.spacing, " m exceeds the search radius ", search.radius(), " m; decrease it"});
  }
  constexpr int up = P::dimension - 1;
  const double band = rule.band * rule.spacing;
  const double near = rule.neighbour_radius * rule.spacing;
  const auto x = particles[position];
  const auto is_within = [&](Index i, double distance) {
    return double(x[i][up]) < distance || double(x[i][0]) < distance;
  };
  // Also of the halo.
  std::vector<std::uint8_t> is_counted(particles.local()), has_enough(particles.local());
  const auto for_each_near = [&](Index i, auto&& f) {
    search.for_each_neighbour(i, [&](Index j, const auto&, auto r) {
      if (double(r) < near && is_counted[particles.owner(j)]) f(particles.owner(j));
    });
  };
  detail::together(particles, [&] {
    for (Index i = 0; i < particles.size(); ++i) is_counted[i] = is_fluid(i);
    detail::share(particles, is_counted);
    for (Index i = 0; i < particles.size(); ++i) {
      if (!is_counted[i] || !is_within(i, band + near)) continue;
      int neighbours = 0;
      for_each_near(i, [&](Index) { ++neighbours; });
      has_enough[i] = neighbours >= rule.min_neighbours;
    }
    detail::share(particles, has_enough);
    return Largest{};
  });
  // The tip of a film of one row has a neighbour or two, and is no spray.
  const auto is_spray = [&](Index i) {
    bool is_linked = has_enough[i];
    for_each_near(i, [&](Index j) { is_linked = is_linked || has_enough[j]; });
    return !is_linked;
  };
  Front front;
  for (Index i = 0; i < particles.size(); ++i) {
    if (!is_counted[i] || !is_within(i, band)) continue;
    const double edge = double(x[i][0]) + rule.spacing / 2;
    const double top = double(x[i][up]) + rule.spacing / 2;
    const bool leads = double(x[i][up]) < band && edge > front.x;
    const bool rises = double(x[i][0]) < band && top > front.height;
    if ((!leads && !rises) || is_spray(i)) continue;
    if (leads) front.x = edge;
    if (rises) front.height = top;
  }
  const auto [of_x, of_height] =
      detail::largest_of_all(particles, std::array{front.x, front.height});
  return {.x = of_x, .height = of_height};
}

}  // namespace silt
