// SPDX-License-Identifier: MIT
// The sides of a box as walls.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>

#include <cstdint>

namespace silt::dem {

/// All sides of a box: a container of six planes (four in 2D), or a solid block among the grains.
/// The space behind a side is solid. There is no wall at a periodic side or at infinity: a
/// container without a lid has upper[2] = ∞.
template <int Dim, class Real = double>
struct BoxWall {
  Box<Dim, Real> box;          ///< [m]
  Side grains = Side::inside;  ///< which side the grains are on
  std::uint32_t material = 0;  ///< index in dem::Materials

  /// Throws if the box has no extent, or if a block has a periodic axis.
  void check() const {
    box.check();
    if (grains == Side::outside && box.any_periodic()) {
      fail(
          "BoxWall: a block (grains = Side::outside) has a periodic axis; place these sides at "
          "infinity, or make the axis non-periodic");
    }
  }

  /// A container has one element per side: 2k and 2k + 1 are the lower and upper side of axis k. A
  /// block has one element.
  Index element_count() const { return grains == Side::inside ? 2 * Dim : 1; }

  NearestPoint<Dim, Real> nearest(Index element, const Vec<Dim, Real>& x) const {
    if (grains == Side::outside) return nearest_of_block(x);
    if (box.periodic[element / 2]) return no_nearest_point<Dim, Real>();
    return nearest_side(element, x);
  }

  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    for (Index element = 0; element < element_count(); ++element) {
      if (nearest(element, x).distance < distance) f(element);
    }
  }

 private:
  // For grains inside; outside the distance is negative.
  NearestPoint<Dim, Real> nearest_side(Index side, const Vec<Dim, Real>& x) const {
    const int k = static_cast<int>(side / 2);
    if (side % 2 == 0) return {Vec<Dim, Real>::Unit(k), x[k] - box.lower[k]};
    return {-Vec<Dim, Real>::Unit(k), box.upper[k] - x[k]};
  }

  NearestPoint<Dim, Real> nearest_of_block(const Vec<Dim, Real>& x) const {
    const Vec<Dim, Real> out = x - x.cwiseMax(box.lower).cwiseMin(box.upper);
    const Real distance = out.norm();
    if (distance > 0) return {out / distance, distance};
    auto nearest = nearest_side(0, x);
    for (Index side = 1; side < 2 * Dim; ++side) {
      const auto other = nearest_side(side, x);
      if (other.distance < nearest.distance) nearest = other;
    }
    return {-nearest.normal, -nearest.distance};
  }
};

}  // namespace silt::dem
