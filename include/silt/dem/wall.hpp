// SPDX-License-Identifier: MIT
// What a wall is: it says where it is nearest to a point; the contact loop does the rest.
#pragma once

#include <silt/core/types.hpp>

#include <concepts>
#include <cstdint>
#include <limits>

namespace silt::dem {

/// Where a wall is nearest to a grain's centre.
template <int Dim, class Real>
struct NearestPoint {
  Vec<Dim, Real> normal;  ///< unit vector from the wall to the grain
  Real distance;          ///< of the centre from the wall [m]; below 0: behind it
};

/// Of a part of a wall that pushes nothing there, since another one does.
template <int Dim, class Real>
NearestPoint<Dim, Real> no_nearest_point() {
  return {Vec<Dim, Real>::Unit(Dim - 1), std::numeric_limits<Real>::infinity()};
}

/// Where the grains are.
enum class Side { inside, outside };

/// Touches a grain in one point at most: wall.nearest(x) → NearestPoint.
template <class W, int Dim, class Real>
concept SimpleWall = requires(const W wall, const Vec<Dim, Real> x) {
  { wall.nearest(x) } -> std::same_as<NearestPoint<Dim, Real>>;
};

/// Touches a grain in at most one point of each of its parts, which are numbered from 0:
///   wall.element_count()                         how many there are
///   wall.nearest(part, x)                → NearestPoint; no_nearest_point() where another part pushes
///   wall.for_each_element_near(x, d, f)     f(part) for every part that comes closer to x than d [m],
///                                        once; more may come
template <class W, int Dim, class Real>
concept CompositeWall = requires(const W wall, const Vec<Dim, Real> x, Index part) {
  { wall.element_count() } -> std::convertible_to<Index>;
  { wall.nearest(part, x) } -> std::same_as<NearestPoint<Dim, Real>>;
  wall.for_each_element_near(x, Real(1), [](Index) {});
};

/// A simple wall or one of parts, at rest, with wall.material, its place in dem::Materials, and
/// wall.check(), which throws if it is none.
template <class W, int Dim, class Real>
concept WallAtRest = (SimpleWall<W, Dim, Real> || CompositeWall<W, Dim, Real>) &&
                     requires(const W wall, W own) {
                       { wall.material } -> std::convertible_to<std::uint32_t>;
                       own.check();
                     };

}  // namespace silt::dem
