// SPDX-License-Identifier: MIT
// The velocity gradient of the fluid at a particle.
#pragma once

#include <silt/core/types.hpp>
#include <silt/core/vec_pack.hpp>
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
  using Pack = VecPack<Dim, Real>;
  const auto& neighbourhood = operators.neighbourhood();
  const auto row = neighbourhood[i];
  Pack x_i, own;
  load_vec(neighbourhood.positions()[i], x_i);
  load_vec(u[i], own);
  SumOfOuterProducts<Dim, Real> sum_of_moments, sum_of_changes;
  Real size = 0;
  for (Index k = 0; k < row.size(); ++k) {
    const Index j = row.index[k];
    const Real w = Real(row.weight[k]);
    Pack r_ij, u_ij;
    load_vec(neighbourhood.positions()[j], r_ij);
    load_vec(u[j], u_ij);
    r_ij -= x_i;
    u_ij = w * (u_ij - own);
    const Pack weighted = w * r_ij;
    sum_of_moments.add(weighted, r_ij);
    sum_of_changes.add(u_ij, r_ij);
    size += dot_of<Dim, Real>(weighted, r_ij);
  }
  Matrix moments = sum_of_moments.value(), gradient = sum_of_changes.value();
  VelocityGradient<Dim, Real> found;
  if (!(size > 0)) return found;
  moments *= Dim / size;
  gradient *= Dim / size;
  if (!(moments.determinant() > least_determinant)) return found;
  const Matrix inverse = moments.inverse();
  for (int a = 0; a < Dim; ++a) {
    const Vec of_a = gradient.row(a).transpose();
    found.value.row(a) = multiply<Dim, Real>(inverse, of_a).transpose();
  }
  found.is_known = true;
  return found;
}

}  // namespace silt::mps
