// SPDX-License-Identifier: MIT
// The velocity gradient of the fluid at a particle.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/operators.hpp>

#include <Eigen/LU>

#include <type_traits>

namespace silt::mps {

/// A velocity gradient, unless the neighbours are nearly on a line or plane.
template <int Dim, class Real>
struct VelocityGradient {
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;

  Matrix value = Matrix::Zero();  ///< ∂u_a/∂x_b [1/s]; zero if it is not known
  bool is_known = false;
};

/// Least squares with the weights of the stencil, exact for linear flows. From the particles alone:
/// across a wall, the velocities of images may jump.
template <class U, class Operators>
[[gnu::flatten]] auto velocity_gradient(const U& u, Index i, const Operators& operators) {
  const auto& stencil = operators.stencil();
  using Stencil = std::remove_cvref_t<decltype(stencil)>;
  using Real = typename Stencil::Real;
  constexpr int Dim = Stencil::dimension;
  using Vec = silt::Vec<Dim, Real>;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;
  constexpr Real least_determinant = Real(0.08);  // 1 if they are all around
  const Vec own = u[i];
  Matrix moments = Matrix::Zero(), gradient = Matrix::Zero();
  Real size = 0;
  for_each_weighted(operators.neighbourhood(), i, stencil,
                    [&](Index j, const Vec& r_ij, Real w, Real) {
                      const Vec u_ij = w * (u[j] - own);
                      const Vec weighted = w * r_ij;
                      // Column by column: products of vectors that give a matrix are not inlined.
                      for (int b = 0; b < Dim; ++b) {
                        moments.col(b) += r_ij[b] * weighted;
                        gradient.col(b) += r_ij[b] * u_ij;
                      }
                      size += weighted.dot(r_ij);
                    });
  VelocityGradient<Dim, Real> found;
  if (!(size > 0)) return found;
  moments *= Dim / size;
  gradient *= Dim / size;
  if (!(moments.determinant() > least_determinant)) return found;
  const Matrix inverse = moments.inverse();
  for (int a = 0; a < Dim; ++a) {
    const Vec row = gradient.row(a).transpose();
    found.value.row(a) = multiply<Dim, Real>(inverse, row).transpose();
  }
  found.is_known = true;
  return found;
}

}  // namespace silt::mps
