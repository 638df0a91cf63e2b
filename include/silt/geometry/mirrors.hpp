// SPDX-License-Identifier: MIT
// What a point sees of a surface that mirrors: a straight line that meets a face is reflected.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/mirror_search.hpp>
#include <silt/geometry/nearby_faces.hpp>
#include <silt/geometry/shares_of_lines.hpp>

#include <cstddef>
#include <span>

namespace silt {

/// The part of a surface around a point x as mirrors. Refers to the surface.
template <int Dim>
class MirrorsAround : public NearbyFaces<Dim> {
 public:
  using Vec = silt::Vec<Dim>;

  /// The share [-] of a point, closer than the reach, that is seen from x: 0 if a face is in
  /// between, else 1; the share of the lines close to it if it goes through an edge, behind which
  /// something else is seen.
  double visible_share(const Vec& point) const {
    if (this->empty()) return 1;
    if (this->is_plane()) return is_before_plane(point);
    return share_among_faces(point);
  }

  /// f(mirror, share_of, for_each_plane) for each mirror that may show one of the points as closer
  /// to x than the reach; share_of(point) is the share of the point's image, which is that close,
  /// that is seen from x, for_each_plane(g) calls g(plane) for each PlaneOfMirror, in the order in
  /// which a point is mirrored in them.
  template <class F>
  void for_each_mirror(std::span<const Vec> points, F&& f) const {
    if (this->empty()) return;
    if (this->is_plane()) {
      const auto& plane = (*this)[this->faces()[0]];
      const auto mirror = mirror_in<Dim>(plane.normal, plane.offset);
      f(
          mirror, [&](const Vec& point) { return is_before_plane(point); },
          [&](auto&& g) { g(PlaneOfMirror<Dim>{plane.normal, plane.offset, plane.group}); });
      return;
    }
    static thread_local MirrorSearch<Dim> search;  // keeps its capacity
    const SharesOfLines<Dim> shares(*this);
    search.find(*this, points);
    search.for_each([&](std::size_t number, const Mirror<Dim>& mirror) {
      f(
          mirror,
          [&](const Vec& point) {
            return search.may_show(number, point) ? shares.of(point, mirror) : 0;
          },
          [&](auto&& g) { search.for_each_plane(number, g); });
    });
  }

 private:
  // Not inlined: few points are near edges, and callers inline the rest once for each instruction
  // set.
  [[gnu::noinline]] double share_among_faces(const Vec& point) const {
    return SharesOfLines<Dim>(*this).of(point, {});
  }
  bool is_before_plane(const Vec& point) const {
    const auto& plane = (*this)[this->faces()[0]];
    return (plane.height(this->x()) > 0) == (plane.height(point) > 0);
  }
};

}  // namespace silt
