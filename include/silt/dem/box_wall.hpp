// SPDX-License-Identifier: MIT
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall.hpp>

#include <cstdint>
#include <limits>

namespace silt::dem {

/// All sides of a box: six planes (four in 2D) that hold the grains, or a block among them. What
/// is behind a side is solid. There is no wall across a periodic axis, nor at infinity: a box
/// without a lid has upper[2] = ∞.
template <int Dim, class Real = double>
struct BoxWall {
  Box<Dim, Real> box;           ///< [m]
  Side grains = Side::inside;   ///< of the box
  std::uint32_t material = 0;   ///< place in dem::Materials

  /// Throws if the box has no width, or if a block has a periodic axis.
  void check() const {
    box.check();
    if (grains == Side::outside && box.any_periodic()) {
      fail("BoxWall: a block that grains are outside of has a periodic axis; let its sides be at "
           "infinity, or give them numbers");
    }
  }

  /// From inside every side is one: 2k and 2k + 1 are the lower and the upper one of axis k.
  Index element_count() const { return grains == Side::inside ? 2 * Dim : 1; }

  NearestPoint<Dim, Real> nearest(Index part, const Vec<Dim, Real>& x) const {
    if (grains == Side::outside) return nearest_of_block(x);
    if (box.periodic[part / 2]) return no_nearest_point<Dim, Real>();
    return nearest_side(part, x);
  }

  template <class F>
  void for_each_element_near(const Vec<Dim, Real>& x, Real distance, F&& f) const {
    for (Index part = 0; part < element_count(); ++part) {
      if (nearest(part, x).distance < distance) f(part);
    }
  }

 private:
  // Of a side as seen from inside; from outside the distance is below 0.
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
