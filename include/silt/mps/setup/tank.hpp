// SPDX-License-Identifier: MIT
// A tank with a column of fluid at its left wall, made of particles on one lattice, or, between
// walls of faces that it does not fit, in rows.
//
//        |        tank         |        fluid at (i + ½) l0 from the corner (0, 0[, 0])
//   d d w|~~~~~~               |w d d   w: wall particles, half a spacing outside
//   d d w|~~~~~~~~             |w d d   d: dummies behind them
//   d d w+---------------------+w d d
//   d d w w w w w w w w w w w w w d d
//
// With walls of faces, there are neither wall nor dummy particles: the faces are the lines above.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstdio>
#include <string>
#include <vector>

namespace silt::mps {

/// Size of a tank, from the corner at the origin. With walls of particles, each is a whole number
/// of spacings; walls of faces stand exactly there.
struct TankSize {
  double length = 0;  ///< along x [m]
  double height = 0;  ///< of the walls, along y (2D) or z (3D) [m]
  double depth = 0;   ///< along y, 3D only [m]
};

/// A tank, and the fluid in it before it is released.
template <int Dim>
struct Tank {
  /// Width and height of the fluid [m], with walls of particles whole numbers of spacings; in 3D it
  /// fills the depth.
  Vec<2> column = Vec<2>::Zero();
  TankSize size = {};
  double spacing = 0;    ///< l0 [m]
  int dummy_layers = 4;  ///< behind walls of particles: at least the largest re/l0, rounded up
  bool lid = false;      ///< a wall on top; a full tank then has no free surface
  OnEscape on_escape = OnEscape::refuse;  ///< treatment of particles that leave the box
};

namespace detail {

/// With ten digits: with six, a length that a message proposes might be no whole number of
/// spacings.
[[gnu::cold]] inline std::string ten_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.10g", value);
  return text;
}

/// A length of a tank, which `name` identifies [m].
struct TankLength {
  const char* name;
  double length;
  double spacing;  ///< l0 [m]

  /// How many spacings it is [-]: a whole number if it is one up to round-off, a billionth of it.
  /// That of a few operations is a millionth of this; a length with ten digits, as messages have
  /// them, is within a half of it.
  double spacings() const {
    const double whole = std::round(length / spacing);
    return std::abs(length - whole * spacing) <= 1e-9 * length ? whole : length / spacing;
  }
  bool is_whole() const { return spacings() == std::round(spacings()); }

  /// Throws unless it is from 1 to 1e6 spacings.
  void check() const {
    require_finite(name, length);
    if (spacings() >= 1 && spacings() < 1e6) return;
    fail({name, " = ", length, " m is ", spacings(), " times the spacing = ", spacing,
          " m; give between 1 and 1e6 spacings"});
  }
  /// Throws unless it is a whole number of spacings, too. `why` it has to be.
  void check_is_whole(const char* why) const {
    check();
    if (is_whole()) return;
    const double less = std::floor(spacings());
    fail({name, " = ", ten_digits(length), " m is ", ten_digits(spacings()),
          " times the spacing = ", ten_digits(spacing), " m, and ", why,
          "; give a whole number of spacings, such as ", ten_digits(less * spacing), " or ",
          ten_digits((less + 1) * spacing), " m"});
  }
  /// Throws if it ends less than a spacing beyond a column [spacings]: no particle fits into such a
  /// gap. `consequence` of the gap.
  void check_gap(double column, const char* consequence) const {
    const double gap = spacings() - column;
    if (gap <= 0 || gap >= 1) return;
    fail({name, " = ", ten_digits(length), " m leaves a gap of ", ten_digits(gap),
          " times the spacing = ", ten_digits(spacing), " m beyond the column, ", consequence,
          "; give ", ten_digits(column * spacing), " m, or at least ",
          ten_digits((column + 1) * spacing), " m"});
  }
};

/// The room within the walls of a tank. Throws if a length is below a spacing, or, with walls of
/// particles, no whole number of spacings.
template <int Dim>
class TankRoom {
 public:
  static constexpr int up = Dim - 1;

  TankRoom(const Tank<Dim>& tank, bool has_wall_particles) : tank_(tank) {
    require_positive("Tank: spacing", tank.spacing);
    require_between("Tank: dummy_layers", tank.dummy_layers, {0, 100});
    double all_cells = 1;
    for (int axis = 0; axis < Dim; ++axis) {
      const TankLength length = along(axis);
      has_wall_particles ? length.check_is_whole("wall particles are on the lattice of the fluid")
                         : length.check();
      spacings_[axis] = length.spacings();
      upper_[axis] = length.is_whole() ? spacings_[axis] * tank.spacing : length.length;
      all_cells *= spacings_[axis] + 2.0 * layers();
    }
    if (all_cells > 1e9) {
      fail({"Tank: ", all_cells, " cells of the spacing ", tank.spacing,
            " m are more than 1e9; increase the spacing"});
    }
  }

  /// Of the tank along an axis.
  TankLength along(int axis) const {
    if (axis == 0) return {"Tank: length", tank_.size.length, tank_.spacing};
    if (axis == up) return {"Tank: height", tank_.size.height, tank_.spacing};
    return {"Tank: depth", tank_.size.depth, tank_.spacing};
  }
  /// The same [spacings]; not always whole.
  const Vec<Dim>& spacings() const { return spacings_; }
  /// Layers of wall and dummy particles.
  int layers() const { return 1 + tank_.dummy_layers; }

  /// Between the walls.
  Box<Dim> box() const { return {.lower = Vec<Dim>::Zero(), .upper = upper_}; }
  /// Of all particles, with the walls; three tank heights high if the tank is open.
  template <class Real>
  Box<Dim, Real> box_of_particles() const {
    Box<Dim, Real> box;
    for (int k = 0; k < Dim; ++k) {
      box.lower[k] = Real(-layers() * tank_.spacing);
      box.upper[k] = Real((spacings_[k] + layers()) * tank_.spacing);
    }
    if (!tank_.lid) box.upper[up] = Real(3 * spacings_[up] * tank_.spacing);
    box.on_escape = tank_.on_escape;
    return box;
  }
  /// The sides of box().
  std::vector<Face<Dim>> faces() const {
    return faces_of(box(), tank_.lid ? Sides<Dim>::all() : Sides<Dim>::open());
  }

 private:
  const Tank<Dim>& tank_;
  Vec<Dim> spacings_ = Vec<Dim>::Zero();
  Vec<Dim> upper_ = Vec<Dim>::Zero();
};

/// The lengths of the column [spacings], which begins in the corner of the tank. Throws if one is
/// no whole number and there are wall particles, if it does not fit, or if it leaves a gap that
/// holds no particle.
template <int Dim>
Vec<Dim> spacings_of_column(const Tank<Dim>& tank, const TankRoom<Dim>& room,
                            bool has_wall_particles) {
  constexpr int up = TankRoom<Dim>::up;
  constexpr const char* names[] = {"length", Dim == 2 ? "height" : "depth", "height"};
  Vec<Dim> spacings;
  for (int axis = 0; axis < Dim; ++axis) {
    TankLength column = room.along(axis);
    if (axis == 0) column = {"Tank: column width", tank.column[0], tank.spacing};
    if (axis == up) column = {"Tank: column height", tank.column[1], tank.spacing};
    has_wall_particles ? column.check_is_whole("the column is on the lattice of wall particles")
                       : column.check();
    if (column.spacings() > room.spacings()[axis]) {
      fail({"Tank: along axis ", axis, " (", names[axis], "), the column has ",
            ten_digits(column.spacings()), " spacings, but the tank has ",
            ten_digits(room.spacings()[axis]), "; enlarge the tank, or make the column smaller"});
    }
    // The surface below an open top is free.
    if (axis != up) {
      room.along(axis).check_gap(column.spacings(), "into which the fluid would flow at once");
    } else if (tank.lid) {
      room.along(axis).check_gap(column.spacings(), "in which no particle fits below the lid");
    }
    spacings[axis] = column.spacings();
  }
  return spacings;
}

/// A tank on the lattice of its particles. Throws as TankRoom and spacings_of_column() do.
template <int Dim>
class TankLattice {
 public:
  static constexpr int up = Dim - 1;
  using Cell = Eigen::Matrix<int, Dim, 1>;

  TankLattice(const Tank<Dim>& tank, bool has_wall_particles)
      : tank_(tank),
        room_(tank, has_wall_particles),
        column_(spacings_of_column(tank, room_, has_wall_particles)) {}

  const TankRoom<Dim>& room() const { return room_; }

  /// On the lattice if the column fits it, otherwise in rows.
  template <class P>
  void add_column(P& particles) const {
    bool fits = true;
    double volume = 1;
    for (int k = 0; k < Dim; ++k) {
      fits = fits && column_[k] == std::round(column_[k]);
      volume *= column_[k];
    }
    if (!fits) {
      add_rows(particles, up, Vec<Dim>::Zero(), column_, Index(std::round(volume)));
      return;
    }
    for_each_cell(Cell::Zero(), column_.template cast<int>(),
                  [&](const Cell& cell) { add(particles, cell, Kind::fluid); });
  }
  template <class P>
  void add_walls(P& particles) const {
    const Cell around = Cell::Constant(room_.layers());
    Cell end = room_.spacings().template cast<int>() + around;
    if (!tank_.lid) end[up] -= room_.layers();
    for_each_cell(-around, end, [&](const Cell& cell) {
      if (layer(cell) == 1) add(particles, cell, Kind::wall);
    });
    for_each_cell(-around, end, [&](const Cell& cell) {
      if (layer(cell) > 1) add(particles, cell, Kind::dummy);
    });
  }

 private:
  // 0 inside the tank, 1 in the wall, above 1 in the dummies behind it.
  int layer(const Cell& cell) const {
    int outside = 0;
    for (int k = 0; k < Dim; ++k) {
      outside = std::max(outside, -cell[k]);
      if (k == up && !tank_.lid) continue;
      outside = std::max(outside, cell[k] - static_cast<int>(room_.spacings()[k]) + 1);
    }
    return outside;
  }
  template <class P>
  void add(P& particles, const Cell& cell, Kind of_kind) const {
    using Real = typename P::Real;
    Vec<Dim, Real> x;
    for (int k = 0; k < Dim; ++k) x[k] = (Real(cell[k]) + Real(0.5)) * Real(tank_.spacing);
    add_particle(particles, x, of_kind);
  }
  // A number of particles between two corners [spacings]: in layers, rows and evenly in rows.
  // Layers and rows have nearly the same number, and sizes in proportion to it, so that each
  // particle has its volume.
  template <class P>
  void add_rows(P& particles, int axis, const Vec<Dim>& lower, const Vec<Dim>& upper,
                Index number) const {
    using Real = typename P::Real;
    if (number == 0) return;
    const double length = upper[axis] - lower[axis];
    const Index parts = axis == 0 ? number : std::max(Index(1), Index(std::round(length)));
    Vec<Dim> from = lower, to = upper;
    for (Index k = 0; k < parts; ++k) {
      const Index before = k * number / parts, after = (k + 1) * number / parts;
      from[axis] = lower[axis] + length * double(before) / double(number);
      to[axis] = lower[axis] + length * double(after) / double(number);
      if (axis > 0) {
        add_rows(particles, axis - 1, from, to, after - before);
        continue;
      }
      Vec<Dim, Real> x;
      for (int a = 0; a < Dim; ++a) x[a] = Real(tank_.spacing * (from[a] + to[a]) / 2);
      add_particle(particles, x, Kind::fluid);
    }
  }
  // Those from `first` to before `end`; x varies fastest, the height slowest.
  template <class F>
  static void for_each_cell(const Cell& first, const Cell& end, F&& f) {
    for (Cell cell = first; cell[up] < end[up];) {
      f(cell);
      ++cell[0];
      for (int k = 0; k < up && cell[k] == end[k]; ++k) {
        cell[k] = first[k];
        ++cell[k + 1];
      }
    }
  }

  const Tank<Dim>& tank_;
  TankRoom<Dim> room_;
  Vec<Dim> column_;  // [spacings]
};

}  // namespace detail

/// Fluid at rest in a tank of wall and dummy particles. The box of an open tank is three tank
/// heights high. Throws if a length is no whole number of spacings, up to a billionth of it, or if
/// the column does not fit.
template <int Dim, class Real = double, Field... Further>
Fluid<Dim, Real, Further...> make_tank(const Tank<Dim>& tank) {
  const detail::TankLattice<Dim> lattice(tank, true);
  silt::mps::Fluid<Dim, Real, Further...> particles(
      lattice.room().template box_of_particles<Real>());
  lattice.add_column(particles);
  lattice.add_walls(particles);
  return particles;
}

/// A tank as a flow with a scheme needs it: its particles, and its walls for FlowSettings.
template <class Scheme, int Dim, class Real = double, Field... Further>
struct TankOf {
  Fluid<Dim, Real, Further...> particles;
  WallsOf<Scheme> walls;
};

/// The same for the walls of a scheme: fluid alone with walls of faces, such as those of
/// Recommended, otherwise with wall and dummy particles. Faces, and the column between them, are
/// exactly where they are asked to be. A column that is no whole number of spacings wide and high,
/// and deep in 3D, has as many particles as its volume has cells, to the nearest number, in rows
/// with slightly different numbers of particles; between walls they rest. Throws also if faces
/// leave a gap of less than a spacing beside the column or below a lid.
template <class Scheme, int Dim, class Real = double, Field... Further>
TankOf<Scheme, Dim, Real, Further...> make_tank(const Tank<Dim>& tank) {
  if constexpr (std::derived_from<WallsOf<Scheme>, ImageWalls>) {
    const detail::TankLattice<Dim> lattice(tank, false);
    TankOf<Scheme, Dim, Real, Further...> made{
        silt::mps::Fluid<Dim, Real, Further...>(lattice.room().template box_of_particles<Real>()),
        Scheme{}.walls};
    lattice.add_column(made.particles);
    made.walls.template faces<Dim>() = lattice.room().faces();
    return made;
  } else {
    return {make_tank<Dim, Real, Further...>(tank), Scheme{}.walls};
  }
}

/// A tank with walls of faces, without fluid: for a body of any shape. It has no column: throws if
/// one is given, or if a length is below a spacing.
template <class Scheme, int Dim, class Real = double, Field... Further>
  requires std::derived_from<WallsOf<Scheme>, ImageWalls>
TankOf<Scheme, Dim, Real, Further...> make_empty_tank(const Tank<Dim>& tank) {
  if (!(tank.column.array() == 0).all()) {
    fail({"Tank: column = ", tank.column,
          " m in a tank without fluid; leave it out, or call make_tank()"});
  }
  const detail::TankRoom<Dim> room(tank, false);
  TankOf<Scheme, Dim, Real, Further...> made{
      silt::mps::Fluid<Dim, Real, Further...>(room.template box_of_particles<Real>()),
      Scheme{}.walls};
  made.walls.template faces<Dim>() = room.faces();
  return made;
}

}  // namespace silt::mps
