// SPDX-License-Identifier: MIT
// Particles with a field of every kind, in columns and in rows.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>

#include <gtest/gtest.h>

#include <array>

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

using WarmKinds = ::testing::Types<Warm<2, double>, Warm<2, float>, Warm<3, double>,
                                   Warm<3, float>, WarmInRows<2, double>, WarmInRows<3, float>>;

}  // namespace silt::test
