// SPDX-License-Identifier: MIT
// Round walls: drums, pipes, columns.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silt::dem {

namespace detail {
/// Nearest point of a round wall with this radius [m] to a grain centre at `out` relative to the
/// wall's centre or axis; `across` is the normal to use if `out` has no direction.
template <int Dim, class Real>
NearestPoint<Dim, Real> nearest_round(const Vec<Dim, Real>& out, Real radius, Side grains,
                                      const Vec<Dim, Real>& across) {
  const Real r = out.norm();
  const Vec<Dim, Real> outwards = has_direction(r) ? Vec<Dim, Real>(out / r) : across;
  if (grains == Side::inside) return {-outwards, radius - r};
  return {outwards, r - radius};
}
}  // namespace detail

/// A circular container, or a solid disc among the grains. Everything behind its surface is solid.
template <class Real = double>
struct Circle {
  Vec<2, Real> centre = Vec<2, Real>::Zero();  ///< [m]
  Real radius = 0;                             ///< [m], above 0
  Side grains = Side::inside;                  ///< which side the grains are on
  std::uint32_t material = 0;                  ///< index in dem::Materials

  /// Throws if the radius is not positive.
  void check() const {
    require_finite("Circle: centre", centre);
    if (!is_finite(centre.squaredNorm())) {
      fail(
          {"Circle: centre = ", to_text(centre), " m has an infinite square; move it nearer to 0"});
    }
    require_positive("Circle: radius", double(radius));
  }

  NearestPoint<2, Real> nearest(const Vec<2, Real>& x) const {
    return detail::nearest_round<2, Real>(x - centre, radius, grains, Vec<2, Real>::Unit(1));
  }
};

/// A drum or pipe around the grains, or a solid column among them, with its axis through two
/// points. Everything behind its surface is solid. Without ends it is infinitely long.
template <class Real = double>
struct Cylinder {
  Vec<3, Real> from = Vec<3, Real>::Zero();  ///< first point of the axis [m]
  Vec<3, Real> to = Vec<3, Real>::Unit(2);   ///< second point of the axis [m]
  Real radius = 0;                           ///< [m], above 0
  Side grains = Side::inside;                ///< which side the grains are on
  bool ends = false;                         ///< has flat ends at the two points
  std::uint32_t material = 0;                ///< index in dem::Materials

  /// Throws if the radius is not positive, or if the two points of the axis coincide.
  void check() const {
    check_points<3, Real>("Cylinder", {from, to});
    require_positive("Cylinder: radius", double(radius));
  }

  /// A drum with ends has three elements: the lateral surface, the end at `from` and that at `to`.
  Index element_count() const { return ends && grains == Side::inside ? 3 : 1; }

  NearestPoint<3, Real> nearest(Index element, const Vec<3, Real>& x) const {
    const Vec<3, Real> axis = (to - from).normalized();
    if (element == 1) return {axis, (x - from).dot(axis)};
    if (element == 2) return {-axis, (to - x).dot(axis)};
    const Vec<3, Real> y = x - from;
    const Real along = y.dot(axis);
    const Vec<3, Real> out = y - along * axis;
    const auto mantle = detail::nearest_round<3, Real>(out, radius, grains, unit_across(axis));
    if (!ends || grains == Side::inside) return mantle;
    return nearest_of_column(axis, mantle, along);
  }

  template <class F>
  void for_each_element_near(const Vec<3, Real>& x, Real distance, F&& f) const {
    for (Index element = 0; element < element_count(); ++element) {
      if (nearest(element, x).distance < distance) f(element);
    }
  }

 private:
  // `along` is the coordinate of the grain's centre on the axis.
  NearestPoint<3, Real> nearest_of_column(const Vec<3, Real>& axis,
                                          const NearestPoint<3, Real>& mantle, Real along) const {
    const Real length = (to - from).dot(axis);
    const Real beyond = std::max(-along, along - length);  // the nearer end
    const Vec<3, Real> end = -along > along - length ? Vec<3, Real>(-axis) : axis;
    if (mantle.distance > 0 && beyond > 0) {
      const Real distance = std::hypot(mantle.distance, beyond);
      if (detail::has_direction(distance)) {
        return {(mantle.distance * mantle.normal + beyond * end) / distance, distance};
      }
    }
    if (mantle.distance > beyond) return mantle;
    return {end, beyond};
  }
};

}  // namespace silt::dem
