// SPDX-License-Identifier: MIT
// Checks of where walls that move and bodies are: before the first step, and in each.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face_crossing.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/mps/wall/body_in_flow.hpp>
#include <silt/mps/wall/solid_bodies.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace silt::mps::detail {

/// Throws if faces of different groups go through each other where the first step begins, or are inside
/// of a solid body. Spacing in [m]; name_of(group) names the faces of a group.
template <int Dim, class NameOf>
[[gnu::cold]] void require_no_crossing_at_first(const Faces<Dim>& faces,
                                                const SolidBodies<Dim>& solid, double spacing,
                                                NameOf&& name_of) {
  const double tolerance = 1e-2 * spacing;
  if (const auto crossing = find_crossing(faces, tolerance)) {
    fail({"MovingWalls: ", name_of(crossing->group), " and ", name_of(crossing->other),
          " go through each other at ", to_text(crossing->x),
          " m in the beginning; move one of them, or make it smaller, so that they touch at most"});
  }
  if (const auto inside = solid.find_faces(faces, tolerance)) {
    fail({"MovingWalls: ", name_of(inside->group), ", or a part of it, is inside of ",
          name_of(inside->other), " at ", to_text(inside->x),
          " m in the beginning; move one of them, so that they do not overlap; if ",
          name_of(inside->other), " is hollow, give it mass_properties instead of a density"});
  }
}

/// Throws if faces of different groups go through each other in the step of the faces.
template <int Dim, class NameOf>
void require_no_crossing(const Faces<Dim>& faces, double spacing, NameOf&& name_of) {
  const auto crossing = find_crossing_in_step(faces, 1e-3 * spacing);
  if (!crossing) return;
  fail({"MovingWalls: ", name_of(crossing->group), " goes into ", name_of(crossing->other), " at ",
        to_text(crossing->x), " m; let faces touch at most, or change the motion"});
}

/// Throws if a body is smaller than a spacing [m], or the faces of a disc or sphere far from its
/// radius; `first` is the group of the first one.
template <int Dim>
[[gnu::cold]] void require_resolved_bodies(const std::vector<BodyInFlow<Dim>>& bodies,
                                           const Faces<Dim>& faces, std::uint32_t first,
                                           double spacing) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (bodies[b].deviation_of_faces() <= spacing / 4) continue;
    fail({"MovingWalls: body ", b, ": its faces are up to ", bodies[b].deviation_of_faces(),
          " m away from its radius = ", bodies[b].radius(),
          " m, more than a quarter of the spacing = ", spacing,
          " m; give faces with shorter edges"});
  }
  for (std::uint32_t group = first; group <= faces.groups(); ++group) {
    const auto bounds = faces.bounds_of_group(group);
    const double size = (bounds.upper - bounds.lower).maxCoeff();
    if (size >= spacing) continue;
    fail({"MovingWalls: body ", group - first, " is ", size, " m large, less than the spacing = ",
          spacing, " m, so that the fluid does not see it; make it larger, or the spacing smaller"});
  }
}

/// Throws if a body that fluid of this density [kg/m³] moves is too light for it.
template <int Dim>
void require_heavy_enough(const std::vector<BodyInFlow<Dim>>& bodies, double density) {
  // One of a hundredth floats; one of a thousandth was thrown out of the water.
  constexpr double least = 0.01;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double mass = bodies[b].mass_properties().mass;
    const double of_fluid = density * bodies[b].volume();
    constexpr double round_off = 1e-9;
    if (mass > (least - round_off) * of_fluid || bodies[b].is_held()) continue;
    fail({"MovingWalls: body ", b, " has a mass of ", mass, " kg, less than ", least,
          " of that of the fluid which it may displace, ", of_fluid,
          " kg: its motion would not be stable; give it a larger density"});
  }
}

/// Throws if a body moves by more than a spacing [m] in a step of this length [s].
template <int Dim>
void require_resolved_moves(const std::vector<BodyInFlow<Dim>>& bodies, double time_step,
                            double spacing) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const double distance = bodies[b].max_speed() * time_step;
    if (distance <= spacing) continue;
    fail({"MovingWalls: body ", b, " moves by ", distance, " m in a step of ", time_step,
          " s, more than the spacing = ", spacing,
          " m; reduce the time step, or its velocity, spin and load"});
  }
}

}  // namespace silt::mps::detail
