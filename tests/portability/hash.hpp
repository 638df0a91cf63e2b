// SPDX-License-Identifier: MIT
// A hash of every bit of a simulation's state.
#pragma once

#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <cstring>

namespace silt::portability {

// FNV-1a, by Fowler, Noll and Vo.
class Hash {
 public:
  void add(double number) {
    unsigned char bytes[sizeof number];
    std::memcpy(bytes, &number, sizeof number);
    for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 0x100000001b3u;
  }
  template <int Dim>
  void add(const Vec<Dim>& vector) {
    for (int k = 0; k < Dim; ++k) add(vector[k]);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

// Time, positions, velocities and spins, in the order of the ids.
template <class Simulation>
std::uint64_t hash_of(const Simulation& simulation) {
  const auto particles = simulation.snapshot();
  Hash hash;
  hash.add(simulation.time());
  Index found = 0;
  for (Id id = 0; found < particles.size(); ++id) {
    const Index i = particles.index_of(id);
    if (i == no_index) continue;
    ++found;
    hash.add(particles[position][i]);
    hash.add(particles[velocity][i]);
    if constexpr (decltype(particles)::template has<spin_t>) hash.add(particles[spin][i]);
  }
  return hash.value();
}

// Of all simulations that are one, such as grains and the fluid around them.
template <class Simulations>
  requires requires(const Simulations& all) {
    all.for_each_simulation([](const char*, const auto&) {});
  }
std::uint64_t hash_of(const Simulations& all) {
  std::uint64_t sum = 0;
  all.for_each_simulation([&](const char*, const auto& simulation) {
    sum = 0x9e3779b97f4a7c15 * sum + hash_of(simulation);
  });
  return sum;
}

}  // namespace silt::portability
