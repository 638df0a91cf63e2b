// SPDX-License-Identifier: MIT
// A symmetric linear system as an interaction makes it and a solver takes it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/core/window_rows.hpp>

#include <array>
#include <concepts>
#include <cstdint>
#include <span>
#include <vector>

namespace silt {

/// A x = b with A symmetric and positive definite, or semi-definite with b in its range. Unknowns
/// and their sums are double: a pressure to six digits is beyond float. What A has beside its
/// diagonal is rounded to float, once.
struct LinearSystem {
  std::vector<double> diagonal;
  WindowRows off_diagonal;
  std::vector<double> right_side;

  /// Bodies of unknowns that A fixes up to a constant only: number of the body of each row, 0 for
  /// rows of none, and nothing where there are no such bodies. A solver keeps these constants out
  /// of what it adds to x.
  std::vector<std::uint32_t> closed_body;
  Index closed_bodies = 0;

  /// Where the unknowns lie, for preconditioners that use space. Without points they do not.
  struct Geometry {
    double spacing = 0;        ///< of the particles [m]
    double full_diagonal = 0;  ///< of an unknown with all its neighbours
    double second_moment = 0;  ///< Σ_j |a_ij| Δx²/spacing² over Σ_j |a_ij|, along an axis
    std::vector<std::array<double, 3>> points;  ///< [m]
    std::vector<float> to_surface;  ///< Σ of the weights to points of given value
  };
  Geometry geometry;

  Index size() const noexcept { return diagonal.size(); }

  /// f(i, (A x)_i) for the rows of one chunk.
  template <class F>
  void multiply(Chunk chunk, std::span<const double> x, F&& f) const {
    off_diagonal.multiply(chunk, x, [&](Index i, double sum) { f(i, diagonal[i] * x[i] + sum); });
  }

  /// Takes its mean over each closed body out of v.
  void remove_constants(std::span<double> v) const {
    if (closed_bodies == 0) return;
    std::vector<double> sum(closed_bodies + 1, 0);
    std::vector<double> members(closed_bodies + 1, 0);
    for (Index row = 0; row < v.size(); ++row) {
      sum[closed_body[row]] += v[row];
      members[closed_body[row]] += 1;
    }
    for_each(v.size(), [&](Index row) {
      const Index body = closed_body[row];
      if (body > 0) v[row] -= sum[body] / members[body];
    });
  }
};

/// Solves a LinearSystem in place, from the x it is given. Models: ConjugateGradient,
/// EigenConjugateGradient.
template <class L>
concept LinearSolver = requires(L solver, const LinearSystem& system, std::vector<double>& x) {
  { solver.solve(system, x) } -> std::same_as<SolveReport>;
  solver.check();
};

}  // namespace silt
