// SPDX-License-Identifier: MIT
// Walls at rest. A wall says where it is nearest to a point; the contact loop does the rest.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <tuple>
#include <utility>

namespace silt::dem {

/// Where a wall is nearest to a grain's centre.
template <int Dim, class Real>
struct NearestPoint {
  Vec<Dim, Real> normal;  ///< unit vector from the wall to the grain
  Real distance;          ///< of the centre from the wall [m]; below 0: behind it
};

/// wall.nearest(x) → NearestPoint, wall.material, wall.check().
template <class W, int Dim, class Real>
concept Wall = requires(const W wall, W own, const Vec<Dim, Real> x) {
  { wall.nearest(x) } -> std::same_as<NearestPoint<Dim, Real>>;
  { wall.material } -> std::convertible_to<std::uint32_t>;
  own.check();
};

/// Half-space: everything behind the plane is solid. A line in 2D.
template <int Dim, class Real = double>
struct Plane {
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();  ///< any point of it [m]
  Vec<Dim, Real> normal = Vec<Dim, Real>::Unit(Dim - 1);  ///< out of the solid; any length but 0
  std::uint32_t material = 0;                             ///< place in dem::Materials

  /// Makes the normal a unit vector; throws if it has no length.
  void check() {
    require_finite("Plane: point", point);
    require_finite("Plane: normal", normal);
    require_positive("Plane: length of the normal", double(normal.norm()));
    normal.normalize();
  }

  NearestPoint<Dim, Real> nearest(const Vec<Dim, Real>& x) const {
    return {normal, (x - point).dot(normal)};
  }
};

/// Thin straight wall in 2D, solid from both sides, with ends.
template <class Real = double>
struct Segment {
  Vec<2, Real> from = Vec<2, Real>::Zero();  ///< [m]
  Vec<2, Real> to = Vec<2, Real>::Zero();    ///< [m]
  std::uint32_t material = 0;                ///< place in dem::Materials

  /// Throws if the two ends are one point.
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
    // The centre is on the wall: push it to the left of from → to.
    return {Vec<2, Real>(-along[1], along[0]).normalized(), 0};
  }
};

/// Walls by their numbers, in the order given.
template <class... Walls>
class WallSet {
 public:
  /// Throws if a wall is out of range.
  explicit WallSet(Walls... walls) : walls_(std::move(walls)...) {
    std::apply([](auto&... wall) { (wall.check(), ...); }, walls_);
  }

  /// f(wall, number) for each.
  template <class F>
  void for_each(F&& f) const {
    Index number = 0;
    std::apply([&](const auto&... wall) { (f(wall, number++), ...); }, walls_);
  }

  template <int Dim, class Real>
  NearestPoint<Dim, Real> nearest(Index number, const Vec<Dim, Real>& x) const {
    NearestPoint<Dim, Real> nearest{};
    for_each([&](const auto& wall, Index w) {
      if (w == number) nearest = wall.nearest(x);
    });
    return nearest;
  }
  std::uint32_t material(Index number) const {
    std::uint32_t material = 0;
    for_each([&](const auto& wall, Index w) {
      if (w == number) material = wall.material;
    });
    return material;
  }

 private:
  std::tuple<Walls...> walls_;
};

}  // namespace silt::dem
