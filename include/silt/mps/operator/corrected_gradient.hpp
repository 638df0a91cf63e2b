// SPDX-License-Identifier: MIT
// A gradient that is exact for linear φ and any arrangement of neighbours.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>
#include <silt/mps/operator/operators.hpp>

#include <Eigen/LU>

namespace silt::mps {

/// ⟨∇φ⟩_i = C Σ (φ_j − φ_i) r_ij w/r²,  C⁻¹ = Σ r_ij r_ijᵀ w/r²: first-order consistent, as in
/// [KhayyerGotoh2011]. Does not conserve momentum to round-off.
struct CorrectedGradient {
  /// Below this value of det (d/n0 C⁻¹) [-], which is 1 in the full lattice, C is nearly singular
  /// and is replaced by d/n0; in [0, 1].
  double min_determinant = 0.05;

  void check() const {
    require_between("CorrectedGradient: min_determinant", min_determinant, {0, 1});
  }
  /// Of the neighbours of a particle: depends on positions only, and serves for several φ.
  template <int Dim, class Real>
  struct Moments {
    Real determinant;                       ///< of C⁻¹ d/n0 [-]
    Eigen::Matrix<Real, Dim, Dim> inverse;  ///< of C⁻¹ d/n0 [-]
    Vec<Dim, Real> first;                   ///< Σ w r_ij/r² [1/m]
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
    Sums<T::dimension, Real, true> sums{.phi_i = phi_i};
    for_each(sums);
    const Eigen::Matrix<Real, T::dimension, T::dimension> moments =
        (T::dimension / stencil.n0) * sums.moments();
    found.determinant = moments.determinant();
    found.inverse = moments.inverse();
    found.first = sums.first();
    return corrected(stencil, sums.rise(), found);
  }
  /// The same with known moments, of the same neighbours.
  template <class T, class Real, class Neighbours>
  [[gnu::flatten]] Vec<T::dimension, Real> evaluate_with(
      const Moments<T::dimension, Real>& moments, const T& stencil, Real phi_i,
      Neighbours&& for_each) const {
    Sums<T::dimension, Real, false> sums{.phi_i = phi_i};
    for_each(sums);
    return corrected(stencil, sums.rise(), moments);
  }

 private:
  // Σ (φ_j − φ_i) r_ij w/r², and the sums for the moments, of neighbours one by one and of four at
  // a time.
  template <int Dim, class Real, bool has_moments>
  struct Sums {
    using Vec = silt::Vec<Dim, Real>;
    template <class Number>
    struct Part {
      Number rise[Dim] = {};
      Number moments[Dim][Dim] = {};  // Σ r_ij r_ijᵀ w/r², a ≤ b
      Number first[Dim] = {};         // Σ r_ij w/r²

      [[gnu::always_inline]] void add(const Number& phi_ij, const auto& r_ij, const Number& w_r2) {
        for (int b = 0; b < Dim; ++b) {
          const Number weighted = w_r2 * r_ij[b];
          rise[b] += phi_ij * weighted;
          if constexpr (has_moments) {
            for (int a = 0; a <= b; ++a) moments[a][b] += r_ij[a] * weighted;
            first[b] += weighted;
          }
        }
      }
    };

    Real phi_i;
    Part<Real> one{};
    Part<Four<Real>> four{};

    [[gnu::always_inline]] void operator()(Real phi_j, const Vec& r_ij, Real, Real w_r2) {
      one.add(phi_j - phi_i, r_ij, w_r2);
    }
    [[gnu::always_inline]] void operator()(const Four<Real>& phi_j,
                                           const FourVectors<Dim, Real>& r_ij, const Four<Real>&,
                                           const Four<Real>& w_r2) {
      four.add(phi_j - phi_i, r_ij, w_r2);
    }
    Vec rise() const { return sum_of_parts(one.rise, four.rise); }
    Vec first() const { return sum_of_parts(one.first, four.first); }
    auto moments() const {
      Eigen::Matrix<Real, Dim, Dim> sum;
      for (int b = 0; b < Dim; ++b) {
        for (int a = 0; a <= b; ++a) {
          sum(a, b) = sum(b, a) = one.moments[a][b] + sum_of(four.moments[a][b]);
        }
      }
      return sum;
    }

   private:
    static Vec sum_of_parts(const Real (&of_one)[Dim], const Four<Real> (&of_four)[Dim]) {
      Vec sum;
      for (int b = 0; b < Dim; ++b) sum[b] = of_one[b] + sum_of(of_four[b]);
      return sum;
    }
  };

  template <class T, class Real>
  Vec<T::dimension, Real> corrected(const T& stencil, Vec<T::dimension, Real> sum,
                                    const Moments<T::dimension, Real>& moments) const {
    sum *= T::dimension / stencil.n0;
    if (!(moments.determinant > Real(min_determinant))) return sum;
    return multiply<T::dimension, Real>(moments.inverse, sum);
  }
};

}  // namespace silt::mps
