// SPDX-License-Identifier: MIT
// Concepts of walls, and the forces of grains on them. A wall returns its nearest point to a
// grain's centre; the contact detection needs nothing else.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>

namespace silt::dem {

/// The point of a wall that is nearest to a grain's centre. Contacts do not check it: with a
/// normal of another length the force is wrong, and with a distance that is NaN there is no
/// contact.
template <int Dim, class Real>
struct NearestPoint {
  Vec<Dim, Real> normal;  ///< unit vector from the wall to the grain [-]
  Real distance;  ///< of the centre from the wall [m]; negative behind the surface; finite, except
                  ///< in no_nearest_point()
};

/// Result of an element that has no contact at a point, because another element of the wall has.
template <int Dim, class Real>
NearestPoint<Dim, Real> no_nearest_point() {
  return {Vec<Dim, Real>::Unit(Dim - 1), std::numeric_limits<Real>::infinity()};
}

/// Two points of a wall, such as the ends of an axis.
template <int Dim, class Real>
struct TwoPoints {
  Vec<Dim, Real> from;  ///< [m]
  Vec<Dim, Real> to;    ///< [m]
};
/// Throws unless both points are finite, and so is their distance, which must not be 0. `name` is
/// that of the wall.
template <int Dim, class Real>
void check_points(const std::string& name, const TwoPoints<Dim, Real>& points) {
  const auto& [from, to] = points;
  require_finite(name + ": from", from);
  require_finite(name + ": to", to);
  const double distance = double((to - from).norm());
  if (distance > 0 && is_finite(distance)) return;
  fail({name, ": from = ", to_text(from), " and to = ", to_text(to), " m have the distance ", distance,
        " m, which must be positive and finite; give other points"});
}

namespace detail {
/// Whether the direction of a vector with this length is known to round-off: not if its square
/// underflows.
template <class Real>
bool has_direction(Real length) {
  return length * length > std::numeric_limits<Real>::min() / std::numeric_limits<Real>::epsilon();
}
}  // namespace detail

/// On which side of a wall the grains are: `inside` or `outside` of it.
enum class Side { inside, outside };

/// A wall with at most one contact per grain: wall.nearest(x) → NearestPoint.
template <class W, int Dim, class Real>
concept SimpleWall = requires(const W wall, const Vec<Dim, Real> x) {
  { wall.nearest(x) } -> std::same_as<NearestPoint<Dim, Real>>;
};

/// A wall of several elements (faces, edges, corners), numbered from 0, with at most one contact
/// per grain and element:
///
///   wall.element_count()                  → number of elements
///   wall.nearest(element, x)              → NearestPoint, or no_nearest_point() if another element
///                                           is in contact there
///   wall.for_each_element_near(x, d, f)     f(element) once for every element closer to x than d
///                                           [m]; further elements are allowed
template <class W, int Dim, class Real>
concept CompositeWall = requires(const W wall, const Vec<Dim, Real> x, Index element) {
  { wall.element_count() } -> std::convertible_to<Index>;
  { wall.nearest(element, x) } -> std::same_as<NearestPoint<Dim, Real>>;
  wall.for_each_element_near(x, Real(1), [](Index) {});
};

/// A simple or composite wall at rest, with wall.material, its index in dem::Materials, and
/// wall.check(), which throws if the wall is invalid. It may also have
///
///   wall.check_in(box, max_radius)  throws if it cannot be used in the box of the grains
///   wall.checksum()                 → std::uint64_t, of all points that define it, by which a
///                                   checkpoint recognises another wall; see PointChecksum
///                                   in silt/geometry/point_checksum.hpp
template <class W, int Dim, class Real>
concept WallAtRest =
    (SimpleWall<W, Dim, Real> || CompositeWall<W, Dim, Real>) && requires(const W wall, W own) {
      { wall.material } -> std::convertible_to<std::uint32_t>;
      own.check();
    };

/// The load of one contact on a wall, at the time N of the contact. The work of the wall on the
/// grain in a step is −(force·velocity + couple·spin) Δt [J].
template <int Dim, class Real>
struct WallContact {
  Index grain = no_index;                                           ///< current index of the grain
  Index wall = no_index;                                            ///< number of the wall
  Vec<Dim, Real> point = Vec<Dim, Real>::Zero();                    ///< contact point [m]
  Vec<Dim, Real> velocity = Vec<Dim, Real>::Zero();                 ///< of the wall there [m/s]
  AngularVec<Dim, Real> spin = zero_of<AngularVec<Dim, Real>>();    ///< of the wall [1/s]
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();                    ///< on the wall [N]
  AngularVec<Dim, Real> couple = zero_of<AngularVec<Dim, Real>>();  ///< on the wall [N m], in
                                                                    ///< addition to the moment of
                                                                    ///< the force
};

/// Sum over all contacts of a wall.
template <int Dim, class Real>
struct WallLoad {
  Vec<Dim, Real> force = Vec<Dim, Real>::Zero();                    ///< [N]
  AngularVec<Dim, Real> torque = zero_of<AngularVec<Dim, Real>>();  ///< about the given point [N m]
};

}  // namespace silt::dem
