// SPDX-License-Identifier: MIT
// A symmetric linear system, assembled by an interaction and solved by a LinearSolver.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/shared_unknowns.hpp>
#include <silt/linear/window_rows.hpp>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace silt {

/// A x = b with A symmetric and positive definite, or semi-definite with b in its range: its
/// `diagonal` and `off_diagonal` entries, and b, the `right_side`. Unknowns and sums are double,
/// because float is not sufficient for a pressure to six digits. The off-diagonal entries of A are
/// stored as float.
struct LinearSystem {
  std::vector<double> diagonal;
  WindowRows off_diagonal;
  std::vector<double> right_side;

  /// Closed bodies, that is, sets of unknowns that A determines only up to a constant: number of
  /// the body of each row, 0 for rows of none; empty if there are no such bodies. A solver removes
  /// these constants from what it adds to x.
  Buffer<std::uint32_t> closed_body;
  Index closed_bodies = 0;  ///< number of these bodies

  /// Positions of the unknowns, for preconditioners that use them; without points they are not
  /// used.
  struct Geometry {
    double spacing = 0;        ///< of the particles [m]
    double full_diagonal = 0;  ///< of an unknown with all its neighbours [unit of A]
    double second_moment = 0;  ///< Σ_j |a_ij| Δx²/spacing² over Σ_j |a_ij|, along an axis [-]
    Buffer<std::array<double, 3>> points;  ///< [m]
    Buffer<float> to_surface;              ///< Σ of the weights to points of given value
  };
  Geometry geometry;

  /// If processes share the unknowns.
  std::optional<SharedUnknowns> shared;
  /// Columns of A behind the own ones, for unknowns of other processes.
  Index columns_of_others = 0;

  Index size() const noexcept { return diagonal.size(); }
  /// Number of columns of A, also of the elements of a vector that it multiplies.
  Index columns() const noexcept { return size() + columns_of_others; }

  /// The sums of the values of all processes.
  template <std::size_t N>
  std::array<double, N> sum_of_all(std::array<double, N> own) const {
    if (shared) shared->sum(own);
    return own;
  }
  double sum_of_all(double own) const { return sum_of_all(std::array{own})[0]; }
  /// Sets the elements of a vector with columns() elements that are of other processes. To be called
  /// after a sum.
  void refresh(std::vector<double>& x) const {
    if (shared) shared->refresh(x);
  }

  /// f(i, (A x)_i) for the rows of one range of rows_together; x has columns() elements.
  template <class F>
  void multiply(Index first, Index last, std::span<const double> x, F&& f) const {
    off_diagonal.multiply(first, last, x,
                          [&](Index i, double sum) { f(i, diagonal[i] * x[i] + sum); });
  }

  /// Subtracts from v its mean over each closed body.
  void remove_constants(std::span<double> v) const {
    if (closed_bodies == 0) return;
    std::vector<double> sum(closed_bodies + 1, 0);
    std::vector<double> members(closed_bodies + 1, 0);
    for (Index row = 0; row < size(); ++row) {
      sum[closed_body[row]] += v[row];
      members[closed_body[row]] += 1;
    }
    if (shared) {
      shared->sum(sum);
      shared->sum(members);
    }
    for_each(size(), [&](Index row) {
      const Index body = closed_body[row];
      if (body > 0) v[row] -= sum[body] / members[body];
    });
  }
};

/// Solves a LinearSystem in place, with x as the initial guess. Models: ConjugateGradient,
/// EigenConjugateGradient.
template <class L>
concept LinearSolver = requires(L solver, const LinearSystem& system, std::vector<double>& x) {
  { solver.solve(system, x) } -> std::same_as<SolveReport>;
  solver.check();
};

}  // namespace silt
