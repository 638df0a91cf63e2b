// SPDX-License-Identifier: MIT
// Reference values of a kernel on the full square (cubic) lattice, which normalise the operators.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/kernel.hpp>

#include <cmath>

namespace silt::mps {

/// Sums of a kernel over the neighbours on the full lattice; see lattice_values().
struct LatticeValues {
  double n0 = 0;          ///< number density Σ w, (5) [-]
  double lambda = 0;      ///< Σ w r² / Σ w over l0², (7) [-]
  double slope = 0;       ///< −1/d Σ w'(r) r, of kernels with a slope [-]
  double above = 0;       ///< Σ w of the points on one side of a plane of points [-]
  double mean_height = 0; ///< Σ w h / Σ w of them, over l0 [-]; h is the distance from the plane
  int neighbours = 0;     ///< N0, the number of neighbours, (17) [-]
};

/// Sums over all lattice points with 0 < r < re; `radius` is re/l0. Throws unless it is above 1
/// and at most 100.
template <int Dim, Kernel K>
LatticeValues lattice_values(double radius, const K& kernel = {}) {
  // Within a radius of 1 there is no neighbour; the sums over a very large one would never end.
  require_above("lattice_values: radius", radius, {1, 100});
  LatticeValues values;
  double second_moment = 0;
  const int reach = static_cast<int>(std::ceil(radius));
  const int depth = Dim == 3 ? reach : 0;
  for (int z = -depth; z <= depth; ++z) {
    for (int y = -reach; y <= reach; ++y) {
      for (int x = -reach; x <= reach; ++x) {
        const double r2 = double(x * x + y * y + z * z);
        if (r2 == 0 || r2 >= radius * radius) continue;
        const double w = kernel.weight(std::sqrt(r2) / radius);
        values.n0 += w;
        second_moment += w * r2;
        if constexpr (SmoothKernel<K>) {
          const double q = std::sqrt(r2) / radius;
          values.slope -= kernel.slope(q) * q / Dim;
        }
        if (y > 0) {
          values.above += w;
          values.mean_height += w * y;
        }
        ++values.neighbours;
      }
    }
  }
  values.lambda = second_moment / values.n0;
  values.mean_height /= values.above;
  return values;
}

}  // namespace silt::mps
