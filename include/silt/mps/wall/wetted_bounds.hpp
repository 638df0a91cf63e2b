// SPDX-License-Identifier: MIT
// Where a body in a flow is wet.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/wall/body_in_flow.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace silt::mps::detail {

/// The box around the particles that have faces of a group near them, within that of the faces; of
/// no size, and around `otherwise` [m], if there are none.
template <int Dim>
WettedBounds<Dim> wetted_bounds(const FlowOfStep<Dim>& flow, std::uint32_t group,
                                const Vec<Dim>& otherwise) {
  const FacesNearParticles<Dim>& near = flow.near;
  const auto faces = near.faces().bounds_of_group(group);
  constexpr double none = std::numeric_limits<double>::infinity();
  WettedBounds<Dim> wetted{.size = {}, .centre = otherwise, .density = flow.density};
  for (int k = 0; k < Dim; ++k) {
    const auto at = [&](Index i, double sign) {
      if (!near.has_faces(i)) return -none;
      for (const std::uint32_t face : near[i].faces()) {
        if (near[i][face].group == group) return sign * near.position(i)[k];
      }
      return -none;
    };
    const auto [highest, minus_lowest] =
        flow.maximum(std::array{largest(near.size(), -none, [&](Index i) { return at(i, 1); }),
                                largest(near.size(), -none, [&](Index i) { return at(i, -1); })});
    const double low = std::max(faces.lower[k], -minus_lowest);
    const double high = std::min(faces.upper[k], highest);
    wetted.size[k] = std::max(0.0, high - low);
    if (high > low) wetted.centre[k] = (low + high) / 2;
  }
  return wetted;
}

}  // namespace silt::mps::detail
