// SPDX-License-Identifier: MIT
// The words every other header speaks: vectors, spins, indices, ids.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace silt {

/// A vector of space: Dim components of Real.
template <int Dim, class Real = double>
using Vec = Eigen::Matrix<Real, Dim, 1>;

/// Angular velocity, angle or torque: one number in the plane (counter-clockwise positive), a vector
/// in space.
template <int Dim, class Real = double>
using AngularVec = std::conditional_t<Dim == 2, Real, Vec<3, Real>>;

/// Place of a particle in memory. It changes when particles are removed or reordered.
using Index = std::size_t;

/// Name of a particle for life.
using Id = std::uint64_t;

inline constexpr Index no_index = std::numeric_limits<Index>::max();

/// Zero of any type that a particle or a pair may hold; Eigen's own start with anything.
template <class Value>
Value zero_of() {
  if constexpr (requires { Value::Zero(); }) {
    return Value::Zero();
  } else {
    return Value{};
  }
}

/// Cross product a × b: in the plane the number that is its component out of the plane.
template <class Real>
Real cross(const Vec<2, Real>& arm, const Vec<2, Real>& force) {
  return arm[0] * force[1] - arm[1] * force[0];
}
template <class Real>
Vec<3, Real> cross(const Vec<3, Real>& arm, const Vec<3, Real>& force) {
  return {arm[1] * force[2] - arm[2] * force[1], arm[2] * force[0] - arm[0] * force[2],
          arm[0] * force[1] - arm[1] * force[0]};
}

/// Velocity ω × a of the point at the arm a of a body with the angular velocity ω.
template <class Real>
Vec<2, Real> cross(Real spin, const Vec<2, Real>& arm) {
  return {-spin * arm[1], spin * arm[0]};
}

/// Whole part of a count that comes from times. They are sums of time steps: a rounding must not
/// put an event off by a step.
inline Index completed_intervals(double count) { return static_cast<Index>(count * (1 + 1e-12)); }

/// Resizes a std::vector; where it must grow, a sixteenth more than asked for, not
/// twofold as of itself.
template <class Vector>
void resize_sparingly(Vector& values, Index n) {
  if (n > values.capacity()) values.reserve(n + n / 16);
  values.resize(n);
}

template <class Real>
Real squared(Real x) {
  return x * x;
}

/// Numbers of a spin: one in 2D, three in 3D.
template <int Dim>
inline constexpr int angular_size = Dim == 2 ? 1 : 3;

/// Number k of a spin.
template <class Turning>
auto& component(Turning& spin, [[maybe_unused]] int k) {
  if constexpr (requires { spin[k]; }) {
    return spin[k];
  } else {
    return spin;
  }
}

/// A number, vector or spin in double precision.
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

/// Product of two spins, or of a couple and a spin.
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

/// |w|² of a spin in either dimension.
template <class Real>
Real squared_norm(Real spin)
  requires std::is_floating_point_v<Real>
{
  return spin * spin;
}
template <class Real>
Real squared_norm(const Vec<3, Real>& spin) {
  return spin.squaredNorm();
}

}  // namespace silt
