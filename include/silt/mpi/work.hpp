// SPDX-License-Identifier: MIT
// How much work each particle is, for dividing particles among processes. It is counted, not timed,
// so that a run can be repeated.
#pragma once

#include <silt/core/types.hpp>

#include <span>

namespace silt::mpi {

/// Adds the work of each owned particle in a step, in units of that of a particle without neighbours:
/// what interactions count, such as contacts. False if one of them has not counted these particles yet.
template <class I, class P>
bool add_work(const I& interaction, const P& particles, std::span<double> work) {
  bool is_known = true;
  if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
    interaction.for_each_part(
        [&](const auto& part) { is_known = add_work(part, particles, work) && is_known; });
  } else if constexpr (requires { interaction.add_work(particles, work); }) {
    is_known = interaction.add_work(particles, work);
  }
  return is_known;
}

}  // namespace silt::mpi
