// SPDX-License-Identifier: MIT
// Contacts that last beyond zero overlap, for laws with max_gap().
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/of_constants.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/materials.hpp>

#include <algorithm>
#include <cstdint>

namespace silt::dem::detail {

/// How far apart two grains may be that are in contact.
template <class Real>
struct ContactReach {
  Real largest_radius = 0;  ///< [m]
  Real gap = 0;             ///< the largest one of a contact [m]

  /// Between the centres [m].
  Real distance() const { return 2 * largest_radius + gap; }
};

/// The largest gap [m] up to which contacts last, of grains with radii in this range at walls and
/// with each other; 0 for a law without max_gap(). Throws if a law returns one that is negative or
/// not finite.
template <int Dim, class Real, class Law>
Real largest_gap(const Materials<Law>& materials, const RadiusRange<Real>& radii) {
  static_assert(
      !requires(const Law law, Real R) { law.max_gap(R); } || LastsBeyondTouch<Law, Dim, Real>,
      "silt::dem::Contacts: a law with max_gap(effective_radius) needs a History, and "
      "max_gap() returns a number [m] (see ContactLaw in silt/dem/law/contact.hpp)");
  Real largest = 0;
  if constexpr (LastsBeyondTouch<Law, Dim, Real>) {
    if (!(radii.smallest > 0 && radii.largest > 0)) return 0;
    for (std::uint32_t a = 0; a < materials.count(); ++a) {
      for (std::uint32_t b = a; b < materials.count(); ++b) {
        for (const Real R : {radii.smallest / 2, radii.largest}) {
          const Real gap = materials.between(a, b).max_gap(R);
          require_not_negative("dem::Contacts: max_gap(effective_radius) of the law", double(gap));
          largest = std::max(largest, gap);
        }
      }
    }
  }
  return largest;
}

}  // namespace silt::dem::detail
