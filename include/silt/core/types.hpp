// SPDX-License-Identifier: MIT
// Basic types: vectors, angular vectors, indices, ids.
#pragma once

#include <silt/core/vectors.hpp>

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

/// Integer part of a quotient of times. Times are sums of time steps; the tolerance prevents a
/// rounding error from delaying an event by one step.
inline Index completed_intervals(double count) {
  constexpr double limit = double(std::numeric_limits<Index>::max() / 2);
  return static_cast<Index>(std::min(count * (1 + 1e-12), limit));
}

/// Reserves memory for n elements of an array, and n/16 more if it must grow.
template <class Vector>
void reserve_tightly(Vector& values, Index n) {
  if (n > values.capacity()) values.reserve(n + n / 16);
}

/// Resizes an array. If it must grow, it reserves n/16 more elements, instead of doubling.
template <class Vector>
void resize_tightly(Vector& values, Index n) {
  reserve_tightly(values, n);
  values.resize(n);
}

/// Reserves memory for one more element of an array: push_back() does not throw.
template <class Vector>
void reserve_one_more(Vector& values) {
  if (values.size() == values.capacity()) values.reserve(2 * values.size() + 16);
}

/// x².
template <class Real>
Real squared(Real x) {
  return x * x;
}

// Choices that g++ vectorises for Lane<Real>, too. It does not vectorise branches with arithmetic,
// except for AVX-512, nor std::max, which returns a reference, together with other branches.
/// a if the condition holds, else b; both are computed before.
template <class Real>
constexpr Real choose(bool condition, Real a, Real b) {
  if constexpr (requires { Real::choose(condition, a, b); }) {
    return Real::choose(condition, a, b);
  } else {
    return condition ? a : b;
  }
}
/// The larger number; a if they are equal.
template <class Real>
constexpr Real larger(Real a, Real b) {
  return choose(a < b, b, a);
}
/// The smaller number; a if they are equal.
template <class Real>
constexpr Real smaller(Real a, Real b) {
  return choose(b < a, b, a);
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
