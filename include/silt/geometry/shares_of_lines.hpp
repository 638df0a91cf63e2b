// SPDX-License-Identifier: MIT
// The share of a point, or of its image in mirrors, that is seen: straight lines to it are followed,
// and reflected where they meet faces.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/geometry/nearby_faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace silt {

/// Those of a point x among faces, which may not be one plane. Refers to them.
template <int Dim>
class SharesOfLines {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;
  using NearFacet = typename NearbyFaces<Dim>::NearFacet;

  /// For the point x that these faces are around.
  explicit SharesOfLines(const NearbyFaces<Dim>& around) : around_(around) {}

  /// The share [-] of lines around the one from x to the image of the point, shifted in all
  /// directions alike: the shares of all that is seen in this direction sum to 1 also beside edges
  /// and corners of the surface, exactly where facets are parallel or at right angles, otherwise on
  /// average over directions. A share changes in small steps when points move. The same from the
  /// point to the image of x.
  double of(const Vec& point, const Mirror<Dim>& mirror) const {
    const bool is_reversed =
        std::lexicographical_compare(point.begin(), point.end(), around_.x().begin(),
                                     around_.x().end());
    const Vec& from = is_reversed ? point : around_.x();
    const Vec& to = is_reversed ? around_.x() : point;
    const Mirror<Dim> through = is_reversed ? mirror.inverse() : mirror;
    const Mirror<Dim> back = through.inverse();
    const Vec image = through(to);
    // Whether the line with this shift leads to the image: to the point, through this mirror.
    const auto leads_there = [&](const Line& line, const Vec& shift) {
      return is_same(line, {back(from), to, multiply<Dim, double>(back.rotation, shift)});
    };
    const Vec first = shift_of(0);
    const Line line = line_between({from, image, first}, 0, around_.margin());
    if (!line.is_close_to_rim) return leads_there(line, first);
    int seen = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec shift = shift_of(k);
      seen += leads_there(line_between({from, image, shift}, 1, 0), shift);
    }
    return seen / 8.0;
  }

 private:
  // Eight shifts, with all signs; in 2D of two sizes.
  Vec shift_of(int k) const {
    static constexpr double sizes[] = {0.61, 0.33, 0.17};  // in no special direction
    Vec shift = Vec::Zero();
    for (int axis = 0; axis < Dim; ++axis) {
      const double sign = (k >> axis) % 2 == 0 ? 1 : -1;
      shift += sign * sizes[axis] * around_.surface().axes()[std::size_t(axis)];
    }
    return around_.width() / (1 + (k >> Dim)) * shift;
  }

  // A line that is reflected where it meets faces: its last part, extended back to its length.
  struct Line {
    Vec begin;
    Vec end;
    Vec shift;  // of the line where it passes faces; its ends stay before them
    bool is_close_to_rim = false;
  };
  bool is_same(const Line& one, const Line& other) const {
    return (one.end - other.end).norm() < around_.round_off() &&
           (one.begin - other.begin).norm() < around_.round_off() &&
           (one.shift - other.shift).norm() < around_.round_off();
  }
  // The line as it is after its reflections, shifted by `share` of its shift. It ends where it is
  // closer to the rim of a facet than this margin [m].
  Line line_between(Line line, double share, double margin) const {
    constexpr int max_reflections = 64;
    double along = -1;  // of its length
    const double close = margin / (line.end - line.begin).norm();
    const NearFacet* last = nullptr;
    for (int k = 0; k < max_reflections; ++k) {
      const NearFacet* first = nullptr;
      double nearest = 2;
      const Vec shift = share * line.shift;
      for (const NearFacet& facet : around_.facets()) {
        if (&facet == last) continue;
        const double before = facet.height(line.begin), behind = facet.height(line.end);
        if ((before > 0) == (behind > 0)) continue;
        const double at = (before + facet.normal.dot(shift)) / (before - behind);
        if (!(at > along - close) || !(at < nearest + close)) continue;
        const Passage passage =
            passage_of_facet(facet, line.begin + shift, line.end + shift, at, margin);
        if (passage == Passage::beside) continue;
        const bool is_at_other = std::abs(at - along) < close || std::abs(at - nearest) < close;
        if (passage == Passage::at_rim || is_at_other) {
          line.is_close_to_rim = true;
          return line;
        }
        nearest = at;
        first = &facet;
      }
      if (!first) return line;
      line.begin -= (2 * first->height(line.begin)) * first->normal;
      line.end -= (2 * first->height(line.end)) * first->normal;
      line.shift -= (2 * first->normal.dot(line.shift)) * first->normal;
      along = nearest;
      last = first;
    }
    return line;
  }
  // How a line passes the faces of a facet near x, whose plane it meets at this share of its length;
  // at_rim: closer to an edge on the rim than a margin [m].
  Passage passage_of_facet(const NearFacet& facet, const Vec& from, const Vec& to, double at,
                           double margin) const {
    const Vec line = to - from;
    const Vec x = from + at * line;
    const double descent = facet.normal.dot(line);
    const double furthest_outside = margin * line.norm() / std::abs(descent) + around_.round_off();
    bool is_through = false;
    for (const std::uint32_t number : around_.faces_of(facet)) {
      const Element& element = around_[number];
      std::array<double, std::size_t(Dim)> inside;
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) inside[k] = element.inside(k, x);
      if (std::ranges::any_of(inside, [&](double s) { return s < -furthest_outside; })) continue;
      if (margin == 0) {
        if (passage_of(element.face, from, to, 0) == Passage::through) return Passage::through;
        continue;
      }
      bool is_inside = true, is_near = true, is_at_rim = false;
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
        if (inside[k] >= furthest_outside) continue;
        // As far in the plane as the line is from the edge.
        const double in_plane = margin * std::hypot(1.0, element.inwards[k].dot(line) / descent);
        is_near = is_near && inside[k] > -in_plane;
        is_at_rim = is_at_rim || (element.is_rim[k] && inside[k] < in_plane);
        is_inside = is_inside && inside[k] >= -around_.round_off();
      }
      if (is_near && is_at_rim) return Passage::at_rim;
      is_through = is_through || is_inside;
    }
    return is_through ? Passage::through : Passage::beside;
  }

  const NearbyFaces<Dim>& around_;
};

}  // namespace silt
