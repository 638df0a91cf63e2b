// SPDX-License-Identifier: MIT
// Checks of particles and box for walls that mirror.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace silt::mps::detail {

/// Throws if a particle is not fluid.
template <FluidParticles P>
void require_fluid_only(const P& particles) {
  const auto kinds = particles[kind];
  const Index i = first_where(particles.size(), [&](Index k) { return kinds[k] != Kind::fluid; });
  if (i == no_index) return;
  fail("ImageWalls: a particle is of a wall, but these walls are faces; remove all wall and "
       "dummy particles, or use a scheme for them, such as mps::RecommendedForWallParticles; "
       "make_tank<Scheme, Dim>() makes a tank for either",
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a particle is on a face: its image would be at the same position. `around` of each
/// particle are the faces near it, spacing in [m].
template <FluidParticles P, class Around>
void require_distance_from_faces(const P& particles, const std::vector<Around>& around,
                                 double spacing) {
  constexpr double closest = 1e-3;  // spacings
  const Index i = first_where(particles.size(), [&](Index k) {
    return around[k].distance() < closest * spacing;
  });
  if (i == no_index) return;
  fail("ImageWalls: a particle at " + to_text(around[i].x()) + " m has a distance of " +
           to_text(around[i].distance()) + " m from a wall; begin with half a spacing",
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a particle has gone through a face since the faces near it were found.
template <FluidParticles P, int Dim>
void require_no_passage(const P& particles, const FacesNearParticles<Dim>& near) {
  const auto x = particles[position];
  const NearestImage nearest(particles.box());
  const Index i = first_where(particles.size(), [&](Index k) {
    if (near[k].empty()) return false;
    const auto move = nearest(x[k] - near.position(k).template cast<typename P::Real>());
    return !(near[k].visible_share(near.position(k) + move.template cast<double>()) > 0);
  });
  if (i == no_index) return;
  fail("ImageWalls: a particle went through a wall, from " + to_text(near.position(i)) + " to " +
           to_text(x[i]) + " m; reduce the time step, or let particles collide with the walls",
       {.particle = i, .id = particles.id(i)});
}

/// Throws if a wall ends at a periodic side: fluid sees beyond it by the reach [m], where the wall has
/// no copies.
template <int Dim, class Real>
void require_walls_beyond_sides(const Faces<Dim>& faces, const Box<Dim, Real>& box, double reach) {
  for (const auto& element : faces.elements()) {
    for (int k = 0; k < Dim; ++k) {
      if (!element.is_rim[std::size_t(k)]) continue;
      for (int axis = 0; axis < Dim; ++axis) {
        if (!box.periodic[std::size_t(axis)]) continue;
        const double x = element.face.corners[std::size_t(k)][axis];
        const double lower = double(box.lower[axis]), upper = double(box.upper[axis]);
        const double beyond = std::max(lower - x, x - upper);
        if (beyond < -1e-9 * (upper - lower) || beyond >= reach) continue;
        fail("ImageWalls: a wall ends at " + to_text(element.face.corners[std::size_t(k)]) +
             " m, at a periodic side of the box; let it extend beyond by at least " +
             to_text(reach) + " m");
      }
    }
  }
}

}  // namespace silt::mps::detail
