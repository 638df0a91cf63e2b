// SPDX-License-Identifier: MIT
// Particles with a field of every kind, in columns and in rows.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>

#include "support/slow_types.hpp"
#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace silt::test {

inline constexpr struct temperature_t : scalar_field {
} temperature{};
inline constexpr struct colour_t : field_of<std::array<unsigned char, 3>>, constant_field {
} colour{};
struct heat_t : scalar_field, derived_field {};

template <int Dim, class Real>
using Warm = Particles<Dim, Real, velocity_t, spin_t, temperature_t, colour_t, heat_t>;
template <int Dim, class Real>
using WarmInRows = Particles<Dim, Real, velocity_t, spin_t, temperature_t, colour_t, heat_t,
                             Bundle<position_t, velocity_t, temperature_t, spin_t>>;

using WarmKinds = AllOrUsual<
    ::testing::Types<Warm<2, double>, Warm<2, float>, Warm<3, double>, Warm<3, float>,
                     WarmInRows<2, double>, WarmInRows<3, float>>,
    ::testing::Types<Warm<2, double>, WarmInRows<3, float>>>;

/// Every pair of neighbours in the last search exchanges `share` of its difference in temperature,
/// as a program may do between two steps.
template <class Sim>
void conduct_heat(Sim& simulation, double share) {
  auto& particles = simulation.particles();
  const auto T = particles[temperature];
  std::vector<double> gained(T.size(), 0.0);
  simulation.search().for_each_pair([&](Index i, Index j, const auto&, auto) {
    j = particles.owner(j);
    gained[i] += share * (T[j] - T[i]);
    gained[j] += share * (T[i] - T[j]);
  });
  for (Index i = 0; i < T.size(); ++i) T[i] += gained[i];
}

}  // namespace silt::test
