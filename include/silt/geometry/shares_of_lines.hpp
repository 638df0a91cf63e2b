// SPDX-License-Identifier: MIT
// The share of a point, or of its image in mirrors, that is seen: straight lines to it are
// followed, and reflected where they meet faces.
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
#include <optional>

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

  /// A share and its derivatives by the positions of x and of the image; 0 beside several edges.
  struct Share {
    double value;                      ///< [-]
    Vec slope = Vec::Zero();           ///< by the position of x [1/m]
    Vec slope_of_image = Vec::Zero();  ///< by that of the image [1/m]
  };

  /// The share [-] of lines around the one from x to the image of the point, shifted in all
  /// directions alike: the shares of all that is seen in this direction sum to 1 also beside edges
  /// and corners of the surface, exactly beside a single edge and where facets are parallel or at
  /// right angles, otherwise on average over directions. A share changes smoothly when points move,
  /// beside several edges in small steps. The same from the point to the image of x.
  double of(const Vec& point, const Mirror<Dim>& mirror) const {
    return share_of(point, mirror).value;
  }
  /// The same, with its derivatives.
  Share share_of(const Vec& point, const Mirror<Dim>& mirror) const {
    const bool is_reversed = std::lexicographical_compare(point.begin(), point.end(),
                                                          around_.x().begin(), around_.x().end());
    const Vec& from = is_reversed ? point : around_.x();
    const Vec& to = is_reversed ? around_.x() : point;
    const Mirror<Dim> through = is_reversed ? mirror.inverse() : mirror;
    const Mirror<Dim> back = through.inverse();
    const Vec image = through(to);
    // Whether the line with this shift leads to the image: to the point, through this mirror.
    const auto leads_there = [&](const Line& line, const Vec& shift) {
      return is_same(line, {back(from), to, multiply<Dim, double>(back.rotation, shift)});
    };
    const Line line = line_between({from, image, shift_of(0)}, to, 0, around_.margin());
    if (!line.is_close_to_rim) return {double(leads_there(line, shift_of(0)))};
    if (line.edge) {
      // Of the lines beside one edge, all on the same side of it lead to the same.
      const Edge& edge = *line.edge;
      const Vec shift = around_.margin() * edge.across;
      const Line inner = line_between({from, image, shift}, to, 1, around_.width(), &edge);
      const Line outer = line_between({from, image, Vec(-shift)}, to, 1, around_.width(), &edge);
      if (!inner.is_close_to_rim && !outer.is_close_to_rim) {
        const Step step = step_at(edge.inside / around_.margin());
        const double inner_value = leads_there(inner, shift);
        const double outer_value = leads_there(outer, -shift);
        const Vec slope = step.slope / around_.margin() * (inner_value - outer_value) * edge.across;
        const Vec first = (1 - edge.along_line) * slope, second = edge.along_line * slope;
        Share share{step.value * inner_value + (1 - step.value) * outer_value};
        share.slope = is_reversed ? multiply<Dim, double>(back.rotation, second) : first;
        share.slope_of_image = is_reversed ? multiply<Dim, double>(mirror.rotation, first) : second;
        return share;
      }
    }
    int seen = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec shift = shift_of(k);
      seen += leads_there(line_between({from, image, shift}, to, 1, 0), shift);
    }
    return {seen / 8.0};
  }

 private:
  // A smooth step from 0 at −1 to 1 at 1, and its slope [-]. Points of a lattice are exactly in
  // line with edges that fit it: there it is constant, as fluid beside them is at rest only if
  // small moves do not change shares.
  struct Step {
    double value, slope;
  };
  static Step step_at(double x) {
    constexpr double constant = 0.15;
    const double u = std::clamp((std::abs(x) - constant) / (1 - constant), 0.0, 1.0);
    const double half = u * u * (3 - 2 * u) / 2;
    return {0.5 + (x > 0 ? half : -half), 3 * u * (1 - u) / (1 - constant)};
  }
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

  // An edge on the rim of a facet, and a line that passes it.
  struct Edge {
    const Element* element = nullptr;
    std::size_t number = 0;
    double inside = 0;      // distance of the line from it, positive on the side of the face [m]
    double along_line = 0;  // where the line is closest to it, over its length [-]
    // Unit vector from the edge to this side, at right angles to both [-].
    Vec across = Vec::Zero();
  };
  // A line that is reflected where it meets faces: its last part, extended back to its length.
  struct Line {
    Vec begin;
    Vec end;
    Vec shift;  // of the line where it passes faces; its ends stay before them
    bool is_close_to_rim = false;
    std::optional<Edge> edge = {};  // that is close, as it is before the reflections
  };
  static bool are_on_one_line(const Edge& edge, const Element& other, std::size_t k,
                              double round_off) {
    const Vec& a = edge.element->face.corners[edge.number];
    const Vec& first = other.face.corners[k];
    if constexpr (Dim == 2) {
      return (first - a).norm() < round_off;
    } else {
      const Vec along = edge.element->face.corners[(edge.number + 1) % 3] - a;
      const Vec& second = other.face.corners[(k + 1) % 3];
      const double least = round_off * along.norm();
      return cross(Vec(first - a), along).norm() < least &&
             cross(Vec(second - a), along).norm() < least;
    }
  }
  bool is_same(const Line& one, const Line& other) const {
    return (one.end - other.end).norm() < around_.round_off() &&
           (one.begin - other.begin).norm() < around_.round_off() &&
           (one.shift - other.shift).norm() < around_.round_off();
  }
  // The line to a point as it is after its reflections, shifted by `share` of its shift. It ends
  // where it is closer to the rim of a facet than this margin [m], but for the line of an edge that
  // is known.
  Line line_between(Line line, const Vec& to, double share, double margin,
                    const Edge* known = nullptr) const {
    constexpr int max_reflections = 64;
    std::array<const Vec*, std::size_t(max_reflections)> normals;
    double along = -1;  // of its length
    // Beside a known edge, the line is that far from it that the order of its facets is clear.
    const double close = known ? 0 : margin / (line.end - line.begin).norm();
    const NearFacet* last = nullptr;
    for (std::size_t k = 0; k < normals.size(); ++k) {
      const NearFacet* first = nullptr;
      double nearest = 2;
      const Vec shift = share * line.shift;
      for (const NearFacet& facet : around_.facets()) {
        if (&facet == last) continue;
        const double before = facet.height(line.begin), behind = facet.height(line.end);
        if ((before > 0) == (behind > 0)) continue;
        // A shifted line that is almost parallel to a facet would meet its plane beyond its ends.
        const double at =
            std::clamp((before + facet.normal.dot(shift)) / (before - behind), 0.0, 1.0);
        if (!(at > along - close) || !(at < nearest + close)) continue;
        // A face so far away is not known to be near the point.
        const Vec crossing = line.begin + shift + at * (line.end - line.begin);
        if ((crossing - to).norm() > around_.furthest()) continue;
        const Passage passage = passage_of_facet(facet, line.begin + shift, line.end + shift, at,
                                                 margin, known, line.edge);
        if (passage == Passage::beside) continue;
        const bool is_at_other = std::abs(at - along) < close || std::abs(at - nearest) < close;
        if (passage == Passage::at_rim || is_at_other) {
          line.is_close_to_rim = true;
          if (!line.edge) return line;
          for (std::size_t m = k; m-- > 0;) {
            line.edge->across -= (2 * normals[m]->dot(line.edge->across)) * *normals[m];
          }
          return line;
        }
        nearest = at;
        first = &facet;
      }
      if (!first) return line;
      line.begin -= (2 * first->height(line.begin)) * first->normal;
      line.end -= (2 * first->height(line.end)) * first->normal;
      line.shift -= (2 * first->normal.dot(line.shift)) * first->normal;
      normals[k] = &first->normal;
      along = nearest;
      last = first;
    }
    return line;
  }
  // Whether a line passes an edge, not only the line on which it is, closer than a margin [m].
  static bool is_closer(const Edge& edge, const Vec& from, const Vec& line, double margin) {
    if constexpr (Dim == 2) {
      return true;
    } else {
      const auto& corners = edge.element->face.corners;
      const Vec nearest = from + edge.along_line * line - edge.inside * edge.across;
      const Vec of_edge =
          nearest_of_segment<3>(corners[edge.number], corners[(edge.number + 1) % 3], nearest);
      return cross(Vec(of_edge - from), line).norm() < margin * line.norm();
    }
  }
  // How a line passes the faces of a facet near x, whose plane it meets at this share of its
  // length; at_rim: closer to an edge on the rim, which is not the known one, than a margin [m].
  Passage passage_of_facet(const NearFacet& facet, const Vec& from, const Vec& to, double at,
                           double margin, const Edge* known, std::optional<Edge>& close) const {
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
      Edge edge;
      for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
        if (inside[k] >= furthest_outside) continue;
        // Distances in the plane are this many times those of the line from the edge.
        const double ascent = element.inwards[k].dot(line);
        // Not std::hypot(), whose last bits are those of a C library.
        const double in_plane = std::sqrt(1 + squared(ascent / descent));
        is_near = is_near && inside[k] > -margin * in_plane;
        is_inside = is_inside && inside[k] >= -around_.round_off();
        if (!element.is_rim[k] || !(inside[k] < margin * in_plane)) continue;
        if (known && are_on_one_line(*known, element, k, 10 * around_.round_off())) continue;
        const Vec across = descent * element.inwards[k] - ascent * facet.normal;
        // A line that is almost parallel to the facet may come close to the edge beyond its ends.
        const double along_line = at - inside[k] * ascent / across.squaredNorm();
        if (!(along_line > 0 && along_line < 1)) continue;
        const Edge found{&element, k, inside[k] / in_plane, along_line,
                         (descent > 0 ? 1 : -1) / across.norm() * across};
        if (!is_closer(found, from, line, margin)) continue;
        is_at_rim = true;
        edge = found;
      }
      if (is_near && is_at_rim) {
        close = edge;
        return Passage::at_rim;
      }
      is_through = is_through || is_inside;
    }
    return is_through ? Passage::through : Passage::beside;
  }

  const NearbyFaces<Dim>& around_;
};

}  // namespace silt
