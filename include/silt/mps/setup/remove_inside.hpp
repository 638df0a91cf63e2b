// SPDX-License-Identifier: MIT
// Makes room for a body in a fluid.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/inside.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <vector>

namespace silt::mps {

/// Removes the fluid inside of closed faces, and what is closer to them than 0.45 spacings l0 [m]:
/// where faces are on the sides of cells of its lattice, the rows beside them stay. Returns the
/// number of particles removed. Throws if the spacing is not positive.
template <FluidParticles P, int Dim>
Index remove_inside(P& particles, const std::vector<Face<Dim>>& faces, double spacing) {
  require_positive("remove_inside: spacing", spacing);
  if (faces.empty()) return 0;
  auto bounds = bounds_of(faces[0]);
  for (const Face<Dim>& face : faces) bounds.enclose(bounds_of(face));
  const double nearest = 0.45 * spacing;
  const auto x = particles[position];
  const auto kinds = particles[kind];
  return particles.remove_if([&](Index i) {
    if (kinds[i] != Kind::fluid) return false;
    const Vec<Dim> point = x[i].template cast<double>();
    if (!(bounds.squared_distance(point) < squared(nearest))) return false;
    return is_inside(faces, point) || distance_from(faces, point) < nearest;
  });
}

}  // namespace silt::mps
