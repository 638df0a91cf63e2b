// SPDX-License-Identifier: MIT
// A tank with a column of fluid at its left wall, made of particles on one lattice.
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
#include <string>

namespace silt::mps {

/// Size of a tank, from the corner at the origin.
struct TankSize {
  double length = 0;  ///< along x [m]
  double height = 0;  ///< of the walls, along y (2D) or z (3D) [m]
  double depth = 0;   ///< along y, 3D only [m]
};

/// A tank, and the fluid in it before it is released.
template <int Dim>
struct Tank {
  Vec<2> column = Vec<2>::Zero();  ///< width and height of the fluid [m]; in 3D it fills the depth
  TankSize size = {};
  double spacing = 0;    ///< l0 [m]
  int dummy_layers = 4;  ///< behind walls of particles: at least the largest re/l0, rounded up
  bool lid = false;      ///< a wall on top; a full tank then has no free surface
  OnEscape on_escape = OnEscape::refuse;  ///< treatment of particles that leave the box
};

namespace detail {

/// A tank on the lattice of its particles. Throws if a length is below a spacing or the column does
/// not fit.
template <int Dim>
class TankLattice {
 public:
  static constexpr int up = Dim - 1;
  using Cell = Eigen::Matrix<int, Dim, 1>;

  explicit TankLattice(const Tank<Dim>& tank) : tank_(tank) {
    require_positive("Tank: spacing", tank.spacing);
    require_between("Tank: dummy_layers", tank.dummy_layers, {0, 100});
    inside_[0] = cell_count("Tank: length", tank.size.length);
    inside_[up] = cell_count("Tank: height", tank.size.height);
    fluid_[0] = cell_count("Tank: column width", tank.column[0]);
    fluid_[up] = cell_count("Tank: column height", tank.column[1]);
    if constexpr (Dim == 3) fluid_[1] = inside_[1] = cell_count("Tank: depth", tank.size.depth);
    for (int k = 0; k < Dim; ++k) {
      if (fluid_[k] > inside_[k]) {
        const std::string name = k == 0 ? "length" : k == up ? "height" : "depth";
        fail("Tank: along axis " + std::to_string(k) + " (" + name + "), the column has " +
             std::to_string(fluid_[k]) + " spacings, but the tank has " +
             std::to_string(inside_[k]) + "; enlarge the tank, or make the column smaller");
      }
    }
    double all_cells = 1;
    for (int k = 0; k < Dim; ++k) all_cells *= inside_[k] + 2.0 * (1 + tank.dummy_layers);
    if (all_cells > 1e9) {
      fail("Tank: " + to_text(all_cells) + " cells of the spacing " + to_text(tank.spacing) +
           " m are more than 1e9; increase the spacing");
    }
  }

  /// Of all particles, with the walls; three tank heights high if the tank is open.
  template <class Real>
  Box<Dim, Real> box() const {
    Box<Dim, Real> box;
    const int outside = layers() + 1;
    for (int k = 0; k < Dim; ++k) {
      box.lower[k] = Real(-outside * tank_.spacing);
      box.upper[k] = Real((inside_[k] + outside) * tank_.spacing);
    }
    box.upper[up] =
        Real((tank_.lid ? inside_[up] + outside : 3 * inside_[up]) * tank_.spacing);
    box.on_escape = tank_.on_escape;
    return box;
  }
  /// The inside of the tank.
  Box<Dim> room() const {
    return {.lower = Vec<Dim>::Zero(), .upper = inside_.template cast<double>() * tank_.spacing};
  }

  template <class P>
  void add_column(P& particles) const {
    for_each_cell([&](const Cell& cell) {
      if (layer(cell) == 0 && (cell.array() < fluid_.array()).all()) {
        add(particles, cell, Kind::fluid);
      }
    });
  }
  template <class P>
  void add_walls(P& particles) const {
    for_each_cell([&](const Cell& cell) {
      if (layer(cell) == 1) add(particles, cell, Kind::wall);
    });
    for_each_cell([&](const Cell& cell) {
      if (layer(cell) > 1) add(particles, cell, Kind::dummy);
    });
  }

 private:
  int cell_count(const char* name, double length) const {
    require_finite(name, length);
    const double number = std::round(length / tank_.spacing);
    if (!(number >= 1) || !(number < 1e6)) {
      fail(std::string(name) + " = " + to_text(length) + " m is " + to_text(number) +
           " times the spacing = " + to_text(tank_.spacing) +
           " m; give between 1 and 1e6 spacings");
    }
    return static_cast<int>(number);
  }
  // Of wall and dummy particles.
  int layers() const { return 1 + tank_.dummy_layers; }
  // 0 inside the tank, 1 in the wall, above 1 in the dummies behind it.
  int layer(const Cell& cell) const {
    int outside = 0;
    for (int k = 0; k < Dim; ++k) {
      outside = std::max(outside, -cell[k]);
      if (k != up || tank_.lid) outside = std::max(outside, cell[k] - inside_[k] + 1);
    }
    return outside;
  }
  template <class P>
  void add(P& particles, const Cell& cell, Kind of_kind) const {
    using Real = typename P::Real;
    add_particle(particles,
                 (cell.template cast<Real>().array() + Real(0.5)) * Real(tank_.spacing), of_kind);
  }
  template <class F>
  void for_each_cell(F&& f) const {
    const int depth = Dim == 3 ? layers() : 0;
    const int across = Dim == 3 ? inside_[1] : 1;
    const int top = inside_[up] + (tank_.lid ? layers() : 0);
    for (int z = -layers(); z < top; ++z) {
      for (int y = -depth; y < across + depth; ++y) {
        for (int x = -layers(); x < inside_[0] + layers(); ++x) {
          Cell cell;
          cell[0] = x;
          if constexpr (Dim == 3) cell[1] = y;
          cell[up] = z;
          f(cell);
        }
      }
    }
  }

  const Tank<Dim>& tank_;
  Cell inside_;
  Cell fluid_;
};

}  // namespace detail

/// Fluid at rest in a tank of wall and dummy particles; lengths are rounded to whole spacings. The
/// box of an open tank is three tank heights high. Throws if a length is below a spacing or the
/// column does not fit.
template <int Dim, class Real = double, Field... Further>
Fluid<Dim, Real, Further...> make_tank(const Tank<Dim>& tank) {
  const detail::TankLattice<Dim> lattice(tank);
  silt::mps::Fluid<Dim, Real, Further...> particles(lattice.template box<Real>());
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
/// Recommended, otherwise with wall and dummy particles.
template <class Scheme, int Dim, class Real = double, Field... Further>
TankOf<Scheme, Dim, Real, Further...> make_tank(const Tank<Dim>& tank) {
  if constexpr (std::derived_from<WallsOf<Scheme>, ImageWalls>) {
    const detail::TankLattice<Dim> lattice(tank);
    TankOf<Scheme, Dim, Real, Further...> made{
        silt::mps::Fluid<Dim, Real, Further...>(lattice.template box<Real>()), Scheme{}.walls};
    lattice.add_column(made.particles);
    const auto sides = tank.lid ? Sides<Dim>::all() : Sides<Dim>::open();
    made.walls.template faces<Dim>() = faces_of(lattice.room(), sides);
    return made;
  } else {
    return {make_tank<Dim, Real, Further...>(tank), Scheme{}.walls};
  }
}

}  // namespace silt::mps
