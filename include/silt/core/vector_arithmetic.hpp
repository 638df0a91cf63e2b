// SPDX-License-Identifier: MIT
// Sums, differences and multiples of vectors of fixed size, which are vectors themselves. Eigen has a
// type for each expression, such as a + 2 (b - c), and compiles sixty functions for it: a fifth of a
// program. The results have the same bits. Code in namespace silt uses these, for Eigen's types alone.
#pragma once

#include <silt/core/eigen.hpp>

#include <concepts>
#include <type_traits>

namespace silt {

/// Vectors of two or three floating-point numbers.
template <class Real, int Dim>
concept OfSpace = std::floating_point<Real> && (Dim == 2 || Dim == 3);
/// Factors that do not change the precision of a vector.
template <class Factor, class Real>
concept FactorOf = std::same_as<Factor, Real> || std::integral<Factor>;

namespace detail {
/// The vector with the components f(0), f(1) …, without a loop, which would take time to compile.
template <class Real, int Dim, class F>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> components(F f) {
  Eigen::Matrix<Real, Dim, 1> vector;
  Real* const x = vector.data();
  x[0] = f(0);
  x[1] = f(1);
  if constexpr (Dim == 3) x[2] = f(2);
  return vector;
}
}  // namespace detail

template <class Real, int Dim>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator+(const Eigen::Matrix<Real, Dim, 1>& a,
                                      const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::components<Real, Dim>([&](int k) { return a.data()[k] + b.data()[k]; });
}
template <class Real, int Dim>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator-(const Eigen::Matrix<Real, Dim, 1>& a,
                                      const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::components<Real, Dim>([&](int k) { return a.data()[k] - b.data()[k]; });
}
template <class Real, int Dim>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator-(const Eigen::Matrix<Real, Dim, 1>& a) {
  return detail::components<Real, Dim>([&](int k) { return -a.data()[k]; });
}
template <class Real, int Dim, FactorOf<Real> Factor>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator*(Factor factor, const Eigen::Matrix<Real, Dim, 1>& a) {
  return detail::components<Real, Dim>([&](int k) { return Real(factor) * a.data()[k]; });
}
template <class Real, int Dim, FactorOf<Real> Factor>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator*(const Eigen::Matrix<Real, Dim, 1>& a, Factor factor) {
  return factor * a;
}
template <class Real, int Dim, FactorOf<Real> Divisor>
  requires OfSpace<Real, Dim>
Eigen::Matrix<Real, Dim, 1> operator/(const Eigen::Matrix<Real, Dim, 1>& a, Divisor divisor) {
  return detail::components<Real, Dim>([&](int k) { return a.data()[k] / Real(divisor); });
}

}  // namespace silt
