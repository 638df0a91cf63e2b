// SPDX-License-Identifier: MIT
// The mirror image of a point in one plane after another.
#pragma once

#include <silt/core/types.hpp>

#include <Eigen/LU>

#include <cstdint>

namespace silt {

/// The map of points to their images, x → R x + t.
template <int Dim>
struct Mirror {
  using Vec = silt::Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  Matrix rotation = Matrix::Identity();  ///< R, a reflection or a rotation
  Vec translation = Vec::Zero();         ///< t [m]

  Vec operator()(const Vec& x) const { return multiply<Dim, double>(rotation, x) + translation; }
  /// Of an odd number of planes.
  bool is_reflection() const { return rotation.determinant() < 0; }
  /// The map of images to their points.
  Mirror inverse() const {
    const Matrix back = rotation.transpose();
    return {back, -multiply<Dim, double>(back, translation)};
  }
  /// x → this(first(x))
  Mirror after(const Mirror& first) const {
    Mirror both{.translation = (*this)(first.translation)};
    for (int k = 0; k < Dim; ++k) {
      Vec column;
      for (int row = 0; row < Dim; ++row) column[row] = first.rotation(row, k);
      column = multiply<Dim, double>(rotation, column);
      for (int row = 0; row < Dim; ++row) both.rotation(row, k) = column[row];
    }
    return both;
  }
};

/// In the plane (in 2D, the line) of the points x with n·x = offset [m], n a unit vector.
template <int Dim>
Mirror<Dim> mirror_in(const Vec<Dim>& n, double offset) {
  Mirror<Dim> mirror{.translation = 2 * offset * n};
  for (int row = 0; row < Dim; ++row) {
    for (int column = 0; column < Dim; ++column) {
      mirror.rotation(row, column) -= 2 * n[row] * n[column];
    }
  }
  return mirror;
}

/// One of the planes of a mirror: n·x = offset.
template <int Dim>
struct PlaneOfMirror {
  Vec<Dim> normal;      ///< n, a unit vector [-]
  double offset;        ///< [m]
  std::uint32_t group;  ///< of faces that move together, in it
};

/// How velocities are mirrored in surfaces that move: that of the image of x is M u + at(x), where
/// u is that of the point. M is R where points slip along the surfaces; where they stick to them, M
/// is −1 in a reflection and 1 in a rotation.
template <int Dim>
struct MirrorRate {
  using Vec = silt::Vec<Dim>;
  using Matrix = Eigen::Matrix<double, Dim, Dim>;

  Matrix of_position = Matrix::Zero();  ///< [1/s]
  Vec at_origin = Vec::Zero();          ///< [m/s]

  Vec at(const Vec& x) const { return multiply<Dim, double>(of_position, x) + at_origin; }
  bool operator==(const MirrorRate&) const = default;
};

}  // namespace silt
