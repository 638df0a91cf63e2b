// SPDX-License-Identifier: MIT
// A tank with a column of fluid at its left wall, made of particles on one lattice.
//
//        |        tank         |        fluid at (i + ½) l0 from the corner (0, 0[, 0])
//   d d w|~~~~~~               |w d d   w: wall particles, half a spacing outside
//   d d w|~~~~~~~~             |w d d   d: dummies behind them
//   d d w+---------------------+w d d
//   d d w w w w w w w w w w w w w d d
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace silt::mps {

struct TankSize {
  double length = 0;  ///< along x [m]
  double height = 0;  ///< of the walls, along y (2D) or z (3D) [m]
  double depth = 0;   ///< along y, 3D only [m]
};

template <int Dim>
struct Tank {
  Vec<2> column = Vec<2>::Zero();  ///< width and height of the fluid [m]; in 3D it fills the depth
  TankSize size = {};
  double spacing = 0;    ///< l0 [m]
  int dummy_layers = 4;  ///< at least the largest re/l0, rounded up
  bool lid = false;      ///< a wall on top; a full tank then has no free surface
  OnEscape on_escape = OnEscape::refuse;  ///< treatment of particles that leave the box
};

/// Fluid at rest in a tank; lengths are rounded to whole spacings. The box of an open tank is three
/// tank heights high. Throws if a length is below a spacing or the column does not fit.
template <int Dim, class Real = double, Field... Further>
Fluid<Dim, Real, Further...> make_tank(const Tank<Dim>& tank) {
  constexpr int up = Dim - 1;
  require_positive("Tank: spacing", tank.spacing);
  require_between("Tank: dummy_layers", tank.dummy_layers, {0, 100});
  const auto cell_count = [&](const char* name, double length) {
    require_finite(name, length);
    const double number = std::round(length / tank.spacing);
    if (!(number >= 1) || !(number < 1e6)) {
      fail(std::string(name) + " = " + to_text(length) + " m is " + to_text(number) +
           " times the spacing = " + to_text(tank.spacing) + " m; give between 1 and 1e6 spacings");
    }
    return static_cast<int>(number);
  };
  using Cell = Eigen::Matrix<int, Dim, 1>;
  Cell inside;
  Cell fluid;
  inside[0] = cell_count("Tank: length", tank.size.length);
  inside[up] = cell_count("Tank: height", tank.size.height);
  fluid[0] = cell_count("Tank: column width", tank.column[0]);
  fluid[up] = cell_count("Tank: column height", tank.column[1]);
  if constexpr (Dim == 3) fluid[1] = inside[1] = cell_count("Tank: depth", tank.size.depth);
  for (int k = 0; k < Dim; ++k) {
    if (fluid[k] > inside[k]) {
      const std::string name = k == 0 ? "length" : k == up ? "height" : "depth";
      fail("Tank: along axis " + std::to_string(k) + " (" + name + "), the column has " +
           std::to_string(fluid[k]) + " spacings, but the tank has " + std::to_string(inside[k]) +
           "; enlarge the tank, or make the column smaller");
    }
  }

  double all_cells = 1;
  for (int k = 0; k < Dim; ++k) all_cells *= inside[k] + 2.0 * (1 + tank.dummy_layers);
  if (all_cells > 1e9) {
    fail("Tank: " + to_text(all_cells) + " cells of the spacing " + to_text(tank.spacing) +
         " m are more than 1e9; increase the spacing");
  }

  // 0 inside the tank, 1 in the wall, above 1 in the dummies behind it.
  const int layers = 1 + tank.dummy_layers;
  const auto layer = [&](const Cell& cell) {
    int outside = 0;
    for (int k = 0; k < Dim; ++k) {
      outside = std::max(outside, -cell[k]);
      if (k != up || tank.lid) outside = std::max(outside, cell[k] - inside[k] + 1);
    }
    return outside;
  };

  Box<Dim, Real> box;
  for (int k = 0; k < Dim; ++k) {
    box.lower[k] = Real(-(layers + 1) * tank.spacing);
    box.upper[k] = Real((inside[k] + layers + 1) * tank.spacing);
  }
  box.upper[up] = Real((tank.lid ? inside[up] + layers + 1 : 3 * inside[up]) * tank.spacing);
  box.on_escape = tank.on_escape;
  silt::mps::Fluid<Dim, Real, Further...> particles(box);

  const auto add_if = [&](const Cell& cell, bool condition, Kind of_kind) {
    if (!condition) return;
    add_particle(particles, (cell.template cast<Real>().array() + Real(0.5)) * Real(tank.spacing),
                 of_kind);
  };
  const auto for_each_cell = [&](auto&& f) {
    const int depth = Dim == 3 ? layers : 0;
    const int across = Dim == 3 ? inside[1] : 1;
    const int top = inside[up] + (tank.lid ? layers : 0);
    for (int z = -layers; z < top; ++z) {
      for (int y = -depth; y < across + depth; ++y) {
        for (int x = -layers; x < inside[0] + layers; ++x) {
          Cell cell;
          cell[0] = x;
          if constexpr (Dim == 3) cell[1] = y;
          cell[up] = z;
          f(cell);
        }
      }
    }
  };
  for_each_cell([&](const Cell& cell) {
    bool in_column = layer(cell) == 0;
    for (int k = 0; k < Dim; ++k) in_column &= cell[k] < fluid[k];
    add_if(cell, in_column, Kind::fluid);
  });
  for_each_cell([&](const Cell& cell) { add_if(cell, layer(cell) == 1, Kind::wall); });
  for_each_cell([&](const Cell& cell) { add_if(cell, layer(cell) > 1, Kind::dummy); });
  return particles;
}

}  // namespace silt::mps
