// SPDX-License-Identifier: MIT
// The faces of a surface near a point, and moves of the point that end before them.
#pragma once

#include <silt/core/buffer.hpp>
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
#include <utility>

namespace silt {

/// The part of a surface around a point x. Refers to the surface.
template <int Dim>
class NearbyFaces {
 public:
  using Vec = silt::Vec<Dim>;
  using Element = typename Faces<Dim>::Element;

  /// The part of a facet near x, in the plane normal·x = offset: `normal` is a unit vector [-],
  /// `offset` [m].
  struct NearFacet {
    Vec normal;
    double offset;
    std::uint32_t first, end;  ///< of its faces in faces()
    /// 1 or −1: the sign of the height on the side of the faces that may be seen, as they are of a
    /// closed surface, and x is outside of it or inside; 0: both sides may be.
    int side = 0;

    /// Signed distance from the plane [m].
    double height(const Vec& x) const { return normal.dot(x) - offset; }
  };

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
  /// find() of each of these for one of the points, which are best close to each other: what they
  /// have in common is found once.
  template <class Around>
  static void find_all(const Faces<Dim>& surface, std::span<const Vec> points, double reach,
                       std::span<Around> found) {
    if (points.empty()) return;
    typename Faces<Dim>::Bounds bounds{points[0], points[0]};
    for (const Vec& x : points) bounds.enclose({x, x});
    std::array<std::uint32_t, 16> candidates;
    std::size_t number = 0;
    surface.for_each_near(bounds, furthest_for(reach), [&](std::uint32_t k) {
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

  /// Refers to a copy of the surface from now on.
  void refer_to(const Faces<Dim>& surface) { surface_ = &surface; }

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
  const Element& operator[](std::uint32_t face) const { return (*surface_)[face]; }
  /// Unless they are one plane.
  std::span<const NearFacet> facets() const { return facets_; }
  /// The numbers of the faces of the facet that are near x.
  std::span<const std::uint32_t> faces_of(const NearFacet& facet) const {
    return faces().subspan(facet.first, facet.end - facet.first);
  }
  /// The whole surface.
  const Faces<Dim>& surface() const { return *surface_; }
  /// The point x [m].
  const Vec& x() const { return x_; }
  double reach() const { return reach_; }  ///< [m]

  /// A move of x, with the clearance shorter than the reach, that ends no closer to a face than this
  /// clearance [m], or than x is: where the given move would, the rest of it is along the face. Zero
  /// where faces leave no such move.
  Vec before_faces(const Vec& move, double clearance) const {
    if (distance_ - move.norm() - furthest_move_of_faces() >= clearance) return move;
    constexpr int max_faces = 3;  // those that meet in a corner are left one after another
    Vec end = x_ + move;
    bool is_changed = false;
    for (int k = 0; k < max_faces; ++k) {
      for (const std::uint32_t number : near_) {
        const Element& element = (*surface_)[number];
        // The end, as seen from the face.
        const Vec at = before_step_of(element, end);
        const Vec from_face = at - nearest_of(element.face, at);
        const double distance = from_face.norm();
        const double least = std::min(clearance, distance_from(element));
        const double before = element.height(x_), behind = element.height(at);
        Vec further;
        if (is_between(element, x_, at)) {
          further = ((before > 0 ? least : -least) - behind) * element.normal;
        } else if (distance < least && distance > 0) {
          further = (least / distance - 1) * from_face;
        } else {
          continue;
        }
        end = element.group > 0 ? after_step_of(element, Vec(at + further)) : Vec(end + further);
        is_changed = true;
      }
    }
    if (!is_changed) return move;
    const bool is_free = std::ranges::all_of(near_, [&](std::uint32_t number) {
      constexpr double round_off = 1e-9;
      const Element& element = (*surface_)[number];
      const Vec at = before_step_of(element, end);
      return !is_between(element, x_, at) &&
             (at - nearest_of(element.face, at)).norm() >=
                 (1 - round_off) * std::min(clearance, distance_from(element));
    });
    return is_free ? Vec(end - x_) : Vec(Vec::Zero());
  }
  /// Whether a move of x to `end` [m] goes through a face that moves meanwhile: the number of the
  /// face, or that of all faces if there is none.
  std::uint32_t face_passed(const Vec& end) const {
    for (const std::uint32_t number : near_) {
      const Element& element = (*surface_)[number];
      if (is_between(element, x_, before_step_of(element, end))) return number;
    }
    return static_cast<std::uint32_t>(surface_->elements().size());
  }

  /// f(normal, height, group) for the plane of every facet that has a point straight below x: its
  /// normal towards x, the distance of x from it [m], and the group of its faces.
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
      f(height > 0 ? element.normal : Vec(-element.normal), std::abs(height), element.group);
    }
  }

  /// Distance of x from the nearest face [m]; infinite if none was found.
  double distance() const { return distance_; }

  // Lengths [m] of lines that are seen: see SharesOfLines.

  /// Round-off of positions [m], also beside faces of a thousand kilometres.
  double round_off() const { return 1e-7 * reach_; }
  /// Width of the lines for a share [m]: less than the usual distance of fluid from a wall.
  double width() const { return width_for(reach_); }
  /// Longer than the shifts of these lines [m].
  double margin() const { return margin_for(reach_); }
  /// Distance of the furthest faces that these lines meet [m].
  double furthest() const { return furthest_for(reach_); }

 private:
  static constexpr double cos_30 = 0.866;

  // Where a point at the end of the step would be if it moved with a face, at its beginning, and
  // the other way round [m].
  Vec before_step_of(const Element& element, const Vec& end) const {
    return element.group > 0 ? surface_->step_of(element.group).move.X_of(end) : end;
  }
  Vec after_step_of(const Element& element, const Vec& begin) const {
    return surface_->step_of(element.group).move.x_of(begin);
  }
  // Of their points as close to x as furthest() [m].
  double furthest_move_of_faces() const {
    double furthest_move = 0;
    if (!surface_->move()) return furthest_move;
    for (const std::uint32_t number : near_) {
      const std::uint32_t group = (*surface_)[number].group;
      if (group == 0) continue;
      const Pose<Dim>& move = surface_->step_of(group).move;
      const Eigen::Matrix<double, Dim, Dim> turn =
          move.rotation - Eigen::Matrix<double, Dim, Dim>::Identity();
      furthest_move =
          std::max(furthest_move, (move.x_of(x_) - x_).norm() + turn.norm() * furthest());
    }
    return furthest_move;
  }

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
    find_sides();
  }
  // On which side of closed surfaces x is.
  void find_sides() {
    const Faces<Dim>& surface = *surface_;
    std::uint32_t last = 0;  // surface, whose side is known
    int side_of_last = 0;
    for (NearFacet& facet : facets_) {
      for (std::uint32_t n = facet.first; n < facet.end; ++n) {
        const Element& element = surface[near_[n]];
        if (element.closed_surface != last) {
          last = element.closed_surface;
          side_of_last = last > 0 ? side_of(last) : 0;
        }
        const int side = facet.normal.dot(element.normal) > 0 ? side_of_last : -side_of_last;
        facet.side = n == facet.first || facet.side == side ? side : 0;
        if (facet.side == 0) break;
      }
    }
  }
  // Of the normals of a closed surface: that of its faces that are nearest to x, if they agree.
  int side_of(std::uint32_t closed_surface) const {
    double least = std::numeric_limits<double>::infinity();
    bool is_above = false, is_below = false;
    for (const std::uint32_t k : near_) {
      const Element& element = (*surface_)[k];
      if (element.closed_surface != closed_surface) continue;
      const double distance = distance_from(element);
      if (distance < least - round_off()) is_above = is_below = false;
      if (distance < least + round_off()) (element.height(x_) > 0 ? is_above : is_below) = true;
      least = std::min(least, distance);
    }
    return is_above == is_below ? 0 : is_above ? 1 : -1;
  }

  static double width_for(double reach) { return 0.05 * reach; }
  static double margin_for(double reach) { return 0.75 * width_for(reach); }
  static double furthest_for(double reach) { return reach + margin_for(reach); }
  bool is_between(const Element& element, const Vec& from, const Vec& to) const {
    const double before = element.height(from), after = element.height(to);
    if ((before > 0) == (after > 0)) return false;
    const Passage passage = passage_of(element.face, from, to, round_off());
    if (passage != Passage::at_rim) return passage == Passage::through;
    // The line of an edge goes on beyond it.
    const Vec crossing = from + before / (before - after) * (to - from);
    return (crossing - nearest_of(element.face, crossing)).norm() <= round_off();
  }

  const Faces<Dim>* surface_ = nullptr;
  Buffer<std::uint32_t> near_;   // facet by facet
  Buffer<NearFacet> facets_;     // unless they are one plane
  Vec x_ = Vec::Zero();
  double reach_ = 0;     // [m]
  double distance_ = 0;  // of x from the nearest face [m]
  bool is_plane_ = false;
};

}  // namespace silt
