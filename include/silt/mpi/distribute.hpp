// SPDX-License-Identifier: MIT
// Particles that processes have made become particles that they share.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/shared_particles.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

namespace silt::mpi {

/// The share of this process of particles that all processes have made alike, for up to some 10⁷.
template <class P>
SharedParticles<P> distribute(P particles, const World& world) {
  // Until space is cut, in turn.
  const auto rank = Index(world.rank());
  const auto size = Index(world.size());
  particles.remove_if([&](Index i) { return particles.id(i) % size != rank; });
  return SharedParticles<P>(std::move(particles), world);
}

/// Particles of which every process has made a part, numbered together: those of the first process
/// first. Throws in all processes unless all parts have the same box.
template <class P>
SharedParticles<P> distribute_parts(const P& part, const World& world) {
  const auto& box = part.box();
  const Agreement agree(world);
  const auto all = agree([&] {
    Reduced own;
    for (int k = 0; k < P::dimension; ++k) {
      const double lower = double(box.lower[k]), upper = double(box.upper[k]);
      std::ranges::copy(std::array{lower, -lower, upper, -upper}, &own.largest[Index(4 * k)]);
    }
    return own;
  });
  std::uint64_t first = 0;
  const std::uint64_t number = part.size();
  detail::check(MPI_Exscan(&number, &first, 1, MPI_UINT64_T, MPI_SUM, world.communicator()),
                "MPI_Exscan");
  P numbered(box);
  agree([&] {
    for (Index k = 0; k < Index(4 * P::dimension); k += 2) {
      if (all.largest[k] == -all.largest[k + 1]) continue;
      fail("mpi::distribute_parts: a side of the box is at " + to_text(-all.largest[k + 1]) +
           " m in one process and at " + to_text(all.largest[k]) +
           " m in another; give all parts the same box");
    }
    numbered.reserve(part.size());
    for (Index i = 0; i < part.size(); ++i) numbered.adopt(Id(first + i));
    part.for_each_field([&](const auto& values, auto field) {
      std::ranges::copy(values, numbered[field].begin());
    });
    return Reduced();
  });
  return SharedParticles<P>(std::move(numbered), world);
}

}  // namespace silt::mpi
