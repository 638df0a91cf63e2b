// SPDX-License-Identifier: MIT
// Water between walls of faces, as it is, for probes.
#pragma once

#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>

#include <utility>
#include <vector>

namespace silt::test {

/// The spacing of probed water [m].
inline constexpr double probed_l0 = 0.02;

/// A simulation of water between these faces.
template <int Dim>
auto with_walls(mps::Fluid<Dim> water, const std::vector<Face<Dim>>& faces) {
  mps::FlowSettings<Dim, mps::Recommended> settings{.spacing = probed_l0, .speed_scale = 1};
  settings.walls.template faces<Dim>() = faces;
  settings.walls.let_fluid_fall = true;
  return Simulation{std::move(water), UniformGrid<Dim>{},
                    mps::Flow<mps::Recommended, Dim>{settings}, SemiImplicit<>{}};
}
/// Faces from point to point, given in spacings.
inline std::vector<Face<2>> line(std::vector<Vec<2>> points) {
  for (auto& x : points) x *= probed_l0;
  return polyline(points);
}

}  // namespace silt::test
