// SPDX-License-Identifier: MIT
// A probe at a point in the fluid or on a wall.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <optional>

namespace silt {

/// Interpolates a scalar field linearly at a point, from the particles within one lattice spacing.
template <int Dim>
struct Probe {
  Vec<Dim> point = Vec<Dim>::Zero();  ///< [m]
  double spacing = 0;                 ///< l0 [m]: range along each axis

  /// Σ φ_j s_j / Σ s_j with the hat function s = Π_k (1 − |x_k − point_k|/l0), over the particles
  /// for which belongs(j) is true; empty if there are none. At a flat wall half a spacing behind
  /// the point, this is the linear interpolation along the wall. Of particles that
  /// processes share, all call it. Throws if the spacing is not positive.
  template <ParticleSet P, Field F, std::predicate<Index> Belongs>
  std::optional<double> read(const P& particles, F field, Belongs&& belongs) const {
    static_assert(P::dimension == Dim, "silt::Probe: the particles have another dimension");
    require_positive("Probe: spacing", spacing);
    require_finite("Probe: point", point);
    const auto x = particles[position];
    const auto values = particles[field];
    double of_own = 0;
    double shares_of_own = 0;
    for (Index j = 0; j < particles.size(); ++j) {
      double share = 1;
      for (int k = 0; k < Dim && share > 0; ++k) {
        share *= std::max(0.0, 1 - std::abs(double(x[j][k]) - point[k]) / spacing);
      }
      if (!(share > 0) || !belongs(j)) continue;
      of_own += share * double(values[j]);
      shares_of_own += share;
    }
    const auto [sum, shares] =
        detail::sum_of_all(particles, std::array{of_own, shares_of_own});
    if (!(shares > 0)) return std::nullopt;
    return sum / shares;
  }
};

}  // namespace silt
