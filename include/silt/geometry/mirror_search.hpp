// SPDX-License-Identifier: MIT
// Finds the mirrors in which a point may see others, and those in mirrors.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/beams.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/nearby_faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace silt {

/// Refers to the faces around x, which may not be one plane. Keeps its capacity.
template <int Dim>
class MirrorSearch {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;
  using NearFacet = typename NearbyFaces<Dim>::NearFacet;

  /// Finds the mirrors around x, and those in mirrors, each once, that may show one of the points;
  /// between acute faces there is no end of them. A line shorter than the reach meets faces closer than
  /// that only.
  void find(const NearbyFaces<Dim>& around, std::span<const Vec> points) {
    around_ = &around;
    beams_.clear();
    find_least_heights(points);
    seen_.assign(1, {{}, around.x()});
    std::size_t mirrors = 0;
    for (std::size_t k = 0; k < seen_.size(); ++k) {
      if (seen_[k].is_known) continue;
      for (const NearFacet& facet : around.facets()) {
        if (mirrors < max_mirrors && follow(k, facet)) ++mirrors;
      }
    }
  }
  /// f(number, mirror)
  template <class F>
  void for_each(F&& f) const {
    for (std::size_t k = 1; k < seen_.size(); ++k) {
      if (!seen_[k].is_known && seen_[k].shows_points) f(k, seen_[k].mirror);
    }
  }
  /// f(plane) for each PlaneOfMirror of a mirror, in the order in which a point is mirrored in
  /// them.
  template <class F>
  void for_each_plane(std::size_t mirror, F&& f) const {
    for (std::size_t k = mirror; seen_[k].last; k = seen_[k].from) {
      const NearFacet& facet = *seen_[k].last;
      f(PlaneOfMirror<Dim>{facet.normal, facet.offset,
                           (*around_)[around_->faces_of(facet)[0]].group});
    }
  }
  /// Whether x may see the image of a point in a mirror: in one of the ways that lead to it.
  bool may_show(std::size_t mirror, const Vec& point) const {
    do {
      if (beams_.contains(seen_[mirror].beam, point)) return true;
      mirror = seen_[mirror].next;
    } while (mirror > 0);
    return false;
  }

 private:
  static constexpr std::size_t max_mirrors = 1024;

  struct Seen {
    Mirror<Dim> mirror;
    Vec viewpoint;  // x in the space of the points: the image of x in the inverse mirror
    const NearFacet* last = nullptr;      // before the points are reached; null if there is none
    typename Beams<Dim>::Beam beam = {};  // of the lines that have passed it
    std::uint32_t next = 0;               // the next way to the same mirror; 0: none
    std::uint32_t from = 0;               // the mirror before the last facet
    bool is_known = false;                // a further way to another one
    bool shows_points = true;             // may show one
  };

  // Adds the mirror that lines meet with a facet after mirror k, if there are any. Whether it is a
  // new one.
  bool follow(std::size_t k, const NearFacet& facet) {
    const Seen& from = seen_[k];
    const double height = facet.height(from.viewpoint);
    if (!(std::abs(height) < around_->furthest()) || facet.side * height < 0) return false;
    const double most = furthest_that_shows(facet, height);
    // From one face to the next one of a curved surface go only lines that are almost parallel to it,
    // and lead to no point.
    constexpr double cos_30 = 0.866;
    const bool is_next = from.last && std::abs(from.last->normal.dot(facet.normal)) > cos_30;
    if (is_next && (!from.shows_points || !(std::abs(height) < most))) return false;
    const double distance = distance_after(k, facet, is_next ? most : around_->furthest());
    if (!(distance < around_->furthest())) return false;
    Seen added{from.mirror.after(mirror_in<Dim>(facet.normal, facet.offset)),
               from.viewpoint - (2 * height) * facet.normal, &facet};
    added.shows_points = distance < most;
    added.from = static_cast<std::uint32_t>(k);
    added.beam = beams_.through(
        around_->faces_of(facet),
        [&](std::uint32_t face) -> const auto& { return (*around_)[face]; }, added.viewpoint, -height,
        around_->margin(), from.next == 0 ? from.beam : typename Beams<Dim>::Beam{});
    const auto same = std::ranges::find_if(seen_, [&](const Seen& other) {
      const double round_off = around_->round_off();
      return !other.is_known && (other.viewpoint - added.viewpoint).norm() < round_off &&
             (other.mirror.rotation - added.mirror.rotation).norm() < round_off / around_->reach();
    });
    added.is_known = same != seen_.end();
    if (added.is_known) {
      added.next = same->next;
      same->shows_points = same->shows_points || added.shows_points;
      same->next = static_cast<std::uint32_t>(seen_.size());
    }
    seen_.push_back(added);
    return !added.is_known;
  }
  // Few facets are seen sooner than heights are found.
  void find_least_heights(std::span<const Vec> points) {
    constexpr std::size_t few = 3;
    least_heights_.clear();
    if (around_->facets().size() <= few) return;
    for (const NearFacet& facet : around_->facets()) {
      double above = std::numeric_limits<double>::infinity(), below = above;
      for (const Vec& point : points) {
        const double height = facet.height(point);
        above = std::min(above, height > 0 ? height : above);
        below = std::min(below, height > 0 ? below : -height);
      }
      least_heights_.push_back({above, below});
    }
  }
  // The largest distance from the viewpoint, at this height above a facet, at which a line through it
  // that is as long as the reach still comes to the height of a point on the other side.
  double furthest_that_shows(const NearFacet& facet, double height) const {
    if (least_heights_.empty()) return around_->furthest();
    const auto number = static_cast<std::size_t>(&facet - around_->facets().data());
    const double least = least_heights_[number][height > 0 ? 0 : 1];
    const double shift = around_->margin();
    const double share = (std::abs(height) + shift) / (std::abs(height) + least);
    return around_->reach() * std::min(1.0, share) + shift;
  }
  // From the viewpoint in a mirror to the nearest of the faces of a facet that lines may meet after it
  // [m]; infinite if there is none closer than `most`. All ways to that mirror are known: as straight
  // lines, they go through as many facets.
  double distance_after(std::size_t mirror, const NearFacet& facet,
                        double most) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t number : around_->faces_of(facet)) {
      const Element& element = (*around_)[number];
      const Vec& viewpoint = seen_[mirror].viewpoint;
      std::size_t way = mirror;
      do {
        if (is_before(element.face, seen_[way], most)) {
          least = std::min(least, (nearest_of(element.face, viewpoint) - viewpoint).norm());
          break;
        }
        way = seen_[way].next;
      } while (way > 0);
    }
    return least < most ? least : std::numeric_limits<double>::infinity();
  }
  // Whether lines that have passed a mirror may meet a face, also if they are shifted.
  bool is_before(const Face<Dim>& face, const Seen& from, double most) const {
    if (!from.last) return true;
    const double side = from.last->height(from.viewpoint) > 0 ? -1 : 1;
    const bool has_point_before = std::ranges::any_of(face.corners, [&](const Vec& corner) {
      return side * from.last->height(corner) > around_->round_off();
    });
    return has_point_before && beams_.may_meet(from.beam, face, most);
  }

  const NearbyFaces<Dim>* around_ = nullptr;
  Buffer<Seen> seen_;  // the first is x itself
  Beams<Dim> beams_;
  // Of the points that are closest to the plane of each facet, on its two sides [m].
  Buffer<std::array<double, 2>> least_heights_;
};

}  // namespace silt
