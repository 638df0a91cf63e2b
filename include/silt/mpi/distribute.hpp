// SPDX-License-Identifier: MIT
// Particles that processes have made become particles that they share.
#pragma once

#include <silt/core/shared_particles.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/agreement.hpp>
#include <silt/mpi/shared_particles.hpp>
#include <silt/mpi/world.hpp>

#include <mpi.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

namespace silt::mpi {

namespace detail {

template <class P>
void require_same_box(const SharedParticles<P>& particles) {
  const auto& box = particles.box();
  for (int k = 0; k < P::dimension; ++k) {
    silt::detail::require_same_in_all(
        particles, "mpi: a side of the box [m], or whether it is periodic,",
        std::array{double(box.lower[k]), double(box.upper[k]),
                   box.periodic[Index(k)] ? 1.0 : 0.0, box.on_escape == OnEscape::remove ? 1.0 : 0.0});
  }
}

/// Of the ids and positions; exact as a double.
template <class P>
double hash_of(const P& particles) {
  std::uint64_t hash = 1469598103934665603u;
  const auto add = [&hash](const auto& value) {
    std::array<unsigned char, sizeof(value)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(value));
    for (const unsigned char byte : bytes) hash = (hash ^ byte) * 1099511628211u;
  };
  const auto x = std::as_const(particles)[position];
  for (Index i = 0; i < x.size(); ++i) {
    add(particles.id(i));
    for (int k = 0; k < P::dimension; ++k) add(x[i][k]);
  }
  return double(hash >> 11);
}

}  // namespace detail

/// The share of this process of particles that all processes have made alike, for up to some 10⁷. Throws
/// in all if their numbers, ids, positions or boxes differ.
template <class P>
SharedParticles<P> distribute(P particles, const World& world) {
  const double number = double(particles.size()), hash = detail::hash_of(particles);
  // Until space is cut, in turn.
  const auto rank = Index(world.rank());
  const auto size = Index(world.size());
  particles.remove_if([&](Index i) { return particles.id(i) % size != rank; });
  SharedParticles<P> shared(std::move(particles), world);
  silt::detail::require_same_in_all(shared, "mpi::distribute: the number of particles",
                                    std::array{number});
  silt::detail::require_same_in_all(shared, "mpi::distribute: a hash of ids and positions",
                                    std::array{hash});
  detail::require_same_box(shared);
  return shared;
}

/// Particles of which every process has made a part, numbered together: those of the first process
/// first. Throws in all processes unless all parts have the same box.
template <class P>
SharedParticles<P> distribute_parts(const P& part, const World& world) {
  const Agreement agree(world);
  agree();
  std::uint64_t first = 0;
  const std::uint64_t number = part.size();
  detail::check(MPI_Exscan(&number, &first, 1, MPI_UINT64_T, MPI_SUM, world.communicator()),
                "MPI_Exscan");
  P numbered(part.box());
  agree([&] {
    numbered.reserve(part.size());
    for (Index i = 0; i < part.size(); ++i) numbered.adopt(Id(first + i));
    part.for_each_field([&](const auto& values, auto field) {
      std::ranges::copy(values, numbered[field].begin());
    });
    return Reduced();
  });
  SharedParticles<P> shared(std::move(numbered), world);
  detail::require_same_box(shared);
  return shared;
}

}  // namespace silt::mpi
