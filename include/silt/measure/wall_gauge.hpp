// SPDX-License-Identifier: MIT
// A pressure gauge at a point of a wall without particles.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace silt {

/// Extrapolates a scalar field of the fluid before a wall to a point of the wall: the linear function
/// with the least squared deviation from the particles within two spacings. Where they are few, as
/// when a drop passes, dry parts of the wall count as zero.
template <int Dim>
struct WallGauge {
  Vec<Dim> point = Vec<Dim>::Zero();   ///< on the wall [m]
  Vec<Dim> normal = Vec<Dim>::Zero();  ///< of the wall, into the fluid, of any length [-]
  double spacing = 0;                  ///< l0 [m]

  /// Σ_j w_j (a + b·(x_j − point) − φ_j)² + ε Σ_j w_j |b|² l0² is least, with w = (1 − (r/2 l0)²)²
  /// and ε = 0.005, because of which few particles give their mean, and a linear field has an error
  /// of up to 3 % of its change over a spacing. Returns a [unit of the field], not below 0, times Σ
  /// w_j over a quarter of that before a flat wall, if it is less: in a corner of three walls it is
  /// not. Of particles that processes share, all call it. Throws if the spacing is not positive or
  /// the normal zero.
  template <ParticleSet P, Field F>
  double read(const P& particles, F field) const {
    static_assert(P::dimension == Dim, "silt::WallGauge: the particles have another dimension");
    require_positive("WallGauge: spacing", spacing);
    require_finite("WallGauge: point", point);
    require_finite("WallGauge: normal", normal);
    if (!(normal.norm() > 0)) fail("WallGauge: normal = 0; give that of the wall, into the fluid");
    constexpr double range = 2;      // spacings
    constexpr double ridge = 0.005;  // ε
    // ∫ w dV before a flat wall over l0^Dim.
    constexpr double flat = (Dim == 2 ? 2.0 / 3 : 128.0 / 105) * std::numbers::pi;
    using Matrix = Eigen::Matrix<double, Dim, Dim>;
    const auto x = particles[position];
    const auto values = particles[field];
    double weights = 0, mean = 0;
    Vec<Dim> centre = Vec<Dim>::Zero(), slope = Vec<Dim>::Zero();
    Matrix moments = Matrix::Zero();
    for (Index j = 0; j < particles.size(); ++j) {
      const Vec<Dim> r = (x[j].template cast<double>() - point) / spacing;
      const double q2 = r.squaredNorm() / squared(range);
      if (!(q2 < 1) || !(r.dot(normal) > 0)) continue;
      const double w = squared(1 - q2), value = double(values[j]);
      weights += w;
      mean += w * value;
      centre += w * r;
      slope += (w * value) * r;
      for (int k = 0; k < Dim; ++k) moments.col(k) += (w * r[k]) * r;
    }
    for (const auto sum : {std::span(&weights, 1), std::span(&mean, 1), std::span(centre.data(), Dim),
                           std::span(slope.data(), Dim), std::span(moments.data(), Dim * Dim)}) {
      detail::replace_by_sums(particles, sum);
    }
    if (!(weights > 0)) return 0;
    // About the centre of the particles, a is the mean and independent of b.
    mean /= weights;
    centre /= weights;
    slope -= (weights * mean) * centre;
    for (int k = 0; k < Dim; ++k) moments.col(k) -= (weights * centre[k]) * centre;
    moments.diagonal().array() += ridge * weights;
    slope = multiply<Dim, double>(moments.inverse(), slope);
    return std::min(1.0, weights / (flat / 4)) * std::max(0.0, mean - slope.dot(centre));
  }
};

}  // namespace silt
