// SPDX-License-Identifier: MIT
// The room that still water takes between walls of faces: what a point of it is connected with,
// below a level.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/faces.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace silt::mps {

/// Water at rest that walls hold: see fill().
template <int Dim>
struct Pool {
  Vec<Dim> inside = Vec<Dim>::Zero();  ///< a point in the water [m]
  /// Of its surface, along y (2D) or z (3D) [m]; above a lid, the room below the lid is full.
  double level = std::numeric_limits<double>::quiet_NaN();
  double spacing = 0;  ///< l0 [m]
};

namespace detail {

/// The room of a Pool, on a grid of half a spacing. Throws if the pool or the faces are invalid, if
/// the water would run out between the faces, or if the grid has more than 1e8 points.
template <int Dim>
class PoolRoom {
 public:
  using Vec = silt::Vec<Dim>;
  static constexpr int up = Dim - 1;
  /// An extent along each axis [m].
  struct Extent {
    Vec lower, upper;
  };

  PoolRoom(const Faces<Dim>& faces, const Pool<Dim>& pool) : faces_(faces), pool_(pool) {
    check();
    make_grid();
    flood();
    measure();
  }

  double spacing() const { return pool_.spacing; }
  /// Of the surface; infinite if there is none.
  double level() const {
    return has_surface_ ? pool_.level : std::numeric_limits<double>::infinity();
  }
  /// In 2D per metre of depth [m³].
  double volume() const { return volume_; }
  const Extent& extent() const { return extent_; }
  const Faces<Dim>& faces() const { return faces_; }

  /// Whether a face is closer to x than a distance [m].
  bool is_near_face(const Vec& x, double distance) const {
    bool is_near = false;
    faces_.for_each_near(x, distance, [&](std::uint32_t k) {
      is_near = is_near || (x - nearest_of(faces_[k].face, x)).squaredNorm() < squared(distance);
    });
    return is_near;
  }
  /// Whether x is in the water: it has the wetness of the nearest grid point that is seen from it.
  bool is_wet(const Vec& x) const {
    if (!(x[up] < pool_.level)) return false;
    Cell nearest;
    for (int k = 0; k < Dim; ++k) nearest[k] = int(std::lround((x[k] - origin_[k]) / step_));
    for (const Cell& offset : offsets_) {
      const Cell cell = nearest + offset;
      if (!is_in_grid(cell)) continue;
      const std::uint8_t state = states_[index_of(cell)];
      if ((state & on_face) != 0 || !(point(cell)[up] < pool_.level)) continue;
      if ((state & clear) != 0 && offset.isZero()) return (state & wet) != 0;
      if (!is_blocked(x, point(cell))) return (state & wet) != 0;
    }
    return false;
  }

  /// Throws if a part of the room is so narrow that particles of the spacing cannot flow in it.
  void require_resolved() const {
    // Those from which a ball with a radius of 0.8 spacings fits into the room, above the level,
    // too; from there, corners are reached in few steps of the grid, but not gaps.
    constexpr double radius = 0.8;  // spacings
    constexpr int most_steps = 9;
    Buffer<std::uint8_t> is_reached(states_.size(), 0);
    for_each(states_.size(), [&](Index i) {
      if ((states_[i] & (wet | above)) == 0) return;
      is_reached[i] = !is_near_face(point(cell_of(i)), radius * pool_.spacing);
    });
    Buffer<Index> now, next;
    for (Index i = 0; i < states_.size(); ++i) {
      if (is_reached[i]) now.push_back(i);
    }
    for (int k = 0; k < most_steps; ++k) {
      next.clear();
      for (const Index i : now) {
        for_each_open(i, [&](Index j) {
          if (is_reached[j] || (states_[j] & (wet | above)) == 0) return;
          is_reached[j] = 1;
          next.push_back(j);
        });
      }
      std::swap(now, next);
    }
    const Index i = first_where(
        states_.size(), [&](Index k) { return (states_[k] & wet) != 0 && is_reached[k] == 0; });
    if (i == no_index) return;
    fail({"fill: around ", to_text(point(cell_of(i))),
          " m, the room between the walls is narrower than two "
          "spacings of ",
          pool_.spacing,
          " m, or a corner is too acute; decrease the spacing, or close this part by a face"});
  }

 private:
  using Cell = Eigen::Matrix<int, Dim, 1>;
  // States of a grid point, as bits; from open on: of the way to the next point along each axis.
  static constexpr std::uint8_t wet = 1, above = 2, on_face = 4, clear = 8, open = 16;

  void check() const {
    require_positive("Pool: spacing", pool_.spacing);
    require_finite("Pool: inside", pool_.inside);
    if (std::isnan(pool_.level)) {
      fail("Pool: level is not given; give the height of the surface [m]");
    }
    if (!(pool_.inside[up] < pool_.level)) {
      fail({"Pool: inside = ", to_text(pool_.inside), " m is not below level = ", pool_.level,
            " m; give a point in the water"});
    }
    if (faces_.elements().empty()) {
      fail(
          "fill: there are no faces, and nothing holds the water; give walls, such as those of "
          "make_empty_tank()");
    }
  }
  [[noreturn]] void fail_on_wall() const {
    fail({"Pool: inside = ", to_text(pool_.inside), " m is on a wall; give a point in the water"});
  }
  void make_grid() {
    step_ = pool_.spacing / 2;
    Vec lower = faces_.elements()[0].face.corners[0], upper = lower;
    for (const auto& element : faces_.elements()) {
      for (const Vec& corner : element.face.corners) {
        lower = lower.cwiseMin(corner);
        upper = upper.cwiseMax(corner);
      }
    }
    if (is_near_face(pool_.inside, 1e-6 * pool_.spacing)) fail_on_wall();
    for (int k = 0; k < Dim; ++k) {
      if (pool_.inside[k] > lower[k] && (k == up || pool_.inside[k] < upper[k])) continue;
      fail({"Pool: inside = ", to_text(pool_.inside), " m is beyond all walls, which reach from ",
            to_text(lower), " m to ", to_text(upper), " m; give a point between them"});
    }
    upper[up] = std::min(upper[up], pool_.level + 2.5 * pool_.spacing);
    double points = 1;
    for (int k = 0; k < Dim; ++k) points *= (upper[k] - lower[k]) / step_ + 3;
    if (!(points < 1e8)) {
      fail({"fill: the walls reach over ", points, " points of a grid of half the spacing = ",
            pool_.spacing, " m, which are more than 1e8; increase the spacing"});
    }
    for (int k = 0; k < Dim; ++k) {
      const int below = int(std::floor((pool_.inside[k] - lower[k]) / step_)) + 1;
      size_[k] = below + int(std::floor((upper[k] - pool_.inside[k]) / step_)) + 2;
      origin_[k] = pool_.inside[k] - below * step_;
    }
    lower_ = lower;
    upper_ = upper;
    // The nearest ones first.
    constexpr int reach = Dim == 2 ? 4 : 3;
    Cell offset = Cell::Constant(-reach);
    while (offset[Dim - 1] <= reach) {
      offsets_.push_back(offset);
      ++offset[0];
      for (int k = 0; k + 1 < Dim && offset[k] > reach; ++k) {
        offset[k] = -reach;
        ++offset[k + 1];
      }
    }
    std::stable_sort(offsets_.begin(), offsets_.end(), [](const Cell& a, const Cell& b) {
      return a.squaredNorm() < b.squaredNorm();
    });
    Index all = 1;
    for (int k = 0; k < Dim; ++k) all *= Index(size_[k]);
    states_.assign(all, 0);
    for_each(all, [&](Index i) {
      const Cell cell = cell_of(i);
      const Vec x = point(cell);
      const double far = step_ * std::sqrt(double(Dim));
      if (!is_near_face(x, far)) {
        states_[i] = std::uint8_t(clear | open | open << 1 | open << 2);
        return;
      }
      std::uint8_t state = is_near_face(x, 1e-6 * pool_.spacing) ? on_face : std::uint8_t(0);
      for (int k = 0; k < Dim; ++k) {
        Cell other = cell;
        ++other[k];
        if (!is_blocked(x, point(other))) state = std::uint8_t(state | open << k);
      }
      states_[i] = state;
    });
  }
  void flood() {
    Cell first;
    for (int k = 0; k < Dim; ++k) {
      first[k] = int(std::lround((pool_.inside[k] - origin_[k]) / step_));
    }
    if ((states_[index_of(first)] & on_face) != 0) fail_on_wall();
    Buffer<Index> reached;
    states_[index_of(first)] |= wet;
    reached.push_back(index_of(first));
    for (Index k = 0; k < reached.size(); ++k) {
      const Vec x = point(cell_of(reached[k]));
      for (int axis = 0; axis < Dim; ++axis) {
        const bool is_out = x[axis] < lower_[axis] || (axis != up && x[axis] > upper_[axis]);
        if (!is_out) continue;
        fail({"fill: the walls do not hold the water from inside = ", to_text(pool_.inside),
              " m up to level = ", pool_.level, " m: it would run out near ", to_text(x),
              " m; close the walls, or lower the level"});
      }
      for_each_open(reached[k], [&](Index j) {
        if ((states_[j] & (wet | on_face)) != 0 || !(point(cell_of(j))[up] < pool_.level)) return;
        states_[j] |= wet;
        reached.push_back(j);
      });
    }
    // The room above the surface, for corners between it and walls.
    for (const Index from : reached) {
      Cell cell = cell_of(from);
      Index i = from;
      while (cell[up] + 1 < size_[up] && (states_[i] & open << up) != 0) {
        ++cell[up];
        i = index_of(cell);
        if ((states_[i] & (wet | on_face | above)) != 0) break;
        states_[i] |= above;
        has_surface_ = true;
      }
    }
  }

  // By ∮ (z − level) n_z dA over the wetted faces, the integral of 1 over the room.
  void measure() {
    extent_ = {Vec::Constant(std::numeric_limits<double>::infinity()),
               Vec::Constant(-std::numeric_limits<double>::infinity())};
    const double level = std::min(pool_.level, upper_[up] + pool_.spacing);
    for (const auto& element : faces_.elements()) {
      for_each_piece(element.face, level, [&](const auto& corners, double area) {
        Vec centre = Vec::Zero();
        for (const Vec& corner : corners) centre += corner / double(corners.size());
        const Vec beside = 0.02 * pool_.spacing * element.normal;
        for (const double side : {1.0, -1.0}) {
          if (!is_wet(centre + side * beside)) continue;
          volume_ -= side * area * element.normal[up] * (centre[up] - level);
          for (const Vec& corner : corners) {
            extent_.lower = extent_.lower.cwiseMin(corner);
            extent_.upper = extent_.upper.cwiseMax(corner);
          }
        }
      });
    }
    extent_.upper[up] = std::min(extent_.upper[up], pool_.level);
    if (volume_ > 0.5 * std::pow(pool_.spacing, Dim)) return;
    fail({"fill: the room around inside = ", to_text(pool_.inside),
          " m below level = ", pool_.level, " m has a volume of ", volume_,
          " m³, less than a particle of the spacing = ", pool_.spacing,
          " m; decrease the spacing"});
  }
  // f(corners, length or area) for pieces of a face below the level, smaller than half a spacing.
  template <class F>
  void for_each_piece(const Face<Dim>& face, double level, F&& f) const {
    std::vector<Vec> polygon;
    for (std::size_t k = 0; k < std::size_t(Dim); ++k) {
      const Vec& a = face.corners[k];
      const Vec& b = face.corners[(k + 1) % std::size_t(Dim)];
      if (a[up] <= level) polygon.push_back(a);
      if (Dim == 2 && k == 1) break;
      if ((a[up] < level && b[up] > level) || (a[up] > level && b[up] < level)) {
        Vec x = a + (level - a[up]) / (b[up] - a[up]) * (b - a);
        x[up] = level;
        polygon.push_back(x);
      }
    }
    for (std::size_t k = Dim == 2 ? 0 : 1; k + 1 < polygon.size(); ++k) {
      if constexpr (Dim == 2) {
        split({{polygon[k], polygon[k + 1]}}, f);
      } else {
        split({{polygon[0], polygon[k], polygon[k + 1]}}, f);
      }
    }
  }
  template <class F>
  void split(const Face<Dim>& face, F&& f) const {
    std::size_t longest = 0;
    double length = 0;
    for (std::size_t k = 0; k < std::size_t(Dim == 2 ? 1 : 3); ++k) {
      const double edge = (face.corners[(k + 1) % std::size_t(Dim)] - face.corners[k]).norm();
      if (edge > length) longest = k;
      length = std::max(length, edge);
    }
    const std::size_t next = (longest + 1) % std::size_t(Dim);
    if (length > step_) {
      const Vec middle = (face.corners[longest] + face.corners[next]) / 2;
      for (const std::size_t replaced : {longest, next}) {
        Face<Dim> half = face;
        half.corners[replaced] = middle;
        split(half, f);
      }
      return;
    }
    if constexpr (Dim == 2) {
      f(face.corners, length);
    } else {
      const auto& [a, b, c] = face.corners;
      f(face.corners, cross(Vec(b - a), Vec(c - a)).norm() / 2);
    }
  }

  bool is_blocked(const Vec& x, const Vec& y) const {
    typename Faces<Dim>::Bounds bounds{x, x};
    bounds.enclose({y, y});
    bool is_blocked = false;
    faces_.for_each_near(bounds, 1e-9 * pool_.spacing, [&](std::uint32_t k) {
      const auto& element = faces_[k];
      is_blocked =
          is_blocked || ((element.height(x) > 0) != (element.height(y) > 0) &&
                         passage_of(element.face, x, y, 1e-9 * pool_.spacing) != Passage::beside);
    });
    return is_blocked;
  }
  template <class F>
  void for_each_open(Index i, F&& f) const {
    const Cell cell = cell_of(i);
    Index stride = 1;
    for (int k = 0; k < Dim; ++k) {
      if (cell[k] + 1 < size_[k] && (states_[i] & open << k) != 0) f(i + stride);
      if (cell[k] > 0 && (states_[i - stride] & open << k) != 0) f(i - stride);
      stride *= Index(size_[k]);
    }
  }
  bool is_in_grid(const Cell& cell) const {
    return (cell.array() >= 0).all() && (cell.array() < size_.array()).all();
  }
  Index index_of(const Cell& cell) const {
    Index i = 0;
    for (int k = Dim; k-- > 0;) i = i * Index(size_[k]) + Index(cell[k]);
    return i;
  }
  Cell cell_of(Index i) const {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      cell[k] = int(i % Index(size_[k]));
      i /= Index(size_[k]);
    }
    return cell;
  }
  Vec point(const Cell& cell) const { return origin_ + step_ * cell.template cast<double>(); }

  const Faces<Dim>& faces_;
  Pool<Dim> pool_;
  double step_ = 0;                                // of the grid [m]
  Vec origin_ = Vec::Zero();                       // its first point
  Cell size_ = Cell::Zero();                       // points along each axis
  Vec lower_ = Vec::Zero(), upper_ = Vec::Zero();  // of all faces
  Buffer<std::uint8_t> states_;
  std::vector<Cell> offsets_;
  bool has_surface_ = false;
  double volume_ = 0;
  Extent extent_;
};

}  // namespace detail

}  // namespace silt::mps
