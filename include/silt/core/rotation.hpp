// SPDX-License-Identifier: MIT
// Rotations in space. Eigen's own are in a header that grains need for nothing else, and that takes
// long to compile.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>
#include <concepts>
#include <type_traits>

namespace silt {

/// The matrix of a rotation by `turn` [rad] about an axis, a unit vector:
/// cos φ 1 + (1 − cos φ) a aᵀ + sin φ [a]×
template <class Real>
Eigen::Matrix<Real, 3, 3> rotation_about(const Vec<3, Real>& axis,
                                         std::type_identity_t<Real> turn) {
  const Real cosine = std::cos(turn);
  const Vec<3, Real> s = std::sin(turn) * axis;
  const Vec<3, Real> c = (1 - cosine) * axis;
  const Real xy = c.x() * axis.y();
  const Real xz = c.x() * axis.z();
  const Real yz = c.y() * axis.z();
  Eigen::Matrix<Real, 3, 3> matrix;
  matrix << c.x() * axis.x() + cosine, xy - s.z(), xz + s.y(),  //
      xy + s.z(), c.y() * axis.y() + cosine, yz - s.x(),        //
      xz - s.y(), yz + s.x(), c.z() * axis.z() + cosine;
  return matrix;
}
/// The same in the plane.
template <std::floating_point Real>
Eigen::Matrix<Real, 2, 2> rotation_by(Real turn) {
  const Real sine = std::sin(turn);
  const Real cosine = std::cos(turn);
  Eigen::Matrix<Real, 2, 2> matrix;
  matrix << cosine, -sine, sine, cosine;
  return matrix;
}

/// The rotation vector of a rotation matrix, in the plane its angle [rad]: of a turn by less than
/// half a circle.
template <class Real>
Real turn_of(const Eigen::Matrix<Real, 2, 2>& rotation) {
  return std::atan2(rotation(1, 0), rotation(0, 0));
}
template <class Real>
Vec<3, Real> turn_of(const Eigen::Matrix<Real, 3, 3>& rotation) {
  const Vec<3, Real> twice_sine_axis{rotation(2, 1) - rotation(1, 2),
                                     rotation(0, 2) - rotation(2, 0),
                                     rotation(1, 0) - rotation(0, 1)};
  const Real sine = twice_sine_axis.norm() / 2;
  if (!(sine > 0)) return Vec<3, Real>::Zero();
  const Real cosine = (rotation(0, 0) + rotation(1, 1) + rotation(2, 2) - 1) / 2;
  return std::atan2(sine, cosine) / (2 * sine) * twice_sine_axis;
}

/// A unit vector [-] at a right angle to another vector, which must not be 0.
template <class Real>
Vec<3, Real> unit_across(const Vec<3, Real>& v) {
  // Its shadow on the x-y plane, turned by a quarter, unless that is nearly a point.
  const Real little = Eigen::NumTraits<Real>::dummy_precision();
  const Real least = little * std::abs(v.z());
  if (std::abs(v.x()) > least || std::abs(v.y()) > least) {
    const Real scale = 1 / v.template head<2>().norm();
    return {-v.y() * scale, v.x() * scale, 0};
  }
  const Real scale = 1 / v.template tail<2>().norm();
  return {0, -v.z() * scale, v.y() * scale};
}

}  // namespace silt
