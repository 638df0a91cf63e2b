// SPDX-License-Identifier: MIT
// The load of a fluid on walls of faces, from what changed the momentum of its particles.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/faces.hpp>
#include <silt/geometry/line_of_sight.hpp>
#include <silt/geometry/rigid_body.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace silt {

/// What all particles of a fluid have in common.
struct FluidOfLoad {
  double density;    ///< [kg/m³]
  double spacing;    ///< l0 [m]
  double time_step;  ///< that of the changes of momentum [s]
};

/// Bounds of faces, outside of which no line along an axis meets one.
template <int Dim>
struct BoundsOfFaces {
  Vec<Dim> lower = Vec<Dim>::Constant(std::numeric_limits<double>::infinity());   ///< [m]
  Vec<Dim> upper = Vec<Dim>::Constant(-std::numeric_limits<double>::infinity());  ///< [m]

  /// Extends them to the corners of a face.
  void enclose(const Face<Dim>& face) {
    for (const Vec<Dim>& corner : face.corners) {
      lower = lower.cwiseMin(corner);
      upper = upper.cwiseMax(corner);
    }
  }
  /// Whether a line along an axis that begins no farther than `aside` from x may meet a face in
  /// these bounds [m].
  bool may_be_met(const Vec<Dim>& x, int axis, double aside) const {
    for (int k = 0; k < Dim; ++k) {
      if (k != axis && !(lower[k] <= x[k] + aside && x[k] - aside <= upper[k])) return false;
    }
    return true;
  }
};

/// Force and torque of the fluid on the walls that a particle sees along the axes. The integral of
/// P n over the walls that are first seen along an axis is that of ψ ∂P + P ∂ψ over the fluid which
/// sees them, with derivatives along the axis, where ψ is 1 on these walls, 0 on those in the
/// opposite direction and linear between both, or 1 if there are none. For ∂P stands −ρ times the
/// acceleration. A particle is as wide as its cell, whose parts may see different walls: in rows, a
/// part of a wall that protrudes by less than a spacing would get all of a row or nothing. The
/// viscous stress of walls acts on the nearest one. Refers to the walls.
template <int Dim>
class FluidLoad {
 public:
  using Vec = silt::Vec<Dim>;

  /// A wall that a particle sees.
  struct SeenWall {
    Direction direction;
    SeenFace face;
    Vec foot;  ///< where the line meets it [m]
  };

  /// The wall nearest to a particle.
  struct NearestWall {
    std::uint32_t element = 0;  ///< the number of the face
    Vec foot;                   ///< its point nearest to the particle [m]
    Vec particle;               ///< [m]
  };

  /// For walls in a box, where they were when the fluid had these changes of momentum.
  template <class Real>
  FluidLoad(const Faces<Dim>& walls, const Box<Dim, Real>& box, const FluidOfLoad& fluid)
      : walls_(walls),
        box_{.lower = box.lower.template cast<double>(),
             .upper = box.upper.template cast<double>(),
             .periodic = box.periodic},
        spacing_(fluid.spacing),
        volume_(std::pow(fluid.spacing, Dim)),
        momentum_(fluid.density * volume_ / fluid.time_step) {
    // Off a lattice, where lines would pass through edges that parts of a wall have in common.
    aside_ = 1e-7 * spacing_ * Vec::Ones();
    for (int k = 0; k < Dim; ++k) aside_[k] /= std::sqrt(k + 2);
  }

  /// The walls and the box that it was made for.
  const Faces<Dim>& walls() const { return walls_; }
  const Box<Dim>& box() const { return box_; }

  /// The load by all particles of this process, whose changes have the members of
  /// mps::MomentumChange, and its torque about a point [m]. share_of(x, seen_wall) is the share [-]
  /// of the load on a wall, seen from x, that counts; 0 at an infinite distance. Outside of the
  /// bounds nothing does. counts_near(nearest_wall) tells whether the viscous stress counts.
  template <class Change, class ShareOf, class CountsNear>
  BodyLoad<Dim> sum(const Buffer<Change>& changes, const BoundsOfFaces<Dim>& bounds,
                    const Vec& about, ShareOf&& share_of, CountsNear&& counts_near) const {
    return in_body(ordered_sum(changes.size(), zero_of<Numbers>(), [&](Index i) {
      BodyLoad<Dim> load = by(changes[i], bounds, about, share_of);
      if (!changes[i].wall_stress.isZero(0)) add_stress(changes[i], about, counts_near, load);
      return in_row(load);
    }));
  }
  /// The sum of the loads of all processes.
  template <class P>
  static BodyLoad<Dim> sum_of_all(const P& particles, const BodyLoad<Dim>& own) {
    return in_body(silt::detail::sum_of_all(particles, in_row(own)));
  }

 private:
  using Numbers = silt::Vec<Dim + angular_size<Dim>>;
  // Spacings: beyond the effective radius of the viscous term, walls have no stress.
  static constexpr double range_of_stress = 5;
  // Of a cell across the axis: to a sixteenth, in 3D to a quarter of a spacing.
  static constexpr int splits = Dim == 2 ? 4 : 2;

  static Numbers in_row(const BodyLoad<Dim>& load) {
    Numbers row;
    for (int k = 0; k < Dim; ++k) row[k] = load.force[k];
    for (int k = 0; k < angular_size<Dim>; ++k) row[Dim + k] = component(load.torque, k);
    return row;
  }
  static BodyLoad<Dim> in_body(const Numbers& row) {
    BodyLoad<Dim> load;
    for (int k = 0; k < Dim; ++k) load.force[k] = row[k];
    for (int k = 0; k < angular_size<Dim>; ++k) component(load.torque, k) = row[Dim + k];
    return load;
  }
  // What is seen from a point along an axis, backwards and forwards.
  using BothSides = std::array<SeenWall, 2>;
  // The lines along an axis through a part of the cell of a particle: a box of `half` its size
  // around its middle, as offsets from the particle [m].
  struct PartOfCell {
    Vec middle;
    Vec half;          // 0 along the axis
    double share = 1;  // of the cell
  };

  template <class Change, class ShareOf>
  BodyLoad<Dim> by(const Change& change, const BoundsOfFaces<Dim>& bounds, const Vec& about,
                   ShareOf&& share_of) const {
    BodyLoad<Dim> load;
    const Vec x = change.position + aside_;
    const auto may_be_met = [&](int axis) { return bounds.may_be_met(x, axis, spacing_ / 2); };
    bool any = false;
    for (int axis = 0; axis < Dim; ++axis) any = any || may_be_met(axis);
    if (!any) return load;
    const Cell cell = cell_around(x);
    for (int axis = 0; axis < Dim; ++axis) {
      if (!may_be_met(axis)) continue;
      const auto add = [&](const PartOfCell& part, const BothSides& seen) {
        const Vec at = x + part.middle;
        const double gap = seen[0].face.distance + seen[1].face.distance;
        double push = 0;
        for (const std::size_t side : {0u, 1u}) {
          const double counts = share_of(at, seen[side]);
          if (counts == 0) continue;
          const double sign = side == 0 ? -1 : 1;
          const double share = is_finite(gap) ? seen[1 - side].face.distance / gap : 1;
          push += counts * (sign * volume_ * change.pressure / gap -
                            share * momentum_ * change.velocity_change[axis]);
        }
        push *= part.share;
        Vec along = Vec::Zero();
        along[axis] = push;
        load.force[axis] += push;
        load.torque += cross(Vec(at - about), along);
      };
      PartOfCell whole{cell.middle, cell.half};
      whole.middle[axis] = whole.half[axis] = 0;
      for_each_part(x, axis, whole, splits, add);
    }
    return load;
  }
  // The cell of a particle is as wide as the spacing, and ends at walls. As a middle, seen from the
  // particle, and halves of its widths [m].
  struct Cell {
    Vec middle, half;
  };
  Cell cell_around(const Vec& x) const {
    Cell cell;
    for (int k = 0; k < Dim; ++k) {
      constexpr double before_wall = 0.999;
      const auto width = [&](int sign) {
        return std::min(spacing_ / 2,
                        before_wall * first_face_in(box_, walls_, x, {k, sign}).distance);
      };
      const double lower = width(-1), upper = width(1);
      cell.middle[k] = (upper - lower) / 2;
      cell.half[k] = (upper + lower) / 2;
    }
    return cell;
  }
  // f(part, what its middle sees) for parts of a cell, the whole of it if all of it sees the same.
  template <class F>
  void for_each_part(const Vec& x, int axis, const PartOfCell& part, int further, F&& f) const {
    const auto seen_from = [&](const Vec& offset) {
      const Vec at = x + offset;
      return BothSides{in({axis, -1}, at), in({axis, 1}, at)};
    };
    const BothSides seen = seen_from(part.middle);
    // The ends of its diagonals.
    constexpr unsigned corners = 1u << Dim;
    const auto corner = [&](unsigned number, double of_half) {
      Vec offset = part.middle;
      for (int k = 0; k < Dim; ++k) {
        offset[k] += ((number >> k & 1u) ? of_half : -of_half) * part.half[k];
      }
      return offset;
    };
    const auto is_of_cell = [&](unsigned number) { return !(number >> axis & 1u); };
    bool is_alike = true;
    for (unsigned c = 0; further > 0 && is_alike && c < corners; ++c) {
      if (is_of_cell(c)) is_alike = are_alike(seen, seen_from(corner(c, 1)));
    }
    if (is_alike) return f(part, seen);
    for (unsigned c = 0; c < corners; ++c) {
      if (!is_of_cell(c)) continue;
      for_each_part(x, axis, {corner(c, 0.5), Vec(part.half / 2), part.share / (corners / 2)},
                    further - 1, f);
    }
  }
  bool are_alike(const BothSides& one, const BothSides& other) const {
    for (const std::size_t side : {0u, 1u}) {
      const SeenFace &a = one[side].face, &b = other[side].face;
      if (is_finite(a.distance) != is_finite(b.distance)) return false;
      if (!is_finite(a.distance)) continue;
      if (walls_[a.element].group != walls_[b.element].group) return false;
      if (!(std::abs(a.distance - b.distance) < spacing_ / 2)) return false;
    }
    return true;
  }
  template <class Change, class CountsNear>
  void add_stress(const Change& change, const Vec& about, CountsNear&& counts_near,
                  BodyLoad<Dim>& load) const {
    NearestWall nearest;
    double least = std::numeric_limits<double>::infinity();
    walls_.for_each_near(change.position, range_of_stress * spacing_, [&](std::uint32_t k) {
      const Vec foot = nearest_of(walls_[k].face, change.position);
      const double distance = (foot - change.position).norm();
      if (!(distance < least)) return;
      least = distance;
      nearest = {k, foot, change.position};
    });
    if (!is_finite(least) || !counts_near(nearest)) return;
    const Vec push = -momentum_ * change.wall_stress;
    load.force += push;
    load.torque += cross(Vec(nearest.foot - about), push);
  }
  SeenWall in(const Direction& direction, const Vec& x) const {
    SeenWall seen{direction, first_face_in(box_, walls_, x, direction), x};
    if (is_finite(seen.face.distance)) {
      seen.foot[direction.axis] += direction.sign * seen.face.distance;
    }
    return seen;
  }

  const Faces<Dim>& walls_;
  Box<Dim> box_;
  double spacing_;   // [m]
  double volume_;    // of a particle [m³]
  double momentum_;  // of a particle per velocity, over Δt [kg/s]
  Vec aside_;
};

}  // namespace silt
