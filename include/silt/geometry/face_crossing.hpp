// SPDX-License-Identifier: MIT
// Where faces of groups that move go through each other.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/close_faces.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/rigid_motion.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

namespace silt {

/// Where faces of two groups go through each other.
template <int Dim>
struct FaceCrossing {
  std::uint32_t group, other;  ///< of the faces
  Vec<Dim> x;                  ///< the place, when a step begins [m]
};

namespace detail {

template <int Dim>
using CornersOfFace = std::array<Vec<Dim>, std::size_t(Dim)>;

/// Whether x, a point in the plane of a face, is in the face, and farther than the tolerance [m]
/// from the rim of its facet. Over its other edges it may be by round-off only: with more, it could
/// be on the rim of the next face.
template <int Dim>
bool is_within_rim(const FaceOfSurface<Dim>& face, const Vec<Dim>& x, double tolerance) {
  for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
    if (!(face.inside(k, x) > (face.is_rim[k] ? tolerance : -1e-6 * tolerance))) return false;
  }
  return true;
}

/// Whether an edge of a face with these corners (in 2D, the face itself) goes through another face, at
/// x, and ends on both of its sides; by more than the tolerance [m].
template <int Dim>
bool goes_through(const CornersOfFace<Dim>& corners, const FaceOfSurface<Dim>& face,
                  double tolerance, Vec<Dim>& x) {
  constexpr std::size_t edges = Dim == 2 ? 1 : 3;
  for (std::size_t k = 0; k < edges; ++k) {
    const Vec<Dim>& a = corners[k];
    const Vec<Dim>& b = corners[(k + 1) % std::size_t(Dim)];
    const double of_a = face.height(a), of_b = face.height(b);
    if (!(std::min(of_a, of_b) < -tolerance && std::max(of_a, of_b) > tolerance)) continue;
    x = a + of_a / (of_a - of_b) * (b - a);
    if (is_within_rim(face, x, tolerance)) return true;
  }
  return false;
}

/// Whether a corner of a face that moves from here to there in a step goes through another face, at
/// x; by more than the tolerance [m]. One that is on the face at first comes from the side of its
/// own face. At the rim of the other facet it does so only if its own face goes through that facet
/// beside it: a floor may end below a piston.
template <int Dim>
bool corner_passes(const CornersOfFace<Dim>& from, const CornersOfFace<Dim>& to,
                   const FaceOfSurface<Dim>& face, double tolerance, Vec<Dim>& x) {
  for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
    const double end = face.height(to[k]);
    if (std::abs(end) <= tolerance) continue;
    double begin = face.height(from[k]);
    if (std::abs(begin) <= tolerance) {
      Vec<Dim> middle = Vec<Dim>::Zero();
      for (const Vec<Dim>& corner : from) middle += corner / Dim;
      begin = face.height(middle);
      if (std::abs(begin) <= tolerance) continue;
    }
    if ((begin > 0) == (end > 0)) continue;
    x = to[k];
    if ((x - nearest_of(face.face, x)).norm() - std::abs(end) > tolerance) continue;
    Vec<Dim> inwards = -x;
    for (const Vec<Dim>& corner : to) inwards += corner / Dim;
    const Vec<Dim> beside = x + 20 * tolerance * inwards.normalized();
    if (is_within_rim(face, x, tolerance) || is_within_rim(face, beside, tolerance)) return true;
  }
  return false;
}

/// Whether an edge at the rim of a facet goes through one of another facet in a step, at x; by more
/// than the tolerance [m]. The other one is at rest. What edges that touch at first do shows at the end
/// of the step, by goes_through().
inline bool edge_passes(const FaceOfSurface<3>& own, const CornersOfFace<3>& to,
                        const FaceOfSurface<3>& other, double tolerance, Vec<3>& x) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (!own.is_rim[k]) continue;
    const std::size_t next = (k + 1) % 3;
    const Vec<3>& a = own.face.corners[k];
    const Vec<3> u = own.face.corners[next] - a, u_end = to[next] - to[k];
    for (std::size_t m = 0; m < 3; ++m) {
      if (!other.is_rim[m]) continue;
      const Vec<3>& b = other.face.corners[m];
      const Vec<3> v = other.face.corners[(m + 1) % 3] - b;
      // Signed distances of the lines of both edges.
      const Vec<3> n = cross(u, v), n_end = cross(u_end, v);
      constexpr double parallel = 1e-12;  // squared sine of their angle
      const double uu = u.squaredNorm(), vv = v.squaredNorm();
      if (!(std::min(n.squaredNorm(), n_end.squaredNorm()) > parallel * uu * vv) ||
          !(n.dot(n_end) > 0)) {
        continue;
      }
      const double begin = n.dot(b - a) / n.norm(), end = n_end.dot(b - to[k]) / n_end.norm();
      if (!(std::min(begin, end) < -tolerance && std::max(begin, end) > tolerance)) continue;
      // When they meet, their shares s and t of the edges.
      const double when = begin / (begin - end);
      const Vec<3> from = a + when * (to[k] - a), along = u + when * (u_end - u);
      const Vec<3> w = b - from;
      const double ww = along.squaredNorm(), wv = along.dot(v);
      const double determinant = ww * vv - wv * wv;
      if (!(determinant > parallel * ww * vv)) continue;
      const double s = (w.dot(along) * vv - w.dot(v) * wv) / determinant;
      const double t = (w.dot(along) * wv - w.dot(v) * ww) / determinant;
      if (!(s > 0 && s < 1 && t > 0 && t < 1)) continue;
      x = b + t * v;
      return true;
    }
  }
  return false;
}

/// Whether all of these corners are on one side of the plane of a face, farther than a distance [m].
template <int Dim>
bool are_beside(const CornersOfFace<Dim>& corners, const FaceOfSurface<Dim>& face, double distance) {
  double lowest = face.height(corners[0]), highest = lowest;
  for (std::size_t k = 1; k < std::size_t(Dim); ++k) {
    const double height = face.height(corners[k]);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return lowest > distance || highest < -distance;
}

/// The farthest that a point of some bounds goes in a move [m].
template <int Dim>
double largest_move(const typename Faces<Dim>::Bounds& bounds, const Pose<Dim>& move) {
  double largest = 0;
  for (unsigned corner = 0; corner < 1u << Dim; ++corner) {
    Vec<Dim> x;
    for (int k = 0; k < Dim; ++k) x[k] = (corner >> k & 1u) ? bounds.upper[k] : bounds.lower[k];
    largest = std::max(largest, (move.x_of(x) - x).norm());
  }
  return largest;
}

}  // namespace detail

/// The first place found where faces of different groups go through each other now, by more than a
/// tolerance [m] on both sides. Faces may touch, lie on each other, and have common edges.
template <int Dim>
std::optional<FaceCrossing<Dim>> find_crossing(const Faces<Dim>& faces, double tolerance) {
  std::optional<FaceCrossing<Dim>> found;
  for (std::uint32_t group = 1; group <= faces.groups() && !found; ++group) {
    const auto is_new = [&](std::uint32_t other) { return other == 0 || other > group; };
    for_each_close_pair(faces, group, is_new, tolerance, [&](std::uint32_t k, std::uint32_t m) {
      if (found) return;
      const auto &own = faces[k], &other = faces[m];
      Vec<Dim> x;
      if (detail::goes_through(own.face.corners, other, tolerance, x) ||
          detail::goes_through(other.face.corners, own, tolerance, x)) {
        found = {group, other.group, x};
      }
    });
  }
  return found;
}

/// The first place found where faces of different groups go through each other in the steps of the
/// faces: a corner through a face, or an edge through an edge, by more than a tolerance [m]; or where
/// they are through each other at the end by more than ten times that. Faces may touch and slide along
/// each other.
template <int Dim>
std::optional<FaceCrossing<Dim>> find_crossing_in_step(const Faces<Dim>& faces, double tolerance) {
  using Bounds = typename Faces<Dim>::Bounds;
  Buffer<double> moves(faces.groups() + 1, 0.0);
  double farthest = 0;
  for (std::uint32_t group = 1; group <= faces.groups(); ++group) {
    if (faces.is_empty(group)) continue;
    moves[group] = detail::largest_move<Dim>(faces.bounds_of_group(group), faces.step_of(group).move);
    farthest = std::max(farthest, moves[group]);
  }
  const auto move_of = [&](std::uint32_t group) {
    return group > 0 ? faces.step_of(group).move : Pose<Dim>{};
  };
  std::optional<FaceCrossing<Dim>> found;
  for (std::uint32_t group = 1; group <= faces.groups() && !found; ++group) {
    // From where one group begins to where it ends, as seen from another one, and back.
    std::uint32_t seen_from = group;
    Pose<Dim> there, back;
    const auto is_new = [&](std::uint32_t other) {
      return (other == 0 || other > group) && moves[group] + moves[other] > 0;
    };
    const double reach = 1.1 * (moves[group] + farthest) + 20 * tolerance;
    for_each_close_pair(faces, group, is_new, reach, [&](std::uint32_t k, std::uint32_t m) {
      if (found) return;
      const auto &own = faces[k], &other = faces[m];
      // Most faces that are close to each other cannot meet in a step.
      const double farther = 1.1 * (moves[group] + moves[other.group]) + tolerance;
      if (detail::are_beside(own.face.corners, other, farther) ||
          detail::are_beside(other.face.corners, own, farther)) {
        return;
      }
      if (other.group != seen_from) {
        seen_from = other.group;
        there = move_of(seen_from).inverse().after(move_of(group));
        back = there.inverse();
      }
      detail::CornersOfFace<Dim> own_end, other_end;
      Bounds way = faces.bounds_of(k);
      for (std::size_t c = 0; c < std::size_t(Dim); ++c) {
        own_end[c] = there.x_of(own.face.corners[c]);
        way.enclose({own_end[c], own_end[c]});
      }
      if (way.squared_distance(faces.bounds_of(m)) > squared(tolerance)) return;
      for (std::size_t c = 0; c < std::size_t(Dim); ++c) {
        other_end[c] = back.x_of(other.face.corners[c]);
      }
      Vec<Dim> x;
      bool passes = detail::corner_passes(own.face.corners, own_end, other, tolerance, x) ||
                    detail::corner_passes(other.face.corners, other_end, own, tolerance, x);
      if constexpr (Dim == 3) passes = passes || detail::edge_passes(own, own_end, other, tolerance, x);
      if (passes || detail::goes_through(own_end, other, 10 * tolerance, x) ||
          detail::goes_through(other_end, own, 10 * tolerance, x)) {
        found = {group, other.group, x};
      }
    });
  }
  return found;
}

}  // namespace silt
