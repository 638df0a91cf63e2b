// SPDX-License-Identifier: MIT
// Thin two-sided walls in 2D.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/wall/wall.hpp>
#include <silt/geometry/point_checksum.hpp>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace silt::dem {

/// Thin two-sided wall of consecutive line segments in 2D. A segment has a contact if the grain's
/// centre projects onto it; a corner or end, if the centre projects onto neither adjacent segment.
/// A point in the middle of a straight line has no effect.
template <class Real = double>
struct Polyline {
  std::vector<Vec<2, Real>> points;  ///< [m]
  bool closed = false;               ///< the last point is connected to the first
  std::uint32_t material = 0;        ///< index in dem::Materials

  /// Removes points in the middle of straight lines. Throws if there are fewer than two points
  /// (three if closed), or if two consecutive points coincide.
  void check() {
    const Index least = closed ? 3 : 2;
    if (points.size() < least) {
      fail({"Polyline: number of points = ", points.size(), "; give at least ", least});
    }
    const auto name_of = [](Index k) { return "Polyline: point " + std::to_string(k); };
    for (Index k = 0; k < points.size(); ++k) require_finite(name_of(k), points[k]);
    for (Index k = 0; k < lines(); ++k) {
      const std::string next_one = std::to_string(k + 1 == points.size() ? 0 : k + 1);
      check_points<2, Real>("Polyline: points " + std::to_string(k) + " and " + next_one,
                            {points[k], next(k)});
    }
    std::vector<Vec<2, Real>> corners;
    for (Index k = 0; k < points.size(); ++k) {
      if (!is_within_a_straight_line(k)) corners.push_back(points[k]);
    }
    points = corners;
  }

  std::uint64_t checksum() const {
    PointChecksum all;
    for (const Vec<2, Real>& point : points) all.add<2, Real>(point);
    all.add(closed);
    return all.sum();
  }

  /// Segments, then points.
  Index element_count() const { return lines() + points.size(); }

  NearestPoint<2, Real> nearest(Index element, const Vec<2, Real>& x) const {
    return element < lines() ? nearest_of_line(element, x) : nearest_of_point(element - lines(), x);
  }

  template <class F>
  void for_each_element_near(const Vec<2, Real>& x, Real distance, F&& f) const {
    for (Index k = 0; k < lines(); ++k) {
      const Vec<2, Real> along = next(k) - points[k];
      const Real s = std::clamp<Real>((x - points[k]).dot(along) / along.squaredNorm(), 0, 1);
      if ((x - points[k] - s * along).norm() < distance) f(k);
    }
    for (Index k = 0; k < points.size(); ++k) {
      if ((x - points[k]).norm() < distance) f(lines() + k);
    }
  }

 private:
  Index lines() const { return closed ? points.size() : points.size() - 1; }
  bool has_line(Index k) const { return k < lines(); }
  const Vec<2, Real>& next(Index k) const { return points[k + 1 == points.size() ? 0 : k + 1]; }
  Index before(Index k) const { return k == 0 ? points.size() - 1 : k - 1; }
  Vec<2, Real> direction(Index line) const { return (next(line) - points[line]).normalized(); }

  bool is_within_a_straight_line(Index k) const {
    constexpr Real straight = Real(1e-6);  // [rad]
    if (!closed && (k == 0 || k + 1 == points.size())) return false;
    return (direction(k) - direction(before(k))).norm() < straight;
  }

  // Distance of x from the beginning and to the end of a segment, along it. The segment and its two
  // ends test the same numbers, so that exactly one of them is in contact.
  Real beyond_start(Index line, const Vec<2, Real>& x) const {
    return (x - points[line]).dot(direction(line));
  }
  Real before_end(Index line, const Vec<2, Real>& x) const {
    return (next(line) - x).dot(direction(line));
  }

  NearestPoint<2, Real> nearest_of_line(Index line, const Vec<2, Real>& x) const {
    if (!(beyond_start(line, x) > 0 && before_end(line, x) > 0)) return no_nearest_point<2, Real>();
    const Vec<2, Real> along = direction(line);
    const Vec<2, Real> left(-along[1], along[0]);
    const Real height = (x - points[line]).dot(left);
    return height < 0 ? NearestPoint<2, Real>{-left, -height} : NearestPoint<2, Real>{left, height};
  }

  NearestPoint<2, Real> nearest_of_point(Index k, const Vec<2, Real>& x) const {
    const Index last = before(k);
    const bool is_beside =
        (has_line(k) && beyond_start(k, x) > 0) || ((closed || k > 0) && before_end(last, x) > 0);
    if (is_beside) return no_nearest_point<2, Real>();
    const Vec<2, Real> out = x - points[k];
    const Real distance = out.norm();
    if (detail::has_direction(distance)) return {out / distance, distance};
    // The centre is on the point: the normal is that between the segments, outside.
    Vec<2, Real> outside = Vec<2, Real>::Zero();
    if (has_line(k)) outside -= direction(k);
    if (closed || k > 0) outside += direction(last);
    return {outside.normalized(), 0};
  }
};

/// Thin two-sided straight wall with two ends, in 2D.
template <class Real = double>
struct Segment {
  Vec<2, Real> from = Vec<2, Real>::Zero();  ///< [m]
  Vec<2, Real> to = Vec<2, Real>::Zero();    ///< [m]
  std::uint32_t material = 0;                ///< index in dem::Materials

  /// Throws if the two ends coincide.
  void check() const { check_points<2, Real>("Segment", {from, to}); }

  NearestPoint<2, Real> nearest(const Vec<2, Real>& x) const {
    const Vec<2, Real> along = to - from;
    const Real s = std::clamp<Real>((x - from).dot(along) / along.squaredNorm(), 0, 1);
    const Vec<2, Real> out = x - (from + s * along);
    const Real distance = out.norm();
    if (detail::has_direction(distance)) return {out / distance, distance};
    // The centre is on the wall: the normal points to the left of from → to.
    return {Vec<2, Real>(-along[1], along[0]).normalized(), 0};
  }
};

}  // namespace silt::dem
