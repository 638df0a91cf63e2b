// SPDX-License-Identifier: MIT
// Frames of the contacts of grains, for ParaView, beside those of the grains: force chains.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/vtk.hpp>
#include <silt/io/vtk_cells.hpp>

#include <cstdint>
#include <string>
#include <type_traits>

namespace silt {

/// One frame, as the bytes of a .vtu file: for each contact of the last step a line between the
/// centres of the two grains, or from that of a grain to the contact point at a wall, with the
/// force on the first grain [N], its part along the normal [N], negative if attractive, and the
/// overlap [m]. A line across a periodic side goes beyond it.
template <class P, class I>
[[gnu::cold]] std::string vtk_frame_of_contacts(const P& grains, const I& interaction) {
  constexpr int dimension = P::dimension;
  using Vec = silt::Vec<dimension>;
  Buffer<Vec> ends, forces;
  Buffer<double> normal_forces, overlaps;
  Buffer<std::uint8_t> at_wall;
  const auto add_contact = [&](Index i, Index j, const auto& contact, const auto& force_on_i) {
    const Vec x = in_double(grains[position][i]);
    const Vec n = in_double(contact.normal);
    const Vec f = in_double(force_on_i);
    double length = double(grains[radius][i]) - double(contact.overlap);
    if (j != no_index) length += double(grains.with_halo(radius)[j]);
    ends.push_back(x);
    ends.push_back(Vec(x - length * n));
    forces.push_back(f);
    normal_forces.push_back(f.dot(n));
    overlaps.push_back(double(contact.overlap));
    at_wall.push_back(j == no_index ? 1 : 0);
  };
  const auto add_part = [&](const auto& part) {
    if constexpr (requires { part.for_each_contact(grains, add_contact); }) {
      part.for_each_contact(grains, add_contact);
    }
  };
  if constexpr (requires { interaction.for_each_part(add_part); }) {
    interaction.for_each_part(add_part);
  } else {
    add_part(interaction);
  }
  return detail::vtk_frame_of_cells<dimension>(
      ends, 2,
      detail::vtk_xml("force", forces) + detail::vtk_xml("normal_force", normal_forces) +
          detail::vtk_xml("overlap", overlaps) + detail::vtk_xml("at_wall", at_wall));
}

/// Observer that writes a frame of the contacts of the last step at every output, as VtkSeries does
/// of the grains. Of the grains of one process.
class VtkContacts : public VtkSeries {
 public:
  using VtkSeries::VtkSeries;

  /// Throws silt::Error if a file cannot be written.
  template <class Sim>
    requires requires(const Sim& simulation) {
      simulation.interaction();
      simulation.particles()[radius];
      simulation.time();
    }
  [[gnu::cold]] void operator()(const Sim& simulation) {
    static_assert(detail::are_of_one_process<std::remove_cvref_t<decltype(simulation.particles())>>,
                  "silt::VtkContacts: it knows the contacts of one process only");
    this->write(double(simulation.time()), simulation.was_read(), Process{},
                vtk_frame_of_contacts(simulation.particles(), simulation.interaction()));
  }
};

}  // namespace silt
