// SPDX-License-Identifier: MIT
// The unknown pressures of a flow that several processes share.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/shared_unknowns.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace silt::mps {

/// The columns of the pressures of a process are the unknowns of its own particles, then those of its
/// halo: column_of of particles and halo is less than `columns` for them. The particles must outlive what
/// is returned.
template <class P>
SharedUnknowns shared_pressures(const P& particles, const Buffer<std::uint32_t>& column_of,
                                Index columns) {
  auto exchange = particles.exchange_of([&](Index i) {
    return column_of[i] < columns ? Index(column_of[i]) : no_index;
  });
  return {
      .refresh = [exchange](std::vector<double>& x) mutable { exchange(x); },
      .sum = [&particles](
                 std::span<double> values) { silt::detail::replace_by_sums(particles, values); },
      .largest =
          [&particles](std::span<double> values) {
            silt::detail::replace_by_largest(particles, values);
          },
      .processes = &particles.world()};
}

}  // namespace silt::mps
