// SPDX-License-Identifier: MIT
// Basic types: vectors, angular vectors, indices, ids.
#pragma once

#include <silt/core/eigen.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

// They remove checks for NaN and the rounding by which nearest images are found. clang has no macro
// for -fassociative-math: Simulation checks it.
#if defined(__FAST_MATH__) || defined(__ASSOCIATIVE_MATH__) || \
    (defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__)
#error "silt: compiled with -ffast-math, -Ofast, -funsafe-math-optimizations, -fassociative-math or \
-ffinite-math-only; use -O3 -fno-math-errno instead"
#endif

namespace silt {

/// A spatial vector: Dim components of type Real.
template <int Dim, class Real = double>
using Vec = Eigen::Matrix<Real, Dim, 1>;

/// Angular velocity, angle or torque: a number in 2D (counter-clockwise positive), a vector in 3D.
template <int Dim, class Real = double>
using AngularVec = std::conditional_t<Dim == 2, Real, Vec<3, Real>>;

/// Index of a particle in memory. It changes when particles are removed or reordered.
using Index = std::size_t;

/// Permanent identifier of a particle.
using Id = std::uint64_t;

/// No particle, no element: result of a search for an index that found none.
inline constexpr Index no_index = std::numeric_limits<Index>::max();

/// Zero of any type of a field or a history; Eigen does not initialise its types.
template <class Value>
Value zero_of() {
  if constexpr (requires { Value::Zero(); }) {
    return Value::Zero();
  } else {
    return Value{};
  }
}

namespace detail {

/// f of each component of a and b. Two numbers of double are one register, in which Eigen, too, keeps
/// them.
template <class Real, int Dim, class F>
[[gnu::always_inline]] inline Vec<Dim, Real> by_component(const Vec<Dim, Real>& a, const Vec<Dim, Real>& b, F f) {
  Vec<Dim, Real> result;
  if constexpr (Dim == 2 && std::is_same_v<Real, double>) {
    typedef double Both __attribute__((vector_size(16), may_alias));
    *reinterpret_cast<Both*>(result.data()) = f(*reinterpret_cast<const Both*>(a.data()), *reinterpret_cast<const Both*>(b.data()));
  } else {
    for (int k = 0; k < Dim; ++k) result.data()[k] = f(a.data()[k], b.data()[k]);
  }
  return result;
}
template <class Real, int Dim, class F>
[[gnu::always_inline]] inline Vec<Dim, Real> by_component(const Vec<Dim, Real>& a, Real s, F f) {
  Vec<Dim, Real> result;
  if constexpr (Dim == 2 && std::is_same_v<Real, double>) {
    typedef double Both __attribute__((vector_size(16), may_alias));
    *reinterpret_cast<Both*>(result.data()) = f(*reinterpret_cast<const Both*>(a.data()), Both{s, s});
  } else {
    for (int k = 0; k < Dim; ++k) result.data()[k] = f(a.data()[k], s);
  }
  return result;
}

template <class Real, int Dim>
concept OfSpace = std::is_floating_point_v<Real> && (Dim == 2 || Dim == 3);

}  // namespace detail

// Vectors of space are added, subtracted and scaled at once, and not by the expressions of Eigen,
// of which a program would have, and compile, as many types as it has formulas.
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> operator+(const Eigen::Matrix<Real, Dim, 1>& a, const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::by_component<Real, Dim>(a, b, [](auto x, auto y) { return x + y; });
}
template <class Real, int Dim>
  requires detail::OfSpace<Real, Dim>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> operator-(const Eigen::Matrix<Real, Dim, 1>& a, const Eigen::Matrix<Real, Dim, 1>& b) {
  return detail::by_component<Real, Dim>(a, b, [](auto x, auto y) { return x - y; });
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> operator*(const Eigen::Matrix<Real, Dim, 1>& a, S s) {
  return detail::by_component<Real, Dim>(a, Real(s), [](auto x, auto y) { return x * y; });
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> operator*(S s, const Eigen::Matrix<Real, Dim, 1>& a) {
  return detail::by_component<Real, Dim>(a, Real(s), [](auto x, auto y) { return x * y; });
}
template <class Real, int Dim, class S>
  requires detail::OfSpace<Real, Dim> && std::is_arithmetic_v<S>
[[gnu::always_inline]] inline Eigen::Matrix<Real, Dim, 1> operator/(const Eigen::Matrix<Real, Dim, 1>& a, S s) {
  return detail::by_component<Real, Dim>(a, Real(s), [](auto x, auto y) { return x / y; });
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
[[gnu::always_inline]] inline Vec<Dim, Real> multiply(const Eigen::Matrix<Real, Dim, Dim>& A, const Vec<Dim, Real>& v) {
  if constexpr (Dim == 2) {
    return {A(0, 0) * v[0] + A(0, 1) * v[1], A(1, 0) * v[0] + A(1, 1) * v[1]};
  } else {
    const auto row = [&](int k) { return A(k, 0) * v[0] + (A(k, 1) * v[1] + A(k, 2) * v[2]); };
    return {row(0), row(1), row(2)};
  }
}

/// Integer part of a quotient of times. Times are sums of time steps; the tolerance prevents a
/// rounding error from delaying an event by one step.
inline Index completed_intervals(double count) {
  constexpr double limit = double(std::numeric_limits<Index>::max() / 2);
  return static_cast<Index>(std::min(count * (1 + 1e-12), limit));
}

/// Resizes a std::vector. If it must grow, it reserves n/16 more elements, instead of doubling.
template <class Vector>
void resize_tightly(Vector& values, Index n) {
  if (n > values.capacity()) values.reserve(n + n / 16);
  values.resize(n);
}

/// Reserves memory for one more element of a std::vector: push_back() does not throw.
template <class Vector>
void reserve_one_more(Vector& values) {
  if (values.size() == values.capacity()) values.reserve(2 * values.size() + 16);
}

/// x².
template <class Real>
Real squared(Real x) {
  return x * x;
}

/// Number of components of an AngularVec: 1 in 2D, 3 in 3D.
template <int Dim>
inline constexpr int angular_size = Dim == 2 ? 1 : 3;

/// Component k of an AngularVec.
template <class Angular>
auto& component(Angular& spin, [[maybe_unused]] int k) {
  if constexpr (requires { spin[k]; }) {
    return spin[k];
  } else {
    return spin;
  }
}

/// A number or vector in double precision.
template <class Real>
double in_double(Real value)
  requires std::is_floating_point_v<Real>
{
  return double(value);
}
template <class Real, int Dim>
Vec<Dim, double> in_double(const Eigen::Matrix<Real, Dim, 1>& value) {
  return value.template cast<double>();
}

/// Scalar product of two angular vectors.
template <class Real>
Real dot(Real a, Real b)
  requires std::is_floating_point_v<Real>
{
  return a * b;
}
template <class Real>
Real dot(const Vec<3, Real>& a, const Vec<3, Real>& b) {
  return a.dot(b);
}

/// |ω|² in 2D or 3D.
template <class Angular>
auto squared_norm(const Angular& spin) {
  return dot(spin, spin);
}

}  // namespace silt
