// SPDX-License-Identifier: MIT
// The rotation of a rigid body without torque, by the implicit midpoint rule for the angular
// momentum m in the frame of the body, and the Cayley transform of the same mean spin for the
// orientation [AustinKrishnaprasadWang1993]:
//
//   m' − m = Δt m̄ × Θ⁻¹ m̄,   m̄ = (m + m')/2,   Q' = Q cay(Δt Θ⁻¹ m̄)
//
// It keeps the angular momentum Q m in space and the energy ½ m·Θ⁻¹ m, and its orientation has an
// error of order Δt². Without torque only Q changes, as Q m is given.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/geometry/mass_properties.hpp>
#include <silt/geometry/orientation.hpp>

#include <cmath>
#include <limits>

namespace silt {

/// A free rotation during a time step.
template <int Dim>
struct FreeRotation {
  Orientation<Dim> end;                               ///< of the body
  AngularVec<Dim> spin = zero_of<AngularVec<Dim>>();  ///< the mean one [1/s]
};

/// The inverse of a moment of inertia [1/(kg m²)].
inline double inverse_of(double theta) { return 1 / theta; }
/// Symmetric to the last bit.
inline Eigen::Matrix<double, 3, 3> inverse_of(const Eigen::Matrix<double, 3, 3>& a) {
  // The rows of the adjugate of a symmetric matrix are cross products of its columns.
  const Vec<3> x = a.col(0), y = a.col(1), z = a.col(2);
  const Vec<3> yz = cross(y, z), zx = cross(z, x), xy = cross(x, y);
  const double scale = 1 / x.dot(yz);
  Eigen::Matrix<double, 3, 3> inverse;
  inverse << yz[0], yz[1], yz[2], yz[1], zx[1], zx[2], yz[2], zx[2], xy[2];
  return inverse * scale;
}

/// The rotation at a constant spin [1/s] in dt [s]: in 3D by the Cayley transform, as below.
inline FreeRotation<2> turn_with(const Orientation<2>& from, double rate, double dt) {
  return {from.turned(rate * dt), rate};
}
[[gnu::always_inline]] inline FreeRotation<3> turn_with(const Orientation<3>& from,
                                                        const Vec<3>& rate, double dt) {
  // cay(Δt ω) is the unit quaternion along (1, Δt ω/2).
  const Vec<3> v = dt / 2 * rate;
  const double w0 = from.quaternion[0];
  const Vec<3> v0 = from.quaternion.tail<3>();
  const double w1 = w0 - v.dot(v0);
  const Vec<3> v1 = v0 + w0 * v + cross(v, v0);
  const double scale = 1 / std::sqrt(w1 * w1 + v1.squaredNorm());
  FreeRotation<3> rotation{.end = {}, .spin = rate};
  rotation.end.quaternion[0] = scale * w1;
  for (int k = 0; k < 3; ++k) rotation.end.quaternion[k + 1] = scale * v1[k];
  return rotation;
}

/// The rotation of a disc or a body in the plane with this angular momentum [kg m²/s] in dt [s].
inline FreeRotation<2> rotate_freely(const Orientation<2>& from, const Eigen::Matrix<double, 2, 2>&,
                                     double momentum, double inverse_inertia, double dt) {
  return turn_with(from, momentum * inverse_inertia, dt);
}

namespace detail {
/// Of Newton's iteration, by Cramer's rule.
[[gnu::cold]] inline Vec<3> newton_step(const Vec<3>& f, const Vec<3>& mean, const Vec<3>& rate,
                                        const Eigen::Matrix<double, 3, 3>& inverse_inertia,
                                        double dt) {
  Eigen::Matrix<double, 3, 3> slope;
  for (int k = 0; k < 3; ++k) {
    const Vec<3> e = Vec<3>::Unit(k);
    slope.col(k) = e - dt / 2 * (cross(e, rate) + cross(mean, Vec<3>(inverse_inertia.col(k))));
  }
  const Vec<3> a = slope.col(0), b = slope.col(1), c = slope.col(2);
  const Vec<3> bc = cross(b, c);
  return 1 / a.dot(bc) * Vec<3>(f.dot(bc), f.dot(cross(c, a)), f.dot(cross(a, b)));
}
/// m̄ of a body with the angular momentum m, both in its frame.
[[gnu::always_inline]] inline Vec<3> mean_momentum(
    const Vec<3>& m, const Eigen::Matrix<double, 3, 3>& inverse_inertia, double dt) {
  constexpr double round_off = 4 * std::numeric_limits<double>::epsilon();
  const double size = max_norm(m);
  const double stiffest = inverse_inertia.cwiseAbs().maxCoeff();
  const double enough = round_off * size * (1 + std::abs(dt) * stiffest * size);
  Vec<3> mean = m;
  bool is_simple = true;
  double last = std::numeric_limits<double>::infinity();
  constexpr int most = 50;
  for (int iterations = 0;; ++iterations) {
    const Vec<3> rate = multiply(inverse_inertia, mean);
    const Vec<3> f = mean - m - dt / 2 * cross(mean, rate);
    const double rest = max_norm(f);
    if (!(rest > enough)) return mean;  // nor if it is not a number, which the step finds
    if (iterations == most) {
      fail({"a body turns by ", rate.norm() * std::abs(dt), " rad in a step of ", std::abs(dt),
            " s; lower the time step"});
    }
    // Nearly all steps are short, so that this converges by some digits at once.
    if (is_simple && rest > last / 4) {
      is_simple = false;
      mean = m;
      continue;
    }
    last = rest;
    mean -= is_simple ? f : newton_step(f, mean, rate, inverse_inertia, dt);
  }
}
}  // namespace detail

/// The rotation of a body in space with this angular momentum [kg m²/s] in dt [s]. Q is the matrix
/// of its orientation; the inverse moment of inertia is in the frame in which the body is defined.
/// Throws if it turns so far in a step that the equation cannot be solved.
[[gnu::always_inline]] inline FreeRotation<3> rotate_freely(
    const Orientation<3>& from, const Eigen::Matrix<double, 3, 3>& Q, const Vec<3>& momentum,
    const Eigen::Matrix<double, 3, 3>& inverse_inertia, double dt) {
  const Vec<3> in_body = multiply(Eigen::Matrix<double, 3, 3>(Q.transpose()), momentum);
  const Vec<3> mean = detail::mean_momentum(in_body, inverse_inertia, dt);
  return turn_with(from, multiply(Q, multiply(inverse_inertia, mean)), dt);
}

/// The same from the orientation alone.
template <int Dim, class Momentum>
FreeRotation<Dim> rotate_freely(const Orientation<Dim>& from, const Momentum& momentum,
                                const Inertia<Dim>& inverse_inertia, double dt) {
  return rotate_freely(from, from.matrix(), momentum, inverse_inertia, dt);
}

}  // namespace silt
