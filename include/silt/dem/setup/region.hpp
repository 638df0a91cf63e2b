// SPDX-License-Identifier: MIT
// Regions in which grains are added or removed. A silt::Box is a region; grains may protrude
// through its periodic sides.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <numbers>

namespace silt::dem {

/// A region has
///
///   clearance(x)   → distance of x to the boundary [m]; negative outside
///   bounds()       → the bounding Box; must be finite for adding grains
///   volume()       → [m³], in 2D [m²]
///   check()        throws if the region is invalid
template <class R, int Dim, class Real>
concept Region = requires(const R region, const Vec<Dim, Real> x) {
  { region.clearance(x) } -> std::convertible_to<Real>;
  { region.bounds() } -> std::convertible_to<Box<Dim, Real>>;
  { region.volume() } -> std::convertible_to<double>;
  region.check();
};

/// Upright cylinder in 3D, along the last axis.
template <class Real = double>
struct VerticalCylinder {
  Vec<3, Real> base = Vec<3, Real>::Zero();  ///< centre of the lower end face [m]
  Real radius = 0;                           ///< [m], above 0
  Real height = 0;                           ///< [m], above 0

  void check() const {
    require_finite("VerticalCylinder: base", base);
    require_positive("VerticalCylinder: radius", double(radius));
    require_positive("VerticalCylinder: height", double(height));
  }
  Box<3, Real> bounds() const {
    const Vec<3, Real> aside(radius, radius, 0);
    return {.lower = base - aside, .upper = base + aside + Vec<3, Real>(0, 0, height)};
  }
  double volume() const {
    return std::numbers::pi * double(radius) * double(radius) * double(height);
  }
  Real clearance(const Vec<3, Real>& x) const {
    const Vec<3, Real> from_base = x - base;
    return std::min(
        {radius - from_base.template head<2>().norm(), from_base[2], height - from_base[2]});
  }
};

}  // namespace silt::dem
