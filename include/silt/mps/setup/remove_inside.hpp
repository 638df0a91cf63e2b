// SPDX-License-Identifier: MIT
// Makes room for a body in a fluid.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/enclosure.hpp>
#include <silt/geometry/face.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace silt::mps {

/// Removes the fluid inside of closed faces, and what is closer to them than 0.45 spacings l0 [m]:
/// where faces are on the sides of cells of its lattice, the rows beside them stay. Returns the
/// number of particles removed. Throws if the spacing is not positive, or if a face is invalid, see
/// require_size().
template <FluidParticles P, int Dim>
Index remove_inside(P& particles, const std::vector<Face<Dim>>& faces, double spacing) {
  require_positive("remove_inside: spacing", spacing);
  if (faces.empty()) return 0;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    require_size("remove_inside: face " + std::to_string(k), faces[k]);
  }
  const Enclosure<Dim> body(faces);
  const double nearest = 0.45 * spacing;
  const auto x = particles[position];
  const auto kinds = particles[kind];
  return particles.remove_if([&](Index i) {
    if (kinds[i] != Kind::fluid) return false;
    const Vec<Dim> point = x[i].template cast<double>();
    if (!(body.bounds().squared_distance(point) < squared(nearest))) return false;
    return body.contains(point) || body.has_face_within(nearest, point);
  });
}

}  // namespace silt::mps
