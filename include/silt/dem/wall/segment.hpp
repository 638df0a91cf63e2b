// SPDX-License-Identifier: MIT
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>

#include <algorithm>
#include <cstdint>

namespace silt::dem {

/// Thin two-sided straight wall with two ends, in 2D.
template <class Real = double>
struct Segment {
  Vec<2, Real> from = Vec<2, Real>::Zero();  ///< [m]
  Vec<2, Real> to = Vec<2, Real>::Zero();    ///< [m]
  std::uint32_t material = 0;                ///< index in dem::Materials

  /// Throws if the two ends coincide.
  void check() const {
    require_finite("Segment: from", from);
    require_finite("Segment: to", to);
    require_positive("Segment: length", double((to - from).norm()));
  }

  NearestPoint<2, Real> nearest(const Vec<2, Real>& x) const {
    const Vec<2, Real> along = to - from;
    const Real s = std::clamp<Real>((x - from).dot(along) / along.squaredNorm(), 0, 1);
    const Vec<2, Real> out = x - (from + s * along);
    const Real distance = out.norm();
    if (distance > 0) return {out / distance, distance};
    // The centre is on the wall: the normal points to the left of from → to.
    return {Vec<2, Real>(-along[1], along[0]).normalized(), 0};
  }
};

}  // namespace silt::dem
