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
#include <silt/linear/rows.hpp>
#include <silt/solve/background_cells.hpp>

#include <algorithm>
#include <cstdint>

namespace silt {

/// The cells of one level, with their equations, solutions `x`, right sides `b` and residuals `r`.
template <int Dim>
struct CellLevel {
  /// A link to a neighbouring `cell`, by its number.
  struct Link {
    std::uint32_t cell;
    float conductance;  ///< above 0 [as the entries of A]
  };
  /// Cells of one colour have no links to each other: `red` and `black`, as on a chessboard.
  enum Colour { red, black };

  Buffer<GridCell<Dim>> cells;  ///< red ones first; several at a position divided by walls
  Index reds = 0;                    ///< number of red cells
  Rows<Link> links;                  ///< to cells of the other colour
  Buffer<float> mass;                ///< coupling to the free surface
  Buffer<float> diagonal;            ///< of the matrix
  Buffer<float> inverse;             ///< of the diagonal
  Buffer<float> x, b, r;

  Index size() const noexcept { return cells.size(); }

  /// n cells, without positions, links and masses.
  void reset(Index n) {
    cells.resize(n);
    for (auto* values : {&mass, &diagonal, &inverse, &x, &b, &r}) values->assign(n, 0);
  }

  /// Computes the diagonal. Every cell gets at least a small mass, because the equation of a closed
  /// body would be singular.
  void finish(float min_mass) {
    for_each_cell(size(), [&](Index c) {
      float sum = 0;
      for (const Link& link : links[c]) sum += link.conductance;
      mass[c] = std::max(mass[c], min_mass * sum);
      diagonal[c] = sum + mass[c];
      inverse[c] = diagonal[c] > 0 ? 1 / diagonal[c] : 0;
    });
  }

  /// Gauss–Seidel over one colour, whose cells are not neighbours of one another.
  void relax(Colour colour) {
    const Index from = colour == red ? 0 : reds;
    const Index to = colour == red ? reds : size();
    for_each_cell(to - from, [&](Index k) {
      const Index c = from + k;
      x[c] = (b[c] + inflow(c)) * inverse[c];
    });
  }

  /// r = b − A x.
  void find_residual() {
    for_each_cell(size(), [&](Index c) { r[c] = b[c] + inflow(c) - diagonal[c] * x[c]; });
  }

 private:
  // Σ_l k_l x_l
  float inflow(Index c) const {
    float sum = 0;
    for (const Link& link : links[c]) sum += link.conductance * x[link.cell];
    return sum;
  }
};

}  // namespace silt
