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
#include <utility>

namespace silt {

/// A free rotation during a time step.
template <int Dim>
struct FreeRotation {
  Orientation<Dim> end;                               ///< of the body
  AngularVec<Dim> spin = zero_of<AngularVec<Dim>>();  ///< the mean one [1/s]
};

/// The inverse of a moment of inertia [1/(kg m²)].
inline double inverse_of(double moment) { return 1 / moment; }
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

/// The rotation of a disc or a body in the plane with this angular momentum [kg m²/s] in dt [s].
inline FreeRotation<2> rotate_freely(const Orientation<2>& from, double momentum,
                                     double inverse_inertia, double dt) {
  const double rate = momentum * inverse_inertia;
  return {from.turned(rate * dt), rate};
}

/// The rotation of a body in space with this angular momentum [kg m²/s] in dt [s]; the inverse
/// moment of inertia is in the frame in which the body is defined. Throws if it turns too far in a
/// step for the equation to be solved, by about a radian.
inline FreeRotation<3> rotate_freely(const Orientation<3>& from, const Vec<3>& momentum,
                                     const Eigen::Matrix<double, 3, 3>& inverse_inertia,
                                     double dt) {
  const Eigen::Matrix<double, 3, 3> Q = from.matrix();
  const Vec<3> m = multiply(Eigen::Matrix<double, 3, 3>(Q.transpose()), momentum);
  const double enough = 4 * std::numeric_limits<double>::epsilon() * max_norm(m);
  // Newton's iteration for f(m̄) = m̄ − m − Δt/2 m̄ × Θ⁻¹ m̄ = 0.
  Vec<3> mean = m;
  Vec<3> rate = multiply(inverse_inertia, mean);
  constexpr int most = 20;
  int iterations = 0;
  while (true) {
    const Vec<3> f = mean - m - dt / 2 * cross(mean, rate);
    if (!(max_norm(f) > enough)) break;  // nor if it is not a number, which the step finds
    if (++iterations > most) {
      fail({"a body turns by ", rate.norm() * dt, " rad in a step of ", dt,
            " s; lower the time step"});
    }
    Eigen::Matrix<double, 3, 3> slope;
    for (int k = 0; k < 3; ++k) {
      const Vec<3> e = Vec<3>::Unit(k);
      slope.col(k) = e - dt / 2 * (cross(e, rate) + cross(mean, Vec<3>(inverse_inertia.col(k))));
    }
    // By Cramer's rule.
    const Vec<3> a = slope.col(0), b = slope.col(1), c = slope.col(2);
    const Vec<3> bc = cross(b, c);
    const double scale = 1 / a.dot(bc);
    mean -= scale * Vec<3>(f.dot(bc), f.dot(cross(c, a)), f.dot(cross(a, b)));
    rate = multiply(inverse_inertia, mean);
  }
  const Vec<3> in_space = multiply(Q, rate);
  // cay(Δt ω) is the unit quaternion along (1, Δt ω/2).
  const Vec<3> v = dt / 2 * in_space;
  const double w0 = from.quaternion[0];
  const Vec<3> v0 = from.quaternion.tail<3>();
  FreeRotation<3> rotation{.end = {}, .spin = in_space};
  rotation.end.quaternion[0] = w0 - v.dot(v0);
  rotation.end.quaternion.tail<3>() = v0 + w0 * v + cross(v, v0);
  rotation.end.quaternion /= std::sqrt(rotation.end.quaternion.squaredNorm());
  return rotation;
}

}  // namespace silt
