// SPDX-License-Identifier: MIT
// The velocity gradient of the fluid at a particle.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_MPS_OPERATOR_VELOCITY_GRADIENT
#define SILT_MPS_OPERATOR_VELOCITY_GRADIENT

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>

#include <Eigen/LU>

#include <type_traits>

namespace silt::mps {

/// A velocity gradient, unless the neighbours are nearly on a line or plane.
template <int Dim, class Real>
struct VelocityGradient {
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;

  Matrix value = Matrix::Zero();  ///< ∂u_a/∂x_b [1/s]; zero if it is not known
  bool is_known = false;          ///< false where neighbours are nearly on a line or plane
};

}  // namespace silt::mps

#define SILT_KERNELS_UP_TO_AVX2
#define SILT_KERNELS <silt/mps/operator/velocity_gradient.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::mps {

/// Least squares with the weights of the stencil, exact for linear flows. From the particles alone:
/// across a wall, the velocities of images may jump.
template <class U, class Operators>
auto velocity_gradient(const U& u, Index i, const Operators& operators) {
  return SILT_FOR_PROCESSOR_UP_TO_AVX2(velocity_gradient<U, Operators>)(u, i, operators);
}

}  // namespace silt::mps

#endif
#else

namespace silt::mps::SILT_INSTRUCTION_SET {

/// See above.
template <class U, class Operators>
[[gnu::flatten, gnu::noinline]] auto velocity_gradient(const U& u, Index i,
                                                       const Operators& operators) {
  const auto& stencil = operators.stencil();
  using Stencil = std::remove_cvref_t<decltype(stencil)>;
  using Real = typename Stencil::Real;
  constexpr int Dim = Stencil::dimension;
  using Vec = silt::Vec<Dim, Real>;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;
  constexpr Real least_determinant = Real(0.08);  // 1 if they are all around
  const Vec own = u[i];
  // Σ w r_a r_b, of which only a ≤ b is found, and Σ w u_a r_b, of four neighbours at a time.
  Four<Real> moments_of_four[Dim][Dim] = {}, gradient_of_four[Dim][Dim] = {};
  NeighbourPack<Dim, Real>::for_each(operators.neighbourhood(), i, [&](const auto& j) {
    FourVectors<Dim, Real> u_j{};
    j.get(u, u_j);
    for (int b = 0; b < Dim; ++b) {
      const Four<Real> weighted = j.weight * j.r_ij[b];
      for (int a = 0; a <= b; ++a) moments_of_four[a][b] += j.r_ij[a] * weighted;
      for (int a = 0; a < Dim; ++a) gradient_of_four[a][b] += (u_j[a] - own[a]) * weighted;
    }
  });
  Matrix moments, gradient;
  for (int b = 0; b < Dim; ++b) {
    for (int a = 0; a <= b; ++a) moments(a, b) = moments(b, a) = sum_of(moments_of_four[a][b]);
    for (int a = 0; a < Dim; ++a) gradient(a, b) = sum_of(gradient_of_four[a][b]);
  }
  const Real size = moments.trace();
  VelocityGradient<Dim, Real> found;
  if (!(size > 0)) return found;
  moments *= Dim / size;
  gradient *= Dim / size;
  if (!(moments.determinant() > least_determinant)) return found;
  const Matrix inverse = moments.inverse();
  for (int a = 0; a < Dim; ++a) {
    Vec row;
    for (int b = 0; b < Dim; ++b) row[b] = gradient(a, b);
    row = multiply<Dim, Real>(inverse, row);
    for (int b = 0; b < Dim; ++b) found.value(a, b) = row[b];
  }
  found.is_known = true;
  return found;
}

}  // namespace silt::mps::SILT_INSTRUCTION_SET

#endif
