// SPDX-License-Identifier: MIT
// Vectors of space, and their operators. They take the place of Eigen's expressions of such
// vectors, of which a program would have, and compile, as many types as it has formulas. Their
// results are vectors: a further expression of one, such as (a - b).head<2>(), must not be kept in
// an `auto`.
#pragma once

#include <silt/core/eigen.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace silt {

/// A spatial vector: Dim components of type Real.
template <int Dim, class Real = double>
using Vec = Eigen::Matrix<Real, Dim, 1>;

namespace detail {

// Not of lanes (core/lane.hpp): the loop over the contacts of a bed took 1.8 times as long, since g++
// vectorises it with Eigen's expressions only.
template <class Real, int Dim>
concept OfSpace = std::is_floating_point_v<Real> && (Dim == 2 || Dim == 3);

// Eigen, too, keeps two doubles in one register. Its vectors are aligned to one, unless a macro of
// Eigen forbids it.
typedef double Two __attribute__((vector_size(16), aligned(8), may_alias));
[[gnu::always_inline]] inline Two two(const Vec<2>& a) {
  return *reinterpret_cast<const Two*>(a.data());
}
[[gnu::always_inline]] inline Two two(double s) { return Two{s, s}; }

template <class Real, int Dim>
[[gnu::always_inline]] inline Real number_at(const Eigen::Matrix<Real, Dim, 1>& a, int k) {
  return a.data()[k];
}
template <class Real>
[[gnu::always_inline]] inline Real number_at(Real s, int) {
  return s;
}

/// f(a_k, b_k) for each component k; b may be a number.
template <class F, class Real, int Dim, class B>
[[gnu::always_inline]] inline Vec<Dim, Real> by_component(const Eigen::Matrix<Real, Dim, 1>& a,
                                                          const B& b, F f) {
  Vec<Dim, Real> result;
  if constexpr (Dim == 2 && std::is_same_v<Real, double>) {
    *reinterpret_cast<Two*>(result.data()) = f(two(a), two(b));
  } else {
    for (int k = 0; k < Dim; ++k) result.data()[k] = f(number_at(a, k), number_at(b, k));
  }
  return result;
}

}  // namespace detail

template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
[[gnu::always_inline]] inline Vec<Dim, Real> operator+(const Eigen::Matrix<Real, Dim, 1>& a,
                                                       const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::by_component(a, b, [](auto x, auto y) { return x + y; });
}
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
[[gnu::always_inline]] inline Vec<Dim, Real> operator-(const Eigen::Matrix<Real, Dim, 1>& a,
                                                       const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::by_component(a, b, [](auto x, auto y) { return x - y; });
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Vec<Dim, Real> operator*(const Eigen::Matrix<Real, Dim, 1>& a, S s) {
  return detail::by_component(a, Real(s), [](auto x, auto y) { return x * y; });
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Vec<Dim, Real> operator*(S s, const Eigen::Matrix<Real, Dim, 1>& a) {
  return a * s;
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Vec<Dim, Real> operator/(const Eigen::Matrix<Real, Dim, 1>& a, S s) {
  return detail::by_component(a, Real(s), [](auto x, auto y) { return x / y; });
}
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
[[gnu::always_inline]] inline Vec<Dim, Real> operator-(const Eigen::Matrix<Real, Dim, 1>& a) {
  return detail::by_component(a, Real(0), [](auto x, auto) { return -x; });
}
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
bool operator==(const Eigen::Matrix<Real, Dim, 1>& a, const Eigen::Matrix<Real, Dim, 1>& b) {
  for (int k = 0; k < Dim; ++k) {
    if (a[k] != b[k]) return false;
  }
  return true;
}

/// The largest component of a without its sign; those that are not numbers do not count.
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
Real max_norm(const Eigen::Matrix<Real, Dim, 1>& a) {
  Real most = 0;
  for (int k = 0; k < Dim; ++k) most = std::max(most, std::abs(a[k]));
  return most;
}

/// Cross product a × b; in 2D its out-of-plane component.
template <class Real>
Real cross(const Vec<2, Real>& arm, const Vec<2, Real>& force) {
  return arm[0] * force[1] - arm[1] * force[0];
}
template <class Real>
Vec<3, Real> cross(const Vec<3, Real>& arm, const Vec<3, Real>& force) {
  return {arm[1] * force[2] - arm[2] * force[1], arm[2] * force[0] - arm[0] * force[2],
          arm[0] * force[1] - arm[1] * force[0]};
}

/// Velocity ω × a of a point of a rotating body, at the vector a from its centre.
template <class Real>
Vec<2, Real> cross(Real spin, const Vec<2, Real>& arm) {
  return {-spin * arm[1], spin * arm[0]};
}

/// Product A v. Eigen's product uses fused multiply-adds on processors that have them, regardless
/// of compiler options, and its last bits would therefore depend on the processor.
template <int Dim, class Real>
[[gnu::always_inline]] inline Vec<Dim, Real> multiply(const Eigen::Matrix<Real, Dim, Dim>& A,
                                                      const Vec<Dim, Real>& v) {
  if constexpr (Dim == 2) {
    return {A(0, 0) * v[0] + A(0, 1) * v[1], A(1, 0) * v[0] + A(1, 1) * v[1]};
  } else {
    const auto row = [&](int k) { return A(k, 0) * v[0] + (A(k, 1) * v[1] + A(k, 2) * v[2]); };
    return {row(0), row(1), row(2)};
  }
}

}  // namespace silt
