// SPDX-License-Identifier: MIT
// Particles in messages between processes: whole ones that migrate, copies for a halo, and the state
// of a halo after each step.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/mpi/messages.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

namespace silt::mpi::detail {

template <class P, class F>
using FieldValue = value_of<F, P::dimension, typename P::Real>;

template <class P, class F>
void each_field(const P& particles, F&& f) {
  particles.for_each_field([&](auto, auto field) { f(field); });
}
/// Those that change in a step.
template <class P, class F>
void each_state_field(const P& particles, F&& f) {
  each_field(particles, [&]<class Field>(Field field) {
    if constexpr (role_of<Field>() == Role::state) f(field);
  });
}

/// With its id.
template <class P>
Index bytes_of_particle(const P& particles) {
  Index bytes = sizeof(Id);
  each_field(particles, [&]<class F>(F) { bytes += sizeof(FieldValue<P, F>); });
  return bytes;
}
template <class P>
Index bytes_of_state(const P& particles) {
  Index bytes = 0;
  each_state_field(particles, [&]<class F>(F) { bytes += sizeof(FieldValue<P, F>); });
  return bytes;
}

template <class P, class F>
void write_value(Writer& write, const P& particles, F field, Index i) {
  const FieldValue<P, F> value = particles.with_halo(field)[i];
  write(value);
}
template <class P, class F>
void read_values(Reader& read, P& particles, F field, Index first, Index count) {
  const auto values = particles.halo_to_change(field);
  for (Index i = first; i < first + count; ++i) {
    FieldValue<P, F> value;
    read(value);
    values[i] = value;
  }
}

/// Writes one particle that moves to another process.
template <class P>
void write_particle(Writer& write, const P& particles, Index i) {
  write(particles.id(i));
  each_field(particles, [&](auto field) { write_value(write, particles, field, i); });
}
/// Adds it there.
template <class P>
void read_particle(Reader& read, P& particles) {
  Id id = 0;
  read(id);
  const Index i = particles.adopt(id);
  each_field(particles, [&](auto field) {
    FieldValue<P, decltype(field)> value;
    read(value);
    particles[field][i] = value;
  });
}

/// Writes copies of particles: all ids, then field by field.
template <class P>
void write_copies(Writer& write, const P& particles, std::span<const std::uint32_t> rows) {
  for (const std::uint32_t i : rows) write(particles.id(i));
  each_field(particles, [&](auto field) {
    for (const std::uint32_t i : rows) write_value(write, particles, field, i);
  });
}
template <class P>
Index number_of_copies(const P& particles, const Bytes& message) {
  return message.size() / bytes_of_particle(particles);
}
template <class P>
void read_ids_of_copies(const Bytes& message, const P& particles, std::vector<Id>& ids) {
  Reader read(message);
  const Index count = number_of_copies(particles, message);
  for (Index k = 0; k < count; ++k) read(ids.emplace_back());
}
/// Their fields, into rows of the halo from `first` on.
template <class P>
void read_fields_of_copies(const Bytes& message, P& particles, Index first) {
  const Index count = number_of_copies(particles, message);
  Reader read(std::span<const std::byte>(message).subspan(count * sizeof(Id)));
  each_field(particles, [&](auto field) { read_values(read, particles, field, first, count); });
}

/// Writes the state of particles to memory that is there. Throws nothing.
template <class P>
void write_state(std::byte* to, const P& particles, std::span<const std::uint32_t> rows) {
  each_state_field(particles, [&]<class F>(F field) {
    const auto values = particles.with_halo(field);
    for (const std::uint32_t i : rows) {
      const FieldValue<P, F> value = values[i];
      std::memcpy(to, static_cast<const void*>(&value), sizeof(value));
      to += sizeof(value);
    }
  });
}
template <class P>
void read_state(const Bytes& message, P& particles, Index first, Index count) {
  Reader read(message);
  each_state_field(particles, [&](auto field) { read_values(read, particles, field, first, count); });
}

}  // namespace silt::mpi::detail
