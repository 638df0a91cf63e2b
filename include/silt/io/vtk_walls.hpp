// SPDX-License-Identifier: MIT
// Frames of the faces of walls, for ParaView, beside those of the particles.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/vtk.hpp>

#include <cstdint>
#include <string>
#include <utility>

namespace silt {

/// One frame, as the bytes of a .vtu file: a line (2D) or a triangle for every face of walls that
/// have for_each_face(), see mps::ImageWalls::InFlow, with its group and velocity [m/s].
template <class Walls>
[[gnu::cold]] std::string vtk_frame_of_walls(const Walls& walls) {
  constexpr int dimension = Walls::dimension;
  using Vec = silt::Vec<dimension>;
  Buffer<Vec> corners, velocities;
  Buffer<std::uint32_t> groups;
  walls.for_each_face([&](const auto& face, std::uint32_t group, const Vec& of_face) {
    for (const Vec& corner : face.corners) corners.push_back(corner);
    groups.push_back(group);
    velocities.push_back(of_face);
  });
  const Index faces = groups.size();
  Buffer<std::int64_t> numbers(corners.size()), ends(faces);
  for (Index k = 0; k < numbers.size(); ++k) numbers[k] = std::int64_t(k);
  for (Index k = 0; k < faces; ++k) ends[k] = std::int64_t((k + 1) * dimension);
  const Buffer<std::uint8_t> types(faces, dimension == 2 ? 3 : 5);  // VTK_LINE, VTK_TRIANGLE
  const auto xml = [](std::string_view name, const auto& values) {
    using Value = typename std::remove_cvref_t<decltype(values)>::value_type;
    return detail::xml_of(detail::vtk_array<Value>(name, values));
  };
  return detail::vtk_file(
      corners.size(), faces, xml("position", corners),
      xml("connectivity", numbers) + xml("offsets", ends) + xml("types", types), "",
      "<CellData>\n" + xml("group", groups) + xml("velocity", velocities) + "</CellData>\n");
}

/// Observer that writes a frame of the walls of a flow at every output, as VtkSeries does of the
/// particles: where walls and bodies are after the step. Group 0 are the walls at rest, then follow
/// those that move, and the bodies.
class VtkWalls : public VtkSeries {
 public:
  using VtkSeries::VtkSeries;

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.interaction().walls();
      simulation.time();
    }
  [[gnu::cold]] void operator()(const Sim& simulation) {
    bool was_read = false;
    if constexpr (requires { simulation.was_read(); }) was_read = simulation.was_read();
    // All processes have all faces.
    if (process_of(simulation.particles()).rank > 0) return;
    this->write(double(simulation.time()), was_read, Process{},
                vtk_frame_of_walls(simulation.interaction().walls()));
  }
};

}  // namespace silt
