// SPDX-License-Identifier: MIT
// When an iterative solver stops.
#pragma once

#include <silt/core/error.hpp>

namespace silt {

struct SolveSettings {
  double tolerance = 1e-6;    ///< |b − A x| ≤ tolerance |b| [-]
  int max_iterations = 5000;

  /// Throws if a number is out of range.
  void check() const {
    require_positive("SolveSettings: tolerance", tolerance);
    require_positive("SolveSettings: max_iterations", max_iterations);
  }

  /// Whether x is good enough by its residual |b − A x| / |b|, recomputed: within a hundred rounding
  /// errors of the tolerance is as good as there.
  bool met_by(double residual) const { return residual <= tolerance * (1 + 1e-3) + 1e-13; }
};

}  // namespace silt
