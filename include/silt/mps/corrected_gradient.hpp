// SPDX-License-Identifier: MIT
// A gradient that is exact for linear φ and any arrangement of neighbours.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operators.hpp>

#include <Eigen/LU>

namespace silt::mps {

/// <∇φ>_i = C Σ (φ_j − φ_i) r_ij w/r²,  C⁻¹ = Σ r_ij r_ijᵀ w/r²: first-order consistent, as in
/// Khayyer and Gotoh (2011). Does not conserve momentum to round-off.
struct CorrectedGradient {
  /// Below this value of det (d/n0 C⁻¹) [-], which is 1 in the full lattice, C is nearly singular
  /// and is replaced by d/n0; in [0, 1].
  double min_determinant = 0.05;

  void check() const {
    require_between("CorrectedGradient: min_determinant", min_determinant, {0, 1});
  }
  /// C⁻¹ d/n0 of a particle. It depends on positions only, and serves for several φ.
  template <int Dim, class Real>
  struct Moments {
    Real determinant;
    Eigen::Matrix<Real, Dim, Dim> inverse;
  };

  template <class T, class Real, class Neighbours>
  Vec<T::dimension, Real> evaluate(const T& stencil, Real phi_i, Neighbours&& for_each) const {
    Moments<T::dimension, Real> moments;
    return evaluate(stencil, phi_i, for_each, moments);
  }
  /// The same, and returns the moments.
  template <class T, class Real, class Neighbours>
  [[gnu::flatten]] Vec<T::dimension, Real> evaluate(const T& stencil, Real phi_i,
                                                    Neighbours&& for_each,
                                                    Moments<T::dimension, Real>& found) const {
    using Vec = silt::Vec<T::dimension, Real>;
    using Matrix = Eigen::Matrix<Real, T::dimension, T::dimension>;
    Vec sum = Vec::Zero();
    Matrix moments = Matrix::Zero();
    for_each([&](Real phi_j, const Vec& r_ij, Real, Real w_r2) {
      sum += ((phi_j - phi_i) * w_r2) * r_ij;
      // Column by column: a product of vectors that gives a matrix is not inlined.
      const Vec weighted = w_r2 * r_ij;
      for (int k = 0; k < T::dimension; ++k) moments.col(k) += r_ij[k] * weighted;
    });
    moments *= T::dimension / stencil.n0;
    found.determinant = moments.determinant();
    found.inverse = moments.inverse();
    return corrected(stencil, sum, found);
  }
  /// The same with known moments, of the same neighbours.
  template <class T, class Real, class Neighbours>
  [[gnu::flatten]] Vec<T::dimension, Real> evaluate_with(
      const Moments<T::dimension, Real>& moments, const T& stencil, Real phi_i,
      Neighbours&& for_each) const {
    using Vec = silt::Vec<T::dimension, Real>;
    Vec sum = Vec::Zero();
    for_each([&](Real phi_j, const Vec& r_ij, Real, Real w_r2) {
      sum += ((phi_j - phi_i) * w_r2) * r_ij;
    });
    return corrected(stencil, sum, moments);
  }

 private:
  template <class T, class Real>
  Vec<T::dimension, Real> corrected(const T& stencil, Vec<T::dimension, Real> sum,
                                    const Moments<T::dimension, Real>& moments) const {
    sum *= T::dimension / stencil.n0;
    if (!(moments.determinant > Real(min_determinant))) return sum;
    return multiply<T::dimension, Real>(moments.inverse, sum);
  }
};

}  // namespace silt::mps
