// SPDX-License-Identifier: MIT
// What a point sees of a surface that mirrors: a straight line that meets a face is reflected.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
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
    constexpr double cos_30 = 0.866;
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

  /// f(mirror, share_of) for each mirror that may show points as closer to x than the reach;
  /// share_of(point) is the share of the point's image, which is that close, that is seen from x.
  template <class F>
  void for_each_mirror(F&& f) const {
    if (empty()) return;
    if (is_plane()) {
      f(mirror_in((*surface_)[near_[0]]), [&](const Vec& point) { return is_before_plane(point); });
      return;
    }
    for (const Seen& seen : find_mirrors()) {
      f(seen.mirror, [&](const Vec& point) { return share_of_lines(point, seen.mirror); });
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
    std::ranges::sort(near_);
    is_plane_ = !near_.empty() && std::ranges::all_of(near_, [&](std::uint32_t k) {
      return surface[k].facet == surface[near_[0]].facet &&
             surface[k].distance_from_rim(x_) >= furthest();
    });
  }

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

  struct Seen {
    Mirror<Dim> mirror;
    Vec observer;         // x in the space of the points: the image of x in the inverse mirror
    const Element* last;  // before the points are reached; null if there is none
  };

  static Mirror<Dim> mirror_in(const Element& element) {
    const Vec& n = element.normal;
    return {Mirror<Dim>::Matrix::Identity() - 2 * n * n.transpose(), 2 * element.offset * n};
  }

  // Mirrors of mirrors, each once; between acute faces there is no end of them. A line shorter than
  // the reach meets faces closer than that only.
  std::vector<Seen>& find_mirrors() const {
    constexpr std::size_t max_mirrors = 256;
    static thread_local std::vector<Seen> mirrors;  // keeps its capacity
    mirrors.assign(1, {{}, x_, nullptr});
    for (std::size_t k = 0; k < mirrors.size(); ++k) {
      for (const std::uint32_t number : near_) {
        const Element& element = (*surface_)[number];
        if (mirrors.size() > max_mirrors) break;
        const Seen from = mirrors[k];
        const double height = element.height(from.observer);
        if (!(std::abs(height) < reach_ + margin()) || !is_before(element, from)) continue;
        const Vec observer = from.observer - (2 * height) * element.normal;
        const Mirror<Dim> mirror = from.mirror.after(mirror_in(element));
        const bool is_known = std::ranges::any_of(mirrors, [&](const Seen& seen) {
          return (seen.observer - observer).norm() < round_off() &&
                 (seen.mirror.rotation - mirror.rotation).norm() < round_off() / reach_;
        });
        if (!is_known) mirrors.push_back({mirror, observer, &element});
      }
    }
    mirrors.erase(mirrors.begin());
    return mirrors;
  }
  // Whether a face has a point on the side of the last mirror on which lines continue, and in the
  // cone of the lines from the mirrored observer through that mirror, also if they are shifted.
  bool is_before(const Element& element, const Seen& from) const {
    if (!from.last) return true;
    if (from.last->facet == element.facet) return false;
    const double side = from.last->height(from.observer) > 0 ? -1 : 1;
    const bool has_point_before = std::ranges::any_of(element.face.corners, [&](const Vec& corner) {
      return side * from.last->height(corner) > round_off();
    });
    return has_point_before && std::ranges::any_of(near_, [&](std::uint32_t number) {
      const Element& mirror = (*surface_)[number];
      return mirror.facet == from.last->facet && !is_beside(element.face, mirror.face, from.observer);
    });
  }
  // Whether a face is outside of the cone of lines from `observer` through another face, by more than
  // the shift of lines: beyond one of the planes through an edge (in 2D, the lines through an end).
  bool is_beside(const Face<Dim>& face, const Face<Dim>& other, const Vec& observer) const {
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      const Vec a = other.corners[k] - observer;
      Vec normal;
      if constexpr (Dim == 2) {
        normal = {-a[1], a[0]};
      } else {
        normal = cross(a, Vec(other.corners[(k + 1) % 3] - observer));
      }
      const double inside = normal.dot(other.corners[(k + Dim - 1) % Dim] - observer);
      if (inside < 0) normal = -normal;
      const double least = -2 * width() * normal.norm();
      if (std::ranges::all_of(face.corners, [&](const Vec& corner) {
            return normal.dot(corner - observer) < least;
          })) {
        return true;
      }
    }
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
  // closer to the rim of a face than this margin [m].
  Line line_between(Line line, double share, double margin) const {
    constexpr int max_reflections = 64;
    double along = -1;  // of its length
    const double close = margin / (line.end - line.begin).norm();
    const Element* last = nullptr;
    for (int k = 0; k < max_reflections; ++k) {
      const Element* first = nullptr;
      double nearest = 2;
      for (const std::uint32_t number : near_) {
        const Element& element = (*surface_)[number];
        if (last && element.facet == last->facet) continue;
        const double before = element.height(line.begin), behind = element.height(line.end);
        if ((before > 0) == (behind > 0)) continue;
        const Vec shift = share * line.shift;
        const double at = (before + element.normal.dot(shift)) / (before - behind);
        if (!(at > along - close) || !(at < nearest + close)) continue;
        const Passage passage =
            passage_of(element.face, line.begin + shift, line.end + shift, margin);
        if (passage == Passage::beside) continue;
        const bool is_at_other = std::abs(at - along) < close || std::abs(at - nearest) < close;
        if (passage == Passage::at_rim || is_at_other) {
          line.is_close_to_rim = true;
          return line;
        }
        nearest = at;
        first = &element;
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

  const Faces<Dim>* surface_ = nullptr;
  std::vector<std::uint32_t> near_;
  Vec x_ = Vec::Zero();
  double reach_ = 0;     // [m]
  double distance_ = 0;  // of x from the nearest face [m]
  bool is_plane_ = false;
};

}  // namespace silt
