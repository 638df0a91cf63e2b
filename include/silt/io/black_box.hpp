// SPDX-License-Identifier: MIT
// The black box of a failed step: a small checkpoint with the particles around the one that the
// error names, to repeat and examine the step.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/io/checkpoint.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>

namespace silt {

/// What write_black_box() writes.
struct BlackBox {
  std::filesystem::path file;  ///< replaced if it exists
  /// Of the particles, from the one that failed [m]; five interaction ranges if not given.
  std::optional<double> max_distance = {};
};

/// Writes a checkpoint of the particles around the one that an error of step() or run() names; the
/// simulation is still as before that step. A simulation of the same type and settings, with any
/// particles, that reads it (see read_checkpoint) is at the beginning of the failed step. For
/// grains, the force on that particle is the same to the bit; the pressure of a flow depends on
/// all particles. Throws silt::Error if the simulation has no particle that the error names, if
/// max_distance is not positive, or not given without an interaction range, or if the file cannot
/// be written.
template <class Sim>
void write_black_box(const BlackBox& box, const Sim& simulation, const Error& error) {
  const auto& all = simulation.particles();
  using P = std::remove_cvref_t<decltype(all)>;
  static_assert(detail::are_of_one_process<P>,
                "silt::write_black_box: the particles around one may belong to several processes, "
                "which it does not collect; use write_checkpoint");
  const std::optional<Id> id = error.where().id;
  const Index guilty = id ? all.index_of(*id) : no_index;
  if (guilty == no_index) {
    fail({"write_black_box: ",
          (id ? "the simulation no longer has particle " + std::to_string(*id)
              : std::string("the error names no particle")),
          ": ", error.what(), "; write a checkpoint of the whole simulation instead"});
  }
  const double most = box.max_distance.value_or(5 * double(simulation.interaction().reach(all)));
  require_positive("BlackBox: max_distance", most);
  const typename P::Vec centre = all[position][guilty];
  const NearestImage<P::dimension, typename P::Real> image(all.box());
  Sim near = simulation;
  near.particles().remove_if([&](Index i) {
    return !(double(image(typename P::Vec(all[position][i] - centre)).norm()) <= most);
  });
  write_checkpoint(box.file, near);
}

}  // namespace silt
