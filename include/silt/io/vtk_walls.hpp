// SPDX-License-Identifier: MIT
// Frames of the faces of walls, for ParaView, beside those of the particles.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_cells.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace silt {

/// One frame, as the bytes of a .vtu file: a line (2D) or a triangle for every face of walls that
/// have for_each_face(), see mps::ImageWalls::InFlow, with its group, its velocity [m/s], and
/// force [N] and torque [N m] of the fluid on the whole group, in 2D per metre of depth: `loads` of
/// groups 1, 2, … have them, and otherwise they are 0.
template <class Walls, class Loads>
[[gnu::cold]] std::string vtk_frame_of_walls(const Walls& walls, const Loads& loads) {
  constexpr int dimension = Walls::dimension;
  using Vec = silt::Vec<dimension>;
  Buffer<Vec> corners, velocities, forces;
  Buffer<AngularVec<dimension>> torques;
  Buffer<std::uint32_t> groups;
  walls.for_each_face([&](const auto& face, std::uint32_t group, const Vec& of_face) {
    for (const Vec& corner : face.corners) corners.push_back(corner);
    groups.push_back(group);
    velocities.push_back(of_face);
    const bool has_load = group > 0 && group <= loads.size();
    forces.push_back(has_load ? loads[group - 1].force : Vec(Vec::Zero()));
    torques.push_back(has_load ? loads[group - 1].torque : zero_of<AngularVec<dimension>>());
  });
  return detail::vtk_frame_of_cells<dimension>(
      corners, dimension,
      detail::vtk_xml("group", groups) + detail::vtk_xml("velocity", velocities) +
          detail::vtk_xml("force", forces) + detail::vtk_xml("torque", torques));
}

/// Observer that writes a frame of the walls of a flow at every output, as VtkSeries does of the
/// particles: where walls and bodies are after the step, and their load in it. Group 0 are the
/// walls at rest, whose load is not computed, then follow those that move, and the bodies.
class VtkWalls : public VtkSeries {
 public:
  using VtkSeries::VtkSeries;

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.interaction().walls();
      simulation.interaction().loads_on_moving_walls(simulation.particles(),
                                                     simulation.last_time_step());
      simulation.time();
    }
  [[gnu::cold]] void operator()(const Sim& simulation) {
    bool was_read = false;
    if constexpr (requires { simulation.was_read(); }) was_read = simulation.was_read();
    const auto& flow = simulation.interaction();
    const auto loads =
        flow.loads_on_moving_walls(simulation.particles(), simulation.last_time_step());
    // All processes have all faces.
    if (process_of(simulation.particles()).rank > 0) return;
    this->write(double(simulation.time()), was_read, Process{},
                vtk_frame_of_walls(flow.walls(), loads));
  }
};

}  // namespace silt
