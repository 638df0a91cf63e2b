// SPDX-License-Identifier: MIT
// Stopping criteria of an iterative solver.
#pragma once

#include <silt/core/error.hpp>

namespace silt {

struct SolveSettings {
  double tolerance = 1e-6;    ///< |b − A x| ≤ tolerance |b| [-]
  int max_iterations = 5000;

  /// Throws if a setting is out of range.
  void check() const {
    require_positive("SolveSettings: tolerance", tolerance);
    require_positive("SolveSettings: max_iterations", max_iterations);
  }

  /// Whether the recomputed residual |b − A x| / |b| is within the tolerance, with a margin for
  /// round-off.
  bool is_met_by(double residual) const { return residual <= tolerance * (1 + 1e-3) + 1e-13; }
};

}  // namespace silt
