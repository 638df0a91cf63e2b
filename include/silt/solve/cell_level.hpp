// SPDX-License-Identifier: MIT
// One level of the multigrid on background cells: a stencil of mostly 5 (in 3D 7) points,
//
//     Σ_l k_l (x_c − x_l) + m_c x_c = b_c
//
// with the conductances k to the neighbouring cells l, and the mass m, the coupling of c to the
// free surface.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_links.hpp>

#include <algorithm>

namespace silt {

/// The cells of one level, with their equations, solutions `x`, right sides `b` and residuals `r`.
template <int Dim>
struct CellLevel {
  /// Cells of one colour have no links to each other: `red` and `black`, as on a chessboard.
  enum Colour { red, black };

  Buffer<GridCell<Dim>> cells;  ///< red ones first; several at a position divided by walls
  Index reds = 0;               ///< number of red cells
  CellLinks<Dim> links;         ///< to cells of the other colour
  Buffer<float> mass;           ///< coupling to the free surface
  Buffer<float> diagonal;       ///< of the matrix
  Buffer<float> inverse;        ///< of the diagonal
  Buffer<float> x, b;
  Buffer<float> r;  ///< of red cells

  Index size() const noexcept { return cells.size(); }

  /// n cells, without positions, links and masses.
  void reset(Index n) {
    cells.resize(n);
    for (auto* values : {&mass, &diagonal, &inverse, &x, &b, &r}) values->resize(n);
  }

  /// Computes the diagonal. Every cell gets at least a small mass, because the equation of a closed
  /// body would be singular.
  void finish(float min_mass) {
    for_each_cell(size(), [&](Index c) {
      float sum = 0;
      for (const CellLink& link : links[c]) sum += link.conductance;
      mass[c] = std::max(mass[c], min_mass * sum);
      diagonal[c] = sum + mass[c];
      inverse[c] = diagonal[c] > 0 ? 1 / diagonal[c] : 0;
    });
  }

  /// As relax(red) where x = 0, whatever x is.
  void relax_reds_from_zero() {
    for_each_cell_range(reds, [&](Index first, Index last) {
      for (Index c = first; c < last; ++c) x[c] = b[c] * inverse[c];
    });
  }

  /// Gauss–Seidel over one colour, whose cells are not neighbours of one another.
  void relax(Colour colour) {
    const Index from = colour == red ? 0 : reds;
    const Index to = colour == red ? reds : size();
    for_each_cell_range(to - from, [&, from](Index first, Index last) {
      links.for_each_inflow(from + first, from + last, x.data(),
                            [x = x.data(), b = b.data(), inverse = inverse.data()](
                                Index c, float inflow) { x[c] = (b[c] + inflow) * inverse[c]; });
    });
  }

  /// r = b − A x of the red cells. That of the black ones, if they were relaxed last, is round-off.
  void find_red_residual() {
    for_each_cell_range(reds, [&](Index first, Index last) {
      links.for_each_inflow(
          first, last, x.data(),
          [r = r.data(), x = x.data(), b = b.data(), diagonal = diagonal.data()](
              Index c, float inflow) { r[c] = b[c] + inflow - diagonal[c] * x[c]; });
    });
  }
};

}  // namespace silt
