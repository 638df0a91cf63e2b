// SPDX-License-Identifier: MIT
// What a point sees of a surface that mirrors: a straight line that meets a face is reflected.
#pragma once

#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
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

/// The part of a surface around a point.
template <int Dim>
class MirrorsAround {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;

  /// The faces closer to x than reach [m].
  void find(const Faces<Dim>& surface, const Vec& x, double reach) {
    elements_.clear();
    x_ = x;
    reach_ = reach;
    distance_ = std::numeric_limits<double>::infinity();
    static thread_local std::vector<std::uint32_t> near;  // keeps its capacity
    near.clear();
    surface.for_each_near(x, reach, [](std::uint32_t k) { near.push_back(k); });
    std::ranges::sort(near);
    for (const std::uint32_t k : near) {
      const Element& element = surface[k];
      if (!(std::abs(element.height(x)) < reach)) continue;
      const double distance = (nearest_of(element.face, x) - x).norm();
      if (!(distance < reach)) continue;
      distance_ = std::min(distance_, distance);
      elements_.push_back(element);
    }
    is_plane_ = !elements_.empty() && std::ranges::all_of(elements_, [&](const Element& element) {
      return element.facet == elements_[0].facet && element.distance_from_rim(x) >= reach;
    });
  }

  bool empty() const { return elements_.empty(); }
  /// Whether there is nothing but one plane.
  bool is_plane() const { return is_plane_; }

  /// The share of a point, closer than the reach, that is seen from x: 0 if a face is in between,
  /// else 1; 1/2 if the line to it goes through an edge, behind which something else is seen.
  double visible_share(const Vec& point) const {
    if (empty()) return 1;
    if (is_plane()) return is_before_plane(point);
    return share_of_lines(point, {}, [&](const Vec& from, const Vec& to, const auto&) {
      return std::ranges::none_of(
          elements_, [&](const Element& element) { return is_between_points(element, from, to); });
    });
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
      for (const Element& element : elements_) {
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
    const bool is_free = std::ranges::all_of(elements_, [&](const Element& element) {
      constexpr double round_off = 1e-9;
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
      f(mirror_in(elements_[0]), [&](const Vec& point) { return is_before_plane(point); });
      return;
    }
    const auto is_seen = [&](const Vec& from, const Vec& to, const Mirror<Dim>& mirror) {
      return (end_of_line(from, mirror(to)) - to).norm() < 1e-9 * reach_;
    };
    for (const Seen& seen : find_mirrors()) {
      f(seen.mirror, [&](const Vec& point) {
        return share_of_lines(point, seen.mirror, is_seen);
      });
    }
  }

  /// Distance of x from the nearest face [m]; infinite beyond the reach.
  double distance() const { return distance_; }

 private:
  double distance_from(const Element& element) const {
    return (x_ - nearest_of(element.face, x_)).norm();
  }
  static bool is_between_points(const Element& element, const Vec& from, const Vec& to) {
    return (element.height(from) > 0) != (element.height(to) > 0) &&
           meets_line(element.face, from, to);
  }
  // The same for the lines on both sides of this one, in case that it goes through an edge.
  bool is_between(const Element& element, const Vec& from, const Vec& to) const {
    const Shifts shift = shifts();
    return is_between_points(element, from + shift.begin, to + shift.end) ||
           is_between_points(element, from - shift.begin, to - shift.end);
  }

  struct Shifts {
    Vec begin;
    Vec end;
  };
  // In no special direction.
  Shifts shifts() const {
    static constexpr double begin[] = {0.61e-6, 0.33e-6, 0.17e-6};
    static constexpr double end[] = {0.29e-6, -0.43e-6, 0.71e-6};
    Shifts shifts;
    for (int k = 0; k < Dim; ++k) {
      shifts.begin[k] = begin[k] * reach_;
      shifts.end[k] = end[k] * reach_;
    }
    return shifts;
  }

  // Lines through edges and corners of the surface would meet none or several of its faces: they
  // are shifted to both sides. The line from a point to x gives the same as that from x to it.
  template <class IsSeen>
  double share_of_lines(const Vec& point, const Mirror<Dim>& mirror, const IsSeen& is_seen) const {
    const Shifts shift = shifts();
    const bool is_reversed =
        std::lexicographical_compare(point.begin(), point.end(), x_.begin(), x_.end());
    const Vec& from = is_reversed ? point : x_;
    const Vec& to = is_reversed ? x_ : point;
    const Mirror<Dim> through = is_reversed ? mirror.inverse() : mirror;
    return 0.5 * (double(is_seen(from + shift.begin, to + shift.end, through)) +
                  double(is_seen(from - shift.begin, to - shift.end, through)));
  }
  bool is_before_plane(const Vec& point) const {
    return (elements_[0].height(x_) > 0) == (elements_[0].height(point) > 0);
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
      for (const Element& element : elements_) {
        if (mirrors.size() > max_mirrors) break;
        const Seen from = mirrors[k];
        const double height = element.height(from.observer);
        if (!(std::abs(height) < reach_) || !is_before(element, from)) continue;
        const Vec observer = from.observer - (2 * height) * element.normal;
        const Mirror<Dim> mirror = from.mirror.after(mirror_in(element));
        const bool is_known = std::ranges::any_of(mirrors, [&](const Seen& seen) {
          return (seen.observer - observer).norm() < 1e-9 * reach_ &&
                 (seen.mirror.rotation - mirror.rotation).norm() < 1e-9;
        });
        if (!is_known) mirrors.push_back({mirror, observer, &element});
      }
    }
    mirrors.erase(mirrors.begin());
    return mirrors;
  }
  // Whether a face has a point on the side of the last mirror on which lines continue.
  bool is_before(const Element& element, const Seen& from) const {
    if (!from.last) return true;
    if (from.last->facet == element.facet) return false;
    const double side = from.last->height(from.observer) > 0 ? -1 : 1;
    return std::ranges::any_of(element.face.corners, [&](const Vec& corner) {
      return side * from.last->height(corner) > 1e-9 * reach_;
    });
  }

  // The end of the line from p to q that is reflected where it meets faces. Instead of the rest of
  // the line, the whole of it is mirrored.
  Vec end_of_line(Vec p, Vec q) const {
    constexpr int max_reflections = 64;
    double along = 0;
    const Element* last = nullptr;
    for (int k = 0; k < max_reflections; ++k) {
      const Element* first = nullptr;
      double nearest = 1;
      for (const Element& element : elements_) {
        if (last && element.facet == last->facet) continue;
        const double before = element.height(p), behind = element.height(q);
        if ((before > 0) == (behind > 0)) continue;
        const double at = before / (before - behind);
        if (!(at > along) || !(at < nearest) || !meets_line(element.face, p, q)) continue;
        nearest = at;
        first = &element;
      }
      if (!first) return q;
      p -= (2 * first->height(p)) * first->normal;
      q -= (2 * first->height(q)) * first->normal;
      along = nearest;
      last = first;
    }
    return q;
  }

  std::vector<Element> elements_;
  Vec x_ = Vec::Zero();
  double reach_ = 0;     // [m]
  double distance_ = 0;  // of x from the nearest face [m]
  bool is_plane_ = false;
};

}  // namespace silt
