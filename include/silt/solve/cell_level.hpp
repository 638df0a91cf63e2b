// SPDX-License-Identifier: MIT
// One level of the multigrid on background cells: an equation with 5 (7) points,
//
//     Σ_f k_f (x_c − x_f) + m_c x_c = b_c
//
// with the conductance k of each face that c shares with another cell, and the mass m, which ties
// c to the free surface.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/solve/background_cells.hpp>
#include <silt/solve/cell_interpolation.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace silt {

template <int Dim>
struct CellLevel {
  static constexpr Index faces = 2 * Dim;  // 2 k and 2 k + 1 lie across axis k
  enum Colour { red, black };

  BackgroundCells<Dim> cells;
  std::vector<std::array<std::uint32_t, faces>> beside;  // itself where there is none
  std::vector<std::array<float, faces>> conductance;     // 0 where there is none
  std::vector<float> mass;
  std::vector<float> diagonal;
  std::vector<float> inverse;  // of the diagonal
  std::vector<float> x, b, r;
  CellInterpolation<Dim> to_finer;  // from here to what lies below: particles, or finer cells

  Index size() const noexcept { return cells.size(); }

  /// Cells as they are numbered, without conductances and masses.
  void lay_out() {
    const Index n = size();
    beside.resize(n);
    conductance.resize(n);
    for (auto* values : {&mass, &diagonal, &inverse, &x, &b, &r}) values->assign(n, 0);
    for_each_cell(n, [&](Index c) {
      for (Index f = 0; f < faces; ++f) {
        GridCell<Dim> next = cells.cells()[c];
        next[f / 2] += f % 2 == 0 ? -1 : 1;
        const std::uint32_t other = cells.find(next);
        beside[c][f] = other == BackgroundCells<Dim>::none ? std::uint32_t(c) : other;
        conductance[c][f] = 0;
      }
    });
  }

  /// Cells that touch no surface get a little mass: an all-closed body would be singular.
  void finish(float least_mass) {
    for_each_cell(size(), [&](Index c) {
      float sum = 0;
      for (Index f = 0; f < faces; ++f) sum += conductance[c][f];
      mass[c] = std::max(mass[c], least_mass * sum);
      diagonal[c] = sum + mass[c];
      inverse[c] = diagonal[c] > 0 ? 1 / diagonal[c] : 0;
    });
  }

  /// Gauss–Seidel over one colour: none of its cells is beside another.
  void relax(Colour colour) {
    const Index from = colour == red ? 0 : cells.reds();
    const Index to = colour == red ? cells.reds() : size();
    for_each_cell(to - from, [&](Index k) {
      const Index c = from + k;
      x[c] = (b[c] + inflow(c)) * inverse[c];
    });
  }

  void find_residual() {
    for_each_cell(size(), [&](Index c) { r[c] = b[c] + inflow(c) - diagonal[c] * x[c]; });
  }

 private:
  // Σ_f k_f x_f
  float inflow(Index c) const {
    float sum = 0;
    for (Index f = 0; f < faces; ++f) sum += conductance[c][f] * x[beside[c][f]];
    return sum;
  }
};

}  // namespace silt
