// SPDX-License-Identifier: MIT
// What a point sees of a surface that mirrors: a straight line that meets a face is reflected.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/beams.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

namespace silt {

/// The map of points to their images, x → R x + t.
template <int Dim>
struct Mirror {
  using Vec = silt::Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  Matrix rotation = Matrix::Identity();  ///< R, a reflection or a rotation
  Vec translation = Vec::Zero();         ///< t [m]

  Vec operator()(const Vec& x) const { return multiply<Dim, double>(rotation, x) + translation; }
  Mirror inverse() const {
    const Matrix back = rotation.transpose();
    return {back, -multiply<Dim, double>(back, translation)};
  }
  /// x → this(first(x))
  Mirror after(const Mirror& first) const {
    Mirror both{.translation = (*this)(first.translation)};
    for (int k = 0; k < Dim; ++k) {
      both.rotation.col(k) = multiply<Dim, double>(rotation, first.rotation.col(k));
    }
    return both;
  }
};

/// The part of a surface around a point. Refers to the surface.
template <int Dim>
class MirrorsAround {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;

  /// The faces closer to x than reach [m], and somewhat further ones.
  void find(const Faces<Dim>& surface, const Vec& x, double reach) {
    begin(surface, x, reach);
    surface.for_each_near(x, furthest(), [&](std::uint32_t k) { add_if_near(k); });
    end();
  }
  /// The same if they are known to be among these.
  void find(const Faces<Dim>& surface, const Vec& x, double reach,
            std::span<const std::uint32_t> candidates) {
    begin(surface, x, reach);
    for (const std::uint32_t k : candidates) add_if_near(k);
    end();
  }
  /// find() for each of the points of some size, which are best close to each other: what they have in
  /// common is found once.
  static void find_all(const Faces<Dim>& surface, std::span<const Vec> points, double reach,
                       std::span<MirrorsAround> found) {
    if (points.empty()) return;
    typename Faces<Dim>::Bounds bounds{points[0], points[0]};
    for (const Vec& x : points) bounds.enclose({x, x});
    std::array<std::uint32_t, 16> candidates;
    std::size_t number = 0;
    surface.for_each_near_bounds(bounds, furthest_for(reach), [&](std::uint32_t k) {
      if (number < candidates.size()) candidates[number] = k;
      ++number;
    });
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (number <= candidates.size()) {
        found[k].find(surface, points[k], reach, std::span(candidates).first(number));
      } else {
        found[k].find(surface, points[k], reach);
      }
    }
  }

  bool empty() const { return near_.empty(); }
  /// Whether there is nothing but one plane.
  bool is_plane() const { return is_plane_; }
  /// Whether there is an edge at which a face turns away from x, by more than 30°.
  bool has_protruding_edge() const {
    if (is_plane_) return false;
    const auto towards_x = [&](const Element& element) {
      return element.height(x_) > 0 ? element.normal : Vec(-element.normal);
    };
    for (const std::uint32_t k : near_) {
      const Element& one = (*surface_)[k];
      const Vec normal = towards_x(one);
      for (const std::uint32_t m : near_) {
        const Element& other = (*surface_)[m];
        if (other.facet == one.facet || normal.dot(towards_x(other)) > cos_30) continue;
        for (const Vec& corner : other.face.corners) {
          if (normal.dot(corner - one.face.corners[0]) < -margin()) return true;
        }
      }
    }
    return false;
  }
  /// Whether all faces are parallel or at right angles to each other.
  bool has_right_angles_only() const {
    if (is_plane_) return true;
    constexpr double round_off = 1e-6;
    return std::ranges::all_of(near_, [&](std::uint32_t k) {
      return std::ranges::all_of(near_, [&](std::uint32_t m) {
        const double cosine = std::abs((*surface_)[k].normal.dot((*surface_)[m].normal));
        return cosine < round_off || cosine > 1 - round_off;
      });
    });
  }
  /// The numbers of the faces.
  std::span<const std::uint32_t> faces() const { return near_; }

  /// The share of a point, closer than the reach, that is seen from x: 0 if a face is in between,
  /// else 1; the share of the lines close to it if it goes through an edge, behind which something
  /// else is seen.
  double visible_share(const Vec& point) const {
    if (empty()) return 1;
    if (is_plane()) return is_before_plane(point);
    return share_of_lines(point, {});
  }

  /// A move of x, shorter than the reach, that ends no closer to a face than this clearance [m], or
  /// than x is: where the given move would, the rest of it is along the face. Zero where faces
  /// leave no such move.
  Vec before_faces(const Vec& move, double clearance) const {
    if (distance_ - move.norm() >= clearance) return move;
    constexpr int max_faces = 3;  // those that meet in a corner are left one after another
    Vec end = x_ + move;
    bool is_changed = false;
    for (int k = 0; k < max_faces; ++k) {
      for (const std::uint32_t number : near_) {
        const Element& element = (*surface_)[number];
        const Vec from_face = end - nearest_of(element.face, end);
        const double distance = from_face.norm();
        const double least = std::min(clearance, distance_from(element));
        const double before = element.height(x_), behind = element.height(end);
        if (is_between(element, x_, end)) {
          end += ((before > 0 ? least : -least) - behind) * element.normal;
        } else if (distance < least && distance > 0) {
          end += (least / distance - 1) * from_face;
        } else {
          continue;
        }
        is_changed = true;
      }
    }
    if (!is_changed) return move;
    const bool is_free = std::ranges::all_of(near_, [&](std::uint32_t number) {
      constexpr double round_off = 1e-9;
      const Element& element = (*surface_)[number];
      return !is_between(element, x_, end) &&
             (end - nearest_of(element.face, end)).norm() >=
                 (1 - round_off) * std::min(clearance, distance_from(element));
    });
    return is_free ? Vec(end - x_) : Vec(Vec::Zero());
  }

  /// f(mirror, share_of) for each mirror that may show one of the points as closer to x than the reach;
  /// share_of(point) is the share of the point's image, which is that close, that is seen from x.
  template <class F>
  void for_each_mirror(std::span<const Vec> points, F&& f) const {
    if (empty()) return;
    if (is_plane()) {
      const Element& plane = (*surface_)[near_[0]];
      f(mirror_in(plane.normal, plane.offset), [&](const Vec& point) { return is_before_plane(point); });
      return;
    }
    const Search& search = find_mirrors(points);
    for (std::size_t k = 1; k < search.seen.size(); ++k) {
      const Seen& seen = search.seen[k];
      if (seen.is_known || !seen.shows_points) continue;
      f(seen.mirror, [&](const Vec& point) {
        return is_in_beam(search, k, point) ? share_of_lines(point, seen.mirror) : 0;
      });
    }
  }

  /// f(normal, height) for the plane of every facet that has a point straight below x: its normal
  /// towards x, and the distance of x from it [m].
  template <class F>
  void for_each_plane_below(F&& f) const {
    for (std::size_t k = 0; k < near_.size(); ++k) {
      const Element& element = (*surface_)[near_[k]];
      const double height = element.height(x_);
      const auto is_below = [&](const Element& other) {
        return distance_from(other) < std::abs(other.height(x_)) + round_off();
      };
      if (!is_below(element)) continue;
      // Its faces may have a common point there.
      const bool is_known = std::any_of(near_.begin(), near_.begin() + std::ptrdiff_t(k),
                                        [&](std::uint32_t number) {
                                          const Element& other = (*surface_)[number];
                                          return other.facet == element.facet && is_below(other);
                                        });
      if (is_known) continue;
      f(height > 0 ? element.normal : Vec(-element.normal), std::abs(height));
    }
  }

  /// Distance of x from the nearest face [m]; infinite beyond the reach.
  double distance() const { return distance_; }

 private:
  double distance_from(const Element& element) const {
    return (x_ - nearest_of(element.face, x_)).norm();
  }
  void begin(const Faces<Dim>& surface, const Vec& x, double reach) {
    near_.clear();
    facets_.clear();
    surface_ = &surface;
    x_ = x;
    reach_ = reach;
    distance_ = std::numeric_limits<double>::infinity();
  }
  void add_if_near(std::uint32_t k) {
    const Element& element = (*surface_)[k];
    if (!(std::abs(element.height(x_)) < furthest())) return;
    const double distance = (nearest_of(element.face, x_) - x_).norm();
    if (!(distance < furthest())) return;
    distance_ = std::min(distance_, distance);
    near_.push_back(k);
  }
  void end() {
    const Faces<Dim>& surface = *surface_;
    const auto facet_of = [&](std::uint32_t k) { return surface[k].facet; };
    std::ranges::sort(near_, [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(facet_of(a), a) < std::pair(facet_of(b), b);
    });
    is_plane_ = !near_.empty() && std::ranges::all_of(near_, [&](std::uint32_t k) {
      return surface[k].facet == surface[near_[0]].facet &&
             surface[k].distance_from_rim(x_) >= furthest();
    });
    if (is_plane_) return;
    for (std::uint32_t first = 0, end = 0; first < near_.size(); first = end) {
      while (end < near_.size() && facet_of(near_[end]) == facet_of(near_[first])) ++end;
      const Element& element = surface[near_[first]];
      facets_.push_back({element.normal, element.offset, first, end});
    }
  }

  static constexpr double cos_30 = 0.866;

  double round_off() const { return 1e-7 * reach_; }  // also beside faces of a thousand kilometres
  // Of the lines for a share [m]: less than the usual distance of fluid from a wall.
  double width() const { return width_for(reach_); }
  double margin() const { return margin_for(reach_); }  // longer than their shifts
  double furthest() const { return furthest_for(reach_); }
  static double width_for(double reach) { return 0.05 * reach; }
  static double margin_for(double reach) { return 0.75 * width_for(reach); }
  static double furthest_for(double reach) { return reach + margin_for(reach); }
  bool is_between(const Element& element, const Vec& from, const Vec& to) const {
    return (element.height(from) > 0) != (element.height(to) > 0) &&
           passage_of(element.face, from, to, round_off()) != Passage::beside;
  }
  bool is_before_plane(const Vec& point) const {
    const Element& plane = (*surface_)[near_[0]];
    return (plane.height(x_) > 0) == (plane.height(point) > 0);
  }

  // The share of lines around the one from x to the image of the point, shifted in all directions
  // alike, so that the shares of all that is seen in this direction sum to 1 also beside edges and
  // corners of the surface. A share changes in small steps when points move. The same from the
  // point to the image of x.
  double share_of_lines(const Vec& point, const Mirror<Dim>& mirror) const {
    const bool is_reversed =
        std::lexicographical_compare(point.begin(), point.end(), x_.begin(), x_.end());
    const Vec& from = is_reversed ? point : x_;
    const Vec& to = is_reversed ? x_ : point;
    const Mirror<Dim> through = is_reversed ? mirror.inverse() : mirror;
    const Mirror<Dim> back = through.inverse();
    const Vec image = through(to);
    // Whether the line with this shift leads to the image: to the point, through this mirror.
    const auto leads_there = [&](const Line& line, const Vec& shift) {
      return is_same(line, {back(from), to, multiply<Dim, double>(back.rotation, shift)});
    };
    const Vec first = shift_of(0);
    const Line line = line_between({from, image, first}, 0, margin());
    if (!line.is_close_to_rim) return leads_there(line, first);
    int seen = 0;
    for (int k = 0; k < 8; ++k) {
      const Vec shift = shift_of(k);
      seen += leads_there(line_between({from, image, shift}, 1, 0), shift);
    }
    return seen / 8.0;
  }

  // Eight shifts, with all signs; in 2D of two sizes.
  Vec shift_of(int k) const {
    static constexpr double sizes[] = {0.61, 0.33, 0.17};  // in no special direction
    Vec shift = Vec::Zero();
    for (int axis = 0; axis < Dim; ++axis) {
      const double sign = (k >> axis) % 2 == 0 ? 1 : -1;
      shift += sign * sizes[axis] * surface_->axes().col(axis);
    }
    return width() / (1 + (k >> Dim)) * shift;
  }

  // The part of a facet near x.
  struct NearFacet {
    Vec normal;
    double offset;
    std::uint32_t first, end;  // of its faces in near_

    double height(const Vec& x) const { return normal.dot(x) - offset; }
  };
  std::span<const std::uint32_t> faces_of(const NearFacet& facet) const {
    return std::span(near_).subspan(facet.first, facet.end - facet.first);
  }

  struct Seen {
    Mirror<Dim> mirror;
    Vec observer;  // x in the space of the points: the image of x in the inverse mirror
    const NearFacet* last = nullptr;      // before the points are reached; null if there is none
    typename Beams<Dim>::Beam beam = {};  // of the lines that have passed it
    std::uint32_t next = 0;               // the next way to the same mirror; 0: none
    bool is_known = false;                // a further way to another one
    bool shows_points = true;             // may show one
  };
  struct Search {
    std::vector<Seen> seen;
    Beams<Dim> beams;
    // Of the points that are closest to the plane of each facet, on its two sides [m].
    std::vector<std::array<double, 2>> least_heights;
  };

  static Mirror<Dim> mirror_in(const Vec& n, double offset) {
    return {Mirror<Dim>::Matrix::Identity() - 2 * n * n.transpose(), 2 * offset * n};
  }

  // Mirrors of mirrors, each once; between acute faces there is no end of them. A line shorter than
  // the reach meets faces closer than that only.
  const Search& find_mirrors(std::span<const Vec> points) const {
    constexpr std::size_t max_mirrors = 256;
    static thread_local Search search;  // keeps its capacity
    auto& seen = search.seen;
    search.beams.clear();
    find_least_heights(search, points);
    seen.assign(1, {{}, x_});
    std::size_t mirrors = 0;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (seen[k].is_known) continue;
      for (const NearFacet& facet : facets_) {
        if (mirrors >= max_mirrors) break;
        const Seen& from = seen[k];
        const double height = facet.height(from.observer);
        if (!(std::abs(height) < furthest())) continue;
        const double most = furthest_that_shows(search, facet, height);
        // From one face to the next one of a curved surface go only lines that are almost parallel to
        // it, and lead to no point.
        const bool is_next = from.last && std::abs(from.last->normal.dot(facet.normal)) > cos_30;
        if (is_next && (!from.shows_points || !(std::abs(height) < most))) continue;
        const double distance = distance_after(search, k, facet, is_next ? most : furthest());
        if (!(distance < furthest())) continue;
        Seen next{from.mirror.after(mirror_in(facet.normal, facet.offset)),
                  from.observer - (2 * height) * facet.normal, &facet};
        next.shows_points = distance < most;
        next.beam = search.beams.through(
            faces_of(facet), [&](std::uint32_t face) -> const Element& { return (*surface_)[face]; },
            next.observer, -height, margin(),
            from.next == 0 ? from.beam : typename Beams<Dim>::Beam{});
        const auto same = std::find_if(seen.begin(), seen.end(), [&](const Seen& other) {
          return !other.is_known && (other.observer - next.observer).norm() < round_off() &&
                 (other.mirror.rotation - next.mirror.rotation).norm() < round_off() / reach_;
        });
        if (same == seen.end()) {
          ++mirrors;
        } else {
          next.is_known = true;
          next.next = same->next;
          same->shows_points = same->shows_points || next.shows_points;
          same->next = static_cast<std::uint32_t>(seen.size());
        }
        seen.push_back(next);
      }
    }
    return search;
  }
  // Few facets are seen sooner than heights are found.
  void find_least_heights(Search& search, std::span<const Vec> points) const {
    constexpr std::size_t few = 3;
    search.least_heights.clear();
    if (facets_.size() <= few) return;
    for (const NearFacet& facet : facets_) {
      double above = std::numeric_limits<double>::infinity(), below = above;
      for (const Vec& point : points) {
        const double height = facet.height(point);
        above = std::min(above, height > 0 ? height : above);
        below = std::min(below, height > 0 ? below : -height);
      }
      search.least_heights.push_back({above, below});
    }
  }
  // The largest distance from the observer, at this height above a facet, at which a line through it
  // that is as long as the reach still comes to the height of a point on the other side.
  double furthest_that_shows(const Search& search, const NearFacet& facet, double height) const {
    if (search.least_heights.empty()) return furthest();
    const auto number = static_cast<std::size_t>(&facet - facets_.data());
    const double least = search.least_heights[number][height > 0 ? 0 : 1];
    const double above = std::abs(height) + margin();
    return furthest() * above / (above + least);
  }
  // From the observer in a mirror to the nearest of the faces of a facet that lines may meet after it
  // [m]; infinite if there is none closer than `most`. All ways to that mirror are known: as straight
  // lines, they go through as many facets.
  double distance_after(const Search& search, std::size_t mirror, const NearFacet& facet,
                        double most) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t number : faces_of(facet)) {
      const Element& element = (*surface_)[number];
      const Vec& observer = search.seen[mirror].observer;
      std::size_t way = mirror;
      do {
        if (is_before(search, element.face, search.seen[way], most)) {
          least = std::min(least, (nearest_of(element.face, observer) - observer).norm());
          break;
        }
        way = search.seen[way].next;
      } while (way > 0);
    }
    return least < most ? least : std::numeric_limits<double>::infinity();
  }
  // Whether lines that have passed a mirror may meet a face, also if they are shifted.
  bool is_before(const Search& search, const Face<Dim>& face, const Seen& from, double most) const {
    if (!from.last) return true;
    const double side = from.last->height(from.observer) > 0 ? -1 : 1;
    const bool has_point_before = std::ranges::any_of(face.corners, [&](const Vec& corner) {
      return side * from.last->height(corner) > round_off();
    });
    return has_point_before && search.beams.may_meet(from.beam, face, most);
  }
  // Whether a point may be seen in a mirror: in one of the ways that lead to it.
  static bool is_in_beam(const Search& search, std::size_t mirror, const Vec& point) {
    do {
      if (search.beams.contains(search.seen[mirror].beam, point)) return true;
      mirror = search.seen[mirror].next;
    } while (mirror > 0);
    return false;
  }

  // A line that is reflected where it meets faces: its last part, extended back to its length.
  struct Line {
    Vec begin;
    Vec end;
    Vec shift;  // of the line where it passes faces; its ends stay before them
    bool is_close_to_rim = false;
  };
  bool is_same(const Line& one, const Line& other) const {
    return (one.end - other.end).norm() < round_off() &&
           (one.begin - other.begin).norm() < round_off() &&
           (one.shift - other.shift).norm() < round_off();
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
      for (const NearFacet& facet : facets_) {
        if (&facet == last) continue;
        const double before = facet.height(line.begin), behind = facet.height(line.end);
        if ((before > 0) == (behind > 0)) continue;
        const double at = (before + facet.normal.dot(shift)) / (before - behind);
        if (!(at > along - close) || !(at < nearest + close)) continue;
        const Passage passage = passage_of_facet(facet, line.begin + shift, line.end + shift, at, margin);
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
    const double furthest_outside = margin * line.norm() / std::abs(descent) + round_off();
    bool is_through = false;
    for (const std::uint32_t number : faces_of(facet)) {
      const Element& element = (*surface_)[number];
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
        is_inside = is_inside && inside[k] >= -round_off();
      }
      if (is_near && is_at_rim) return Passage::at_rim;
      is_through = is_through || is_inside;
    }
    return is_through ? Passage::through : Passage::beside;
  }

  const Faces<Dim>* surface_ = nullptr;
  std::vector<std::uint32_t> near_;  // facet by facet
  std::vector<NearFacet> facets_;     // unless they are one plane
  Vec x_ = Vec::Zero();
  double reach_ = 0;     // [m]
  double distance_ = 0;  // of x from the nearest face [m]
  bool is_plane_ = false;
};

}  // namespace silt
