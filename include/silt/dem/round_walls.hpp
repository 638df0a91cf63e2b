// SPDX-License-Identifier: MIT
// Walls that are round: drums, pipes, columns.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt::dem {

namespace detail {
/// Of a round wall of this radius [m], at a centre that is `out` from its centre or axis; `across`
/// is the normal where all are equal.
template <int Dim, class Real>
NearestPoint<Dim, Real> nearest_round(const Vec<Dim, Real>& out, Real radius, Side grains,
                                      const Vec<Dim, Real>& across) {
  const Real r = out.norm();
  const Vec<Dim, Real> outwards = r > 0 ? Vec<Dim, Real>(out / r) : across;
  if (grains == Side::inside) return {-outwards, radius - r};
  return {outwards, r - radius};
}
}  // namespace detail

/// A drum that holds the grains, or a disc among them; behind it all is solid.
template <class Real = double>
struct Circle {
  Vec<2, Real> centre = Vec<2, Real>::Zero();  ///< [m]
  Real radius = 0;                             ///< [m], above 0
  Side grains = Side::inside;
  std::uint32_t material = 0;  ///< place in dem::Materials

  /// Throws if the radius is not positive.
  void check() const {
    require_finite("Circle: centre", centre);
    require_positive("Circle: radius", double(radius));
  }

  NearestPoint<2, Real> nearest(const Vec<2, Real>& x) const {
    return detail::nearest_round<2, Real>(x - centre, radius, grains, Vec<2, Real>::Unit(1));
  }
};

/// A drum or pipe that holds the grains, or a column among them, with its axis through two points;
/// behind it all is solid. Without ends it goes on for ever.
template <class Real = double>
struct Cylinder {
  Vec<3, Real> from = Vec<3, Real>::Zero();   ///< of the axis [m]
  Vec<3, Real> to = Vec<3, Real>::Unit(2);    ///< of the axis [m]
  Real radius = 0;                            ///< [m], above 0
  Side grains = Side::inside;
  bool ends = false;           ///< flat, at the two points
  std::uint32_t material = 0;  ///< place in dem::Materials

  /// Throws if the radius is not positive, or the two points of the axis are one.
  void check() const {
    require_finite("Cylinder: from", from);
    require_finite("Cylinder: to", to);
    require_positive("Cylinder: length of the axis", double((to - from).norm()));
    require_positive("Cylinder: radius", double(radius));
  }

  /// A closed drum has three: the mantle, the end at `from`, and that at `to`.
  Index element_count() const { return ends && grains == Side::inside ? 3 : 1; }

  NearestPoint<3, Real> nearest(Index part, const Vec<3, Real>& x) const {
    const Vec<3, Real> axis = (to - from).normalized();
    if (part == 1) return {axis, (x - from).dot(axis)};
    if (part == 2) return {-axis, (to - x).dot(axis)};
    const Vec<3, Real> y = x - from;
    const Real along = y.dot(axis);
    const Vec<3, Real> out = y - along * axis;
    const auto mantle =
        detail::nearest_round<3, Real>(out, radius, grains, axis.unitOrthogonal());
    if (!ends || grains == Side::inside) return mantle;
    return nearest_of_column(axis, mantle, along);
  }

  template <class F>
  void for_each_element_near(const Vec<3, Real>& x, Real distance, F&& f) const {
    for (Index part = 0; part < element_count(); ++part) {
      if (nearest(part, x).distance < distance) f(part);
    }
  }

 private:
  // At a centre so far along the axis.
  NearestPoint<3, Real> nearest_of_column(const Vec<3, Real>& axis,
                                          const NearestPoint<3, Real>& mantle, Real along) const {
    const Real length = (to - from).dot(axis);
    const Real beyond = std::max(-along, along - length);  // the nearer end
    const Vec<3, Real> end = -along > along - length ? Vec<3, Real>(-axis) : axis;
    if (mantle.distance > 0 && beyond > 0) {
      const Real distance = std::hypot(mantle.distance, beyond);
      return {(mantle.distance * mantle.normal + beyond * end) / distance, distance};
    }
    if (mantle.distance > beyond) return mantle;
    return {end, beyond};
  }
};

}  // namespace silt::dem
