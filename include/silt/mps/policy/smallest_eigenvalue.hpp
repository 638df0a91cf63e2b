// SPDX-License-Identifier: MIT
// The smallest eigenvalue of a small symmetric matrix, in closed form. Eigen's own is in a header that
// takes longer to compile than all others of it that a flow needs.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace silt::mps::detail {

/// Of a symmetric matrix M, of which only the diagonal and what is below it are read. In 2D, half the
/// trace less half √((M₀₀ − M₁₁)² + 4 M₁₀²).
template <class Real>
Real smallest_root(const Eigen::Matrix<Real, 2, 2>& M) {
  const Real distance = Real(0.5) * std::sqrt(squared(M(0, 0) - M(1, 1)) + 4 * squared(M(1, 0)));
  return Real(0.5) * (M(0, 0) + M(1, 1)) - distance;
}
/// In 3D, the smallest root of the characteristic equation x³ − c₂ x² + c₁ x − c₀ = 0, by the cosine of
/// a third of an angle.
template <class Real>
Real smallest_root(const Eigen::Matrix<Real, 3, 3>& M) {
  const Real third = Real(1) / Real(3);
  const Real c0 = M(0, 0) * M(1, 1) * M(2, 2) + 2 * M(1, 0) * M(2, 0) * M(2, 1) -
                  M(0, 0) * M(2, 1) * M(2, 1) - M(1, 1) * M(2, 0) * M(2, 0) -
                  M(2, 2) * M(1, 0) * M(1, 0);
  const Real c1 = M(0, 0) * M(1, 1) - M(1, 0) * M(1, 0) + M(0, 0) * M(2, 2) -
                  M(2, 0) * M(2, 0) + M(1, 1) * M(2, 2) - M(2, 1) * M(2, 1);
  const Real c2 = M(0, 0) + M(1, 1) + M(2, 2);
  const Real mean = c2 * third;
  const Real a = std::max((c2 * mean - c1) * third, Real(0));
  const Real half_b = Real(0.5) * (c0 + mean * (2 * mean * mean - c1));
  const Real q = std::max(a * a * a - half_b * half_b, Real(0));
  const Real angle = std::atan2(std::sqrt(q), half_b) * third;
  return mean - std::sqrt(a) * (std::cos(angle) + std::sqrt(Real(3)) * std::sin(angle));
}

/// The smallest eigenvalue of a symmetric matrix, of which only the diagonal and what is below it are
/// read.
template <class Real, int Dim>
Real smallest_eigenvalue(Eigen::Matrix<Real, Dim, Dim> M) {
  // Without its mean, and of the size of 1, for small round-off.
  const Real mean = M.trace() / Real(Dim);
  M.diagonal().array() -= mean;
  Real size = 0;
  for (int j = 0; j < Dim; ++j) {
    for (int i = j; i < Dim; ++i) size = std::max(size, std::abs(M(i, j)));
  }
  if (size > 0) M /= size;
  return smallest_root(M) * size + mean;
}

}  // namespace silt::mps::detail
