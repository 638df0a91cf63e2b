// SPDX-License-Identifier: MIT
// The orientation of a rigid body.
#pragma once

#include <silt/core/rotation.hpp>
#include <silt/core/types.hpp>

#include <cmath>

namespace silt {

/// How a body is turned against where it is defined.
template <int Dim>
struct Orientation;

/// In the plane an angle, which counts whole turns.
template <>
struct Orientation<2> {
  double angle = 0;  ///< [rad]

  Eigen::Matrix<double, 2, 2> matrix() const { return rotation_by(angle); }
  /// After a further turn [rad].
  Orientation turned(double turn) const { return {angle + turn}; }
  /// f(number) for each number that it consists of.
  template <class F>
  void for_each_number(F&& f) {
    f(angle);
  }
};

/// In space a unit quaternion.
template <>
struct Orientation<3> {
  Vec<4> quaternion = {1, 0, 0, 0};  ///< w, x, y, z [-]

  [[gnu::always_inline]] Eigen::Matrix<double, 3, 3> matrix() const {
    const double w = quaternion[0], x = quaternion[1], y = quaternion[2], z = quaternion[3];
    // By elements: g++ does not inline Eigen's operator<<.
    Eigen::Matrix<double, 3, 3> rotation;
    rotation(0, 0) = 1 - 2 * (y * y + z * z);
    rotation(0, 1) = 2 * (x * y - w * z);
    rotation(0, 2) = 2 * (w * y + x * z);
    rotation(1, 0) = 2 * (w * z + x * y);
    rotation(1, 1) = 1 - 2 * (x * x + z * z);
    rotation(1, 2) = 2 * (y * z - w * x);
    rotation(2, 0) = 2 * (x * z - w * y);
    rotation(2, 1) = 2 * (w * x + y * z);
    rotation(2, 2) = 1 - 2 * (x * x + y * y);
    return rotation;
  }
  /// After a further turn, a rotation vector [rad].
  Orientation turned(const Vec<3>& turn) const {
    const double full = turn.norm();
    if (!(full > 0)) return *this;
    const double w = std::cos(full / 2);
    const Vec<3> v = std::sin(full / 2) / full * turn;
    const double w0 = quaternion[0];
    const Vec<3> v0 = quaternion.tail<3>();
    Orientation now;
    now.quaternion[0] = w * w0 - v.dot(v0);
    now.quaternion.tail<3>() = w * v0 + w0 * v + cross(v, v0);
    now.quaternion.normalize();  // round-off
    return now;
  }
  /// f(number) for each number that it consists of.
  template <class F>
  void for_each_number(F&& f) {
    for (double& number : quaternion) f(number);
  }
};

}  // namespace silt
