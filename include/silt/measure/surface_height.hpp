// SPDX-License-Identifier: MIT
// The height of the surface of a fluid at a place.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/line_of_sight.hpp>
#include <silt/geometry/sight.hpp>
#include <silt/measure/wall_group.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace silt {

namespace detail {

/// The quadratic B-spline B(s), of width 3: its shifts by whole numbers add to 1, so that sums over
/// a lattice with the spacing 1 do not depend on where it is.
inline double b_spline(double s) {
  s = std::abs(s);
  if (s < 0.5) return 0.75 - s * s;
  return s < 1.5 ? squared(1.5 - s) / 2 : 0;
}
/// Its integral from −∞ to s.
inline double integral_of_b_spline(double s) {
  const double t = std::min(std::abs(s), 1.5);
  const double half = t < 0.5 ? 0.75 * t - t * t * t / 3 : 0.5 - (1.5 - t) * squared(1.5 - t) / 6;
  return s < 0 ? 0.5 - half : 0.5 + half;
}

}  // namespace detail

/// The height of the highest surface of the fluid on a vertical line: the last axis points up. It
/// is the level at which the share of volume filled by fluid around it is that of the room below
/// it,
///
///   Σ_j w(x_j − x) V = ∫ w(x' − x) dV' over the room below,   V = l0^Dim,
///
/// a half in the open. w is a product of quadratic B-splines, of which the horizontal ones are 6
/// spacings wide and the vertical one 3. Fluid and room are those in sight of the line,
/// horizontally; and between the next faces on the line. Spray does not count, where it does not
/// fill half of the width.
template <int Dim>
struct SurfaceHeight {
  Vec<Dim> point = Vec<Dim>::Zero();  ///< any point of the line, beside walls, not in them [m]
  double spacing = 0;                 ///< l0 [m]
  double lowest = -std::numeric_limits<double>::infinity();  ///< of the surface [m]
  /// Of the surface: fluid above is left out [m].
  double highest = std::numeric_limits<double>::infinity();
  /// The point is given where these walls are defined, and moves with them.
  WallGroup moves_with = {};

  /// The height [m]; NaN at a dry place. At a wall, the fluid on the side on which there is more of
  /// it counts. Of particles that processes share, all call it. Throws if the point is not finite,
  /// the spacing not positive, or `highest` not above `lowest`.
  template <class Sim>
  double read(const Sim& simulation) const {
    static_assert(detail::has_walls_of_faces<Sim>,
                  "silt::SurfaceHeight: read(simulation) is for a flow whose walls are faces; with "
                  "walls of particles, pass is_fluid(j) as well");
    return read(simulation, [](Index) { return true; });
  }
  /// The same of the particles for which is_fluid(j) is true. Without walls of faces, the line is
  /// three spacings or more away from other walls. Throws also if moves_with is given then.
  template <class Sim, std::predicate<Index> IsFluid>
  double read(const Sim& simulation, IsFluid&& is_fluid) const {
    using P = std::remove_cvref_t<decltype(simulation.particles())>;
    static_assert(P::dimension == Dim, "silt::SurfaceHeight: the particles have another dimension");
    check();
    Vec<Dim> x = point;
    if constexpr (detail::has_walls_of_faces<Sim>) {
      const detail::WallsNow<Dim> walls(simulation);
      x = walls.pose_of(moves_with.template number_in<Dim>(simulation, "SurfaceHeight")).x_of(x);
      return Line(*this, x, simulation.particles(), is_fluid, &walls).height();
    } else {
      if (!moves_with.is_at_rest()) {
        fail("SurfaceHeight: moves_with needs a flow whose walls are faces; leave it out");
      }
      return Line(*this, x, simulation.particles(), is_fluid, nullptr).height();
    }
  }

  /// For a file: see CsvSeries.
  std::vector<std::string> columns() const { return {"height"}; }
  /// What the numbers of a row are.
  std::string filter() const {
    return message_of({"height of the surface [m] at ", to_text(point), " m",
                       moves_with.is_at_rest() ? "" : ", which moves with walls", ", spacing ",
                       spacing, " m: where fluid fills as much of a spline ", 2 * reach * width,
                       " spacings wide and ", 2 * reach,
                       " high as there is room below; no average in time"});
  }
  /// The height [m]. Throws as read().
  template <class Sim>
  std::vector<double> row(const Sim& simulation) const {
    return {read(simulation)};
  }

 private:
  static constexpr int up = Dim - 1;
  static constexpr double width = 2;    // of horizontal splines, spacings per unit
  static constexpr double reach = 1.5;  // of a spline
  static constexpr Index levels_per_spacing = 8;

  void check() const {
    require_finite("SurfaceHeight: point", point);
    require_positive("SurfaceHeight: spacing", spacing);
    if (std::isnan(lowest) || std::isnan(highest)) {
      fail("SurfaceHeight: lowest or highest is not a number; give heights, or leave them out");
    }
    if (highest > lowest) return;
    fail({"SurfaceHeight: highest = ", highest, " m is not above lowest = ", lowest,
          " m; give a higher one"});
  }

  class Line {
   public:
    template <class P, class IsFluid>
    Line(const SurfaceHeight& gauge, const Vec<Dim>& x, const P& particles, IsFluid&& is_fluid,
         const detail::WallsNow<Dim>* walls)
        : gauge_(gauge), l0_(gauge.spacing), x_(x) {
      find_fluid(particles, is_fluid);
      const auto [top, minus_bottom] =
          detail::largest_of_all(particles, std::array{top_, -bottom_});
      top_ = std::min(top + reach * l0_, gauge.highest);
      bottom_ = std::max(-minus_bottom - reach * l0_, gauge.lowest);
      if (!(top_ > bottom_)) return;
      find_levels();
      if (walls) find_faces(*walls, particles);
      add_fluid(particles);
    }
    double height() const {
      if (fluid_at_.empty()) return std::numeric_limits<double>::quiet_NaN();
      double above = -1;  // by how much fluid exceeds the room below, a level higher
      for (Index k = fluid_at_.size(); k-- > 0;) {
        if (!(fluid_at_[k] > 0)) {
          above = -room_below(level(k));
          continue;
        }
        const double excess = fluid_at_[k] - room_below(level(k));
        if (excess < 0) {
          above = excess;
          continue;
        }
        if (k + 1 == fluid_at_.size()) return level(k);
        const bool jumps = interval_of(level(k)) != interval_of(level(k + 1)) || !(above < 0);
        return level(k) + (jumps ? 0 : excess / (excess - above)) * step_;
      }
      return std::numeric_limits<double>::quiet_NaN();
    }

   private:
    struct Drop {
      Vec<Dim> from_line;  // horizontally [m]
      double height;       // [m]
      double weight;       // of the horizontal splines
    };

    template <class P, class IsFluid>
    void find_fluid(const P& particles, IsFluid&& is_fluid) {
      const auto positions = particles[position];
      const auto& box = particles.box();
      for (Index j = 0; j < particles.size(); ++j) {
        Drop drop{positions[j].template cast<double>() - x_, double(positions[j][up]), 1};
        drop.from_line[up] = 0;
        for (int k = 0; k < up && drop.weight > 0; ++k) {
          double& r = drop.from_line[k];
          if (box.periodic[std::size_t(k)]) {
            const double period = double(box.upper[k] - box.lower[k]);
            r -= period * std::round(r / period);
          }
          drop.weight *= detail::b_spline(r / (width * l0_)) / width;
        }
        if (!(drop.weight > 0) || !is_fluid(j)) continue;
        if (drop.height > gauge_.highest + reach * l0_ ||
            drop.height < gauge_.lowest - reach * l0_) {
          continue;
        }
        drops_.push_back(drop);
        top_ = std::max(top_, drop.height);
        bottom_ = std::min(bottom_, drop.height);
      }
    }
    void find_levels() {
      step_ = l0_ / double(levels_per_spacing);
      const double levels = std::ceil((top_ - bottom_) / step_) + 1;
      constexpr double most = 1e6;
      if (!(levels < most)) {
        fail({"SurfaceHeight: there is fluid from ", bottom_, " to ", top_, " m at ", to_text(x_),
              " m, more than ", most / double(levels_per_spacing),
              " spacings; give lowest and highest"});
      }
      fluid_at_.assign(Index(levels), 0.0);
    }
    // From above, so that the highest level is `highest`, if that is in the fluid.
    double level(Index k) const { return top_ - step_ * double(fluid_at_.size() - 1 - k); }

    template <class P>
    void find_faces(const detail::WallsNow<Dim>& walls, const P& particles) {
      Vec<Dim> middle = x_;
      middle[up] = (top_ + bottom_) / 2;
      const double half = (top_ - bottom_) / 2 + reach * l0_, aside = reach * width * l0_;
      const double around = std::sqrt(squared(half) + up * squared(aside)) + l0_;
      walls.for_each_near(middle, around, [&](const Face<Dim>& face) {
        BoundsOf bounds;
        for (const Vec<Dim>& corner : face.corners) {
          bounds.lower = bounds.lower.cwiseMin(corner);
          bounds.upper = bounds.upper.cwiseMax(corner);
        }
        for (int k = 0; k < up; ++k) {
          if (bounds.lower[k] > x_[k] + aside || bounds.upper[k] < x_[k] - aside) return;
        }
        faces_.push_back(face);
        bounds_.push_back(bounds);
      });
      leave_walls(particles);
      Vec<Dim> below = middle, above = middle;
      below[up] -= half, above[up] += half;
      for (const Face<Dim>& face : faces_) {
        const Vec<Dim> normal = normal_of(face);
        if (std::abs(normal[up]) < upright || !hides(face, below, above)) continue;
        crossings_.push_back(x_[up] + normal.dot(face.corners[0] - x_) / normal[up]);
      }
      std::sort(crossings_.begin(), crossings_.end());
    }
    // From an upright wall on which the line is, to the side where there is more fluid.
    template <class P>
    void leave_walls(const P& particles) {
      constexpr double touches = 1e-6, away = 1e-3;  // spacings
      for (const Face<Dim>& face : faces_) {
        const Vec<Dim> normal = normal_of(face);
        if (std::abs(normal[up]) > upright) continue;
        if (std::abs(normal.dot(x_ - face.corners[0])) > touches * l0_) continue;
        double sum = 0;
        for (const Drop& drop : drops_) {
          sum += normal.dot(drop.from_line) > 0 ? drop.weight : -drop.weight;
        }
        const Vec<Dim> shift =
            (detail::sum_of_all(particles, sum) > 0 ? 1 : -1) * away * l0_ * normal;
        x_ += shift;
        for (Drop& drop : drops_) drop.from_line -= shift;
      }
    }

    // --- what is filled, and what is there to be filled ---

    template <class P>
    void add_fluid(const P& particles) {
      for (const Drop& drop : drops_) {
        if (!is_in_sight(drop.from_line, drop.height)) continue;
        const std::size_t interval = interval_of(drop.height);
        const double lowest_level = level(0);
        const auto to_level = [&](double z) { return (z - lowest_level) / step_; };
        const double last = double(fluid_at_.size()) - 1;
        const double first = std::clamp(std::ceil(to_level(drop.height - reach * l0_)), 0.0, last);
        const double end = std::clamp(std::floor(to_level(drop.height + reach * l0_)), 0.0, last);
        for (Index k = Index(first); k <= Index(end); ++k) {
          if (interval_of(level(k)) != interval) continue;
          fluid_at_[k] += drop.weight * detail::b_spline((drop.height - level(k)) / l0_);
        }
      }
      detail::replace_by_sums(particles, fluid_at_);
    }
    double room_below(double z) const {
      if (faces_.empty()) return 0.5;
      const std::size_t interval = interval_of(z);
      const double floor =
          interval > 0 ? crossings_[interval - 1] : -std::numeric_limits<double>::infinity();
      constexpr int parts = 6;  // of the lower half of the spline
      double room = 0;
      for (int k = 0; k < parts; ++k) {
        const double high = z - reach * l0_ * k / parts;
        const double low = std::max(z - reach * l0_ * (k + 1) / parts, floor);
        if (!(low < high)) break;
        room += (detail::integral_of_b_spline((high - z) / l0_) -
                 detail::integral_of_b_spline((low - z) / l0_)) *
                share_in_sight((low + high) / 2);
      }
      return room;
    }
    // Of the horizontal splines. Between upright faces alone it is the same at all heights.
    double share_in_sight(double z) const {
      faces_at_.clear();
      bool are_upright = true;
      for (std::size_t k = 0; k < faces_.size(); ++k) {
        if (z < bounds_[k].lower[up] || z > bounds_[k].upper[up]) continue;
        faces_at_.push_back(k);
        are_upright = are_upright && std::abs(normal_of(faces_[k])[up]) < upright;
      }
      if (faces_at_.empty()) return 1;
      if (are_upright && faces_at_ == known_faces_) return known_share_;
      const double share = sampled_share_in_sight(z);
      known_faces_ = are_upright ? faces_at_ : std::vector<std::size_t>{};
      known_share_ = share;
      return share;
    }
    double sampled_share_in_sight(double z) const {
      constexpr int points = 24;  // along an axis
      constexpr double distance = 2 * reach / points;
      std::array<double, points> weights;
      for (int k = 0; k < points; ++k) {
        weights[std::size_t(k)] = detail::integral_of_b_spline(distance * (k + 1) - reach) -
                                  detail::integral_of_b_spline(distance * k - reach);
      }
      double share = 0;
      Vec<Dim> aside = Vec<Dim>::Zero();
      for (int k = 0; k < points; ++k) {
        aside[0] = ((k + 0.5) * distance - reach) * width * l0_;
        if constexpr (Dim == 2) {
          if (is_in_sight(aside, z)) share += weights[std::size_t(k)];
        } else {
          for (int m = 0; m < points; ++m) {
            aside[1] = ((m + 0.5) * distance - reach) * width * l0_;
            if (is_in_sight(aside, z)) share += weights[std::size_t(k)] * weights[std::size_t(m)];
          }
        }
      }
      return share;
    }
    // Of the line, at this height.
    bool is_in_sight(const Vec<Dim>& from_line, double z) const {
      Vec<Dim> foot = x_;
      foot[up] = z;
      const Vec<Dim> end = foot + from_line;
      for (std::size_t k = 0; k < faces_.size(); ++k) {
        if (z < bounds_[k].lower[up] || z > bounds_[k].upper[up]) continue;
        if (hides(faces_[k], foot, end)) return false;
      }
      return true;
    }
    std::size_t interval_of(double z) const {
      return static_cast<std::size_t>(std::lower_bound(crossings_.begin(), crossings_.end(), z) -
                                      crossings_.begin());
    }

    struct BoundsOf {
      Vec<Dim> lower = Vec<Dim>::Constant(std::numeric_limits<double>::infinity());
      Vec<Dim> upper = Vec<Dim>::Constant(-std::numeric_limits<double>::infinity());
    };
    static constexpr double upright = 1e-9;  // of the vertical component of a normal

    const SurfaceHeight& gauge_;
    double l0_;
    Vec<Dim> x_;
    std::vector<Drop> drops_;
    double top_ = -std::numeric_limits<double>::infinity();
    double bottom_ = std::numeric_limits<double>::infinity();
    double step_ = 0;
    std::vector<double> fluid_at_;  // at each level, from below
    std::vector<Face<Dim>> faces_;
    std::vector<BoundsOf> bounds_;                  // of the faces
    std::vector<double> crossings_;                 // of faces with the line, from below
    mutable std::vector<std::size_t> faces_at_;     // a height, by number
    mutable std::vector<std::size_t> known_faces_;  // between which known_share_ is in sight
    mutable double known_share_ = 1;
  };
};

}  // namespace silt
