// SPDX-License-Identifier: MIT
// A symmetric linear system as an interaction makes it and a solver takes it.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rows.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <vector>

namespace silt {

/// A x = b with A symmetric and positive definite, or semi-definite with b in its range. Always in
/// double: a pressure to six digits is beyond float.
struct LinearSystem {
  struct Entry {
    Index column;
    double value;
  };
  std::vector<double> diagonal;
  Rows<Entry> off_diagonal;
  std::vector<double> right_side;

  Index size() const noexcept { return diagonal.size(); }
};

/// Solves a LinearSystem in place, from the x it is given. Models: ConjugateGradient.
template <class L>
concept LinearSolver = requires(L solver, const LinearSystem& system, std::vector<double>& x) {
  { solver.solve(system, x) } -> std::same_as<SolveReport>;
  solver.check();
};

}  // namespace silt
