// SPDX-License-Identifier: MIT
// The differential operators of MPS, [HwangLeePark2010] (4)–(7), (18); d is the dimension,
// r_ij = r_j − r_i, sums run over neighbours closer than the operator's radius re.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/operator/kernel.hpp>
#include <silt/mps/operator/lattice.hpp>

#include <algorithm>
#include <concepts>

namespace silt::mps {

/// A kernel with its effective radius, and its sums over the full lattice.
template <int Dim, class RealType, Kernel K>
struct Stencil {
  using Real = RealType;
  static constexpr int dimension = Dim;

  Real spacing = 0;    ///< l0 [m]
  Real re = 0;         ///< effective radius [m]
  Real per_re = 0;     ///< 1/re [1/m]
  Real n0 = 0;         ///< (5) [-]
  Real lambda = 0;     ///< (7) [m²]
  Real slope_sum = 0;  ///< −1/d Σ w'(r) r over the full lattice, of kernels with a slope [-]
  Real above = 0;        ///< Σ w of the neighbours on one side of a plane of particles [-]
  Real mean_height = 0;  ///< of these: Σ w h / Σ w [m]
  int neighbours = 0;  ///< N0 [-]
  [[no_unique_address]] K kernel = {};

  Stencil() = default;
  /// spacing is l0 [m], radius re/l0 [-].
  struct Size {
    double spacing;
    double radius;
  };
  /// Computes the sums. Throws as lattice_values() does.
  explicit Stencil(const Size& size, const K& with_kernel = {}) : kernel(with_kernel) {
    const LatticeValues values = lattice_values<Dim, K>(size.radius, kernel);
    spacing = Real(size.spacing);
    re = Real(size.radius * size.spacing);
    per_re = 1 / re;
    n0 = Real(values.n0);
    lambda = Real(values.lambda * size.spacing * size.spacing);
    slope_sum = Real(values.slope);
    above = Real(values.above);
    mean_height = Real(values.mean_height * size.spacing);
    neighbours = values.neighbours;
  }

  Real weight(Real r) const { return kernel.weight(r * per_re); }
  /// w'(r) [1/m].
  Real slope(Real r) const
    requires SmoothKernel<K>
  {
    return kernel.slope(r * per_re) * per_re;
  }
};

/// f(j, r_ij, w, w/r²) for every neighbour of i within the stencil.
template <class S, class T, class F>
void for_each_weighted(const S& search, Index i, const T& stencil, F&& f) {
  search.for_each_neighbour(i, [&](Index j, const auto& r_ij, auto r) {
    if (!(r < stencil.re)) return;
    const auto w = stencil.weight(r);
    f(j, r_ij, w, w / (r * r));
  });
}

/// Whether f(j, w) is true for any neighbour of i within the stencil.
template <class S, class T, class F>
bool any_weighted(const S& search, Index i, const T& stencil, F&& f) {
  bool any = false;
  for_each_weighted(search, i, stencil,
                    [&](Index j, const auto&, auto w, auto) { any |= f(j, w); });
  return any;
}

/// ⟨∇φ⟩_i = d/n0 Σ (φ_j − φ̂_i) r_ij w/r²,  φ̂_i the minimum over i and its neighbours
/// [HwangLeePark2010] (4). As a pressure gradient always repulsive; does not conserve momentum.
struct MinimumGradient {
  /// ⟨∇φ⟩_i [unit of φ per m]; for_each(f) calls f(φ_j, r_ij, w, w/r²).
  template <class T, class Real, class Neighbours>
  static Vec<T::dimension, Real> evaluate(const T& stencil, Real phi_i, Neighbours&& for_each) {
    using Vec = silt::Vec<T::dimension, Real>;
    Real min_phi = phi_i;
    for_each([&](Real phi_j, const Vec&, Real, Real) { min_phi = std::min(min_phi, phi_j); });
    Vec sum = Vec::Zero();
    for_each([&](Real phi_j, const Vec& r_ij, Real, Real w_r2) {
      sum += ((phi_j - min_phi) * w_r2) * r_ij;
    });
    return (T::dimension / stencil.n0) * sum;
  }
};

/// ⟨∇φ⟩_i = d/n0 Σ (φ_j + φ_i) r_ij w/r²: conserves momentum. Toyota et al. (2005),
/// [HwangLeePark2010] (18).
struct ConservingGradient {
  template <class T, class Real, class Neighbours>
  static Vec<T::dimension, Real> evaluate(const T& stencil, Real phi_i, Neighbours&& for_each) {
    using Vec = silt::Vec<T::dimension, Real>;
    Vec sum = Vec::Zero();
    for_each([&](Real phi_j, const Vec& r_ij, Real, Real w_r2) {
      sum += ((phi_j + phi_i) * w_r2) * r_ij;
    });
    return (T::dimension / stencil.n0) * sum;
  }
};

/// evaluate(stencil, φ_i, for_each) returns the gradient of a scalar at one particle.
template <class G, int Dim, class Real = double>
concept Gradient = requires(const G gradient, const Stencil<Dim, Real, CubicKernel> stencil,
                            Real phi) {
  {
    gradient.evaluate(stencil, phi, [](auto&& f) { f(Real(), Vec<Dim, Real>(), Real(), Real()); })
  } -> std::convertible_to<Vec<Dim, Real>>;
};

/// ⟨∇·u⟩_i = d/n0 Σ (u_j − u_i)·r_ij w/r² [1/s]; for_each(f) calls f(u_j, r_ij, w, w/r²)
template <class T, class Vec, class Neighbours>
typename T::Real divergence(const T& stencil, const Vec& u_i, Neighbours&& for_each) {
  // One sum per axis; the sum over the axes is left to the end.
  Vec sum = Vec::Zero();
  for_each([&](const Vec& u_j, const Vec& r_ij, auto, auto w_r2) {
    sum += (u_j - u_i).cwiseProduct(r_ij) * w_r2;
  });
  return T::dimension / stencil.n0 * sum.sum();
}

/// (1/n0) Dn_i/Dt = 1/n0 Σ w'(r) (u_j − u_i)·r_ij/r, [KhayyerGotoh2009] [1/s]
template <class T, class Vec, class Neighbours>
typename T::Real density_rate(const T& stencil, const Vec& u_i, Neighbours&& for_each) {
  typename T::Real sum = 0;
  for_each([&](const Vec& u_j, const Vec& r_ij, auto, auto) {
    const auto r = r_ij.norm();
    sum += stencil.slope(r) / r * (u_j - u_i).dot(r_ij);
  });
  return sum / stencil.n0;
}

/// ⟨∇²φ⟩_i = 2d/(λ n0) Σ (φ_j − φ_i) w     (6), with the usual n0 instead of the printed n_i
template <class T, class Value, class Neighbours>
Value laplacian(const T& stencil, const Value& phi_i, Neighbours&& for_each) {
  Value sum = phi_i - phi_i;
  for_each([&](const Value& phi_j, const auto&, auto w, auto) { sum += (phi_j - phi_i) * w; });
  return Value(sum * (2 * T::dimension / (stencil.lambda * stencil.n0)));
}

/// The values φ of the neighbours of i, as input of these operators.
template <class S, class T, class Values>
auto values_around(const S& search, const T& stencil, Index i, const Values& phi) {
  return [&search, &stencil, i, &phi](auto&& f) {
    for_each_weighted(search, i, stencil, [&](Index j, const auto& r_ij, auto w, auto w_r2) {
      f(phi[j], r_ij, w, w_r2);
    });
  };
}

/// The operators for the neighbours that a search finds.
template <class S, class T, class U>
auto divergence(const S& search, const T& stencil, Index i, const U& u) {
  return divergence(stencil, u[i], values_around(search, stencil, i, u));
}
template <class S, class T, class U>
auto density_rate(const S& search, const T& stencil, Index i, const U& u) {
  return density_rate(stencil, u[i], values_around(search, stencil, i, u));
}
template <class S, class T, class Values>
auto laplacian(const S& search, const T& stencil, Index i, const Values& phi) {
  return laplacian(stencil, phi[i], values_around(search, stencil, i, phi));
}

}  // namespace silt::mps
