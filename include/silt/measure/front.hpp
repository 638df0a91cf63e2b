// SPDX-License-Identifier: MIT
// The leading edge and the residual height of a collapsing column, as the experiments define them.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>

namespace silt {

/// How the edge of the fluid is told from spray.
struct FrontRule {
  double spacing = 0;              ///< l0 [m]: particles reach half of it beyond their centres
  double band = 2;                 ///< within this many spacings of the floor, or of the back wall
  double neighbour_radius = 2.1;   ///< over the spacing; at most the search's radius
  int min_neighbours = 3;        ///< fluid particles that the edge has within that radius
};

struct Front {
  double x = 0;       ///< largest x of the fluid along the floor [m]
  double height = 0;  ///< of the fluid at the back wall [m]
};

/// Edge of the fluid in a tank whose floor and back wall lie at 0, as the search last saw
/// it; the last axis points up. is_fluid(i) says which particles count. Throws if the
/// spacing is not positive.
template <ParticleSet P, NeighbourSearch<P> S, std::predicate<Index> IsFluid>
Front find_front(const P& particles, const S& search, const FrontRule& rule, IsFluid&& is_fluid) {
  require_positive("FrontRule: spacing", rule.spacing);
  constexpr int up = P::dimension - 1;
  const double band = rule.band * rule.spacing;
  const double near = rule.neighbour_radius * rule.spacing;
  const auto x = particles[position];
  const auto is_spray = [&](Index i) {
    int neighbours = 0;
    search.for_each_neighbour(i, [&](Index j, const auto&, auto r) {
      neighbours += double(r) < near && is_fluid(particles.owner(j));
    });
    return neighbours < rule.min_neighbours;
  };
  Front front;
  for (Index i = 0; i < particles.size(); ++i) {
    if (!is_fluid(i)) continue;
    const double edge = double(x[i][0]) + rule.spacing / 2;
    const double top = double(x[i][up]) + rule.spacing / 2;
    const bool leads = double(x[i][up]) < band && edge > front.x;
    const bool rises = double(x[i][0]) < band && top > front.height;
    if ((!leads && !rises) || is_spray(i)) continue;
    if (leads) front.x = edge;
    if (rises) front.height = top;
  }
  return front;
}

}  // namespace silt
