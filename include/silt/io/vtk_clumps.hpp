// SPDX-License-Identifier: MIT
// Frames of the surfaces of clumps, for ParaView, beside those of the grains.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_cells.hpp>

#include <string>

namespace silt {

/// One frame, as the bytes of a .vtu file: the faces of clumps that have for_each_face(grains, f),
/// see dem::Clumps, with the name of each clump, its orientation, a unit quaternion (in 2D an angle
/// [rad]), its velocity [m/s] and its spin [1/s].
template <class P, class Clumps>
[[gnu::cold]] std::string vtk_frame_of_clumps(const P& grains, const Clumps& clumps) {
  constexpr int dimension = P::dimension;
  using Vec = silt::Vec<dimension>;
  Buffer<Vec> corners, velocities;
  Buffer<AngularVec<dimension>> spins;
  Buffer<Id> names;
  Buffer<double> angles;
  Buffer<silt::Vec<4>> quaternions;
  for_each_face(clumps, grains, [&](const auto& face, Index k, const auto& state) {
    for (const Vec& corner : face.corners) corners.push_back(corner);
    names.push_back(clumps.name(k));
    velocities.push_back(state.velocity);
    spins.push_back(state.spin);
    if constexpr (dimension == 2) {
      angles.push_back(state.orientation.angle);
    } else {
      quaternions.push_back(state.orientation.quaternion);
    }
  });
  const std::string orientation = dimension == 2 ? detail::vtk_xml("orientation", angles)
                                                 : detail::vtk_xml("orientation", quaternions);
  return detail::vtk_frame_of_cells<dimension>(corners, dimension,
                                               detail::vtk_xml("clump", names) + orientation +
                                                   detail::vtk_xml("velocity", velocities) +
                                                   detail::vtk_xml("spin", spins));
}

/// Observer that writes a frame of the surfaces of all clumps at every output, as VtkSeries does of
/// the grains, where they are after the step; velocities are at half steps.
class VtkClumps : public VtkSeries {
 public:
  using VtkSeries::VtkSeries;

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.integrator().clumps();
      simulation.particles();
      simulation.time();
    }
  [[gnu::cold]] void operator()(const Sim& simulation) {
    this->write(double(simulation.time()), simulation.was_read(), Process{},
                vtk_frame_of_clumps(simulation.particles(), simulation.integrator().clumps()));
  }
};

}  // namespace silt
