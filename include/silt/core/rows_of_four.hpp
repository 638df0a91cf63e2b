// SPDX-License-Identifier: MIT
// The storage of grains that contacts and the leapfrog read in groups of four numbers.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/particles.hpp>

#include <concepts>
#include <type_traits>
#include <utility>

namespace silt {

/// Whether the particles are stored in these rows, see Bundle in core/field_storage.hpp:
/// {position, a scalar, velocity, mass} and {spin, inertia}; in 2D {position, a scalar, mass,
/// velocity, spin, inertia}, and they have a force and a torque.
template <class P>
constexpr bool in_rows_of_four() {
  if constexpr (requires(const P p) {
                  p.storage(position).rows();
                  p.storage(spin).rows();
                  p.storage(force);
                  p.storage(torque);
                }) {
    using Linear = std::remove_cvref_t<decltype(std::declval<const P&>().storage(position))>;
    using Angular = std::remove_cvref_t<decltype(std::declval<const P&>().storage(spin))>;
    if constexpr (Linear::template has<velocity_t> && Linear::template has<mass_t> &&
                  Angular::template has<inertia_t> && Linear::width == 8) {
      constexpr bool is_linear =
          Linear::template offset<position_t> == 0 && Linear::template offset<velocity_t> == 4;
      if constexpr (P::dimension == 2) {
        return is_linear && std::same_as<Linear, Angular> && Linear::template offset<mass_t> == 3 &&
               Linear::template offset<spin_t> == 6 && Linear::template offset<inertia_t> == 7;
      } else {
        return is_linear && Linear::template offset<mass_t> == 7 && Angular::width == 4 &&
               Angular::template offset<spin_t> == 0 && Angular::template offset<inertia_t> == 3;
      }
    }
  }
  return false;
}

/// The same with the radius after the position, as in dem::Grains.
template <class P>
constexpr bool in_rows_with_radius() {
  if constexpr (in_rows_of_four<P>()) {
    using Linear = std::remove_cvref_t<decltype(std::declval<const P&>().storage(position))>;
    if constexpr (Linear::template has<radius_t>) {
      return Linear::template offset<radius_t> == P::dimension;
    }
  }
  return false;
}

}  // namespace silt
