// SPDX-License-Identifier: MIT
// Stopping criteria of an iterative solver.
#pragma once

#include <silt/core/error.hpp>

namespace silt {

/// When an iterative solve ends.
struct SolveSettings {
  double tolerance = 1e-6;  ///< |b − A x| ≤ tolerance |b| [-]; above 0 and at most 0.5
  /// Number of iterations after which a solve has not converged; above 0.
  int max_iterations = 5000;

  /// Throws if a setting is out of range.
  void check() const {
    // At a tolerance of 1, x = 0 is a solution.
    require_above("SolveSettings: tolerance", tolerance, {0, 0.5});
    require_positive("SolveSettings: max_iterations", max_iterations);
  }

  /// Whether the recomputed residual |b − A x| / |b| is within the tolerance, with a margin for
  /// round-off.
  bool is_met_by(double residual) const { return residual <= tolerance * (1 + 1e-3) + 1e-13; }
};

}  // namespace silt
