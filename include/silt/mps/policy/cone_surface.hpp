// SPDX-License-Identifier: MIT
// Geometric detection of the free surface: an empty cone on the side where neighbours are missing.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/free_surface.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::mps {

namespace detail {

// The smallest eigenvalue of a symmetric matrix. Eigen's own takes longer to compile than all else
// that a flow needs of Eigen.
template <class Real>
Real smallest_eigenvalue(const Eigen::Matrix<Real, 2, 2>& A) {
  const Real mean = (A(0, 0) + A(1, 1)) / 2;
  return mean - std::hypot((A(0, 0) - A(1, 1)) / 2, A(1, 0));
}
// By the angle of [Smith1961], whose cosine is half the determinant of the matrix without its mean,
// scaled to a mean square of 2 of its eigenvalues.
template <class Real>
Real smallest_eigenvalue(const Eigen::Matrix<Real, 3, 3>& A) {
  const Real mean = (A(0, 0) + A(1, 1) + A(2, 2)) / 3;
  const Real a = A(0, 0) - mean, b = A(1, 1) - mean, c = A(2, 2) - mean;
  const Real x = A(2, 1), y = A(2, 0), z = A(1, 0);
  const Real size = std::sqrt((a * a + b * b + c * c + 2 * (x * x + y * y + z * z)) / 6);
  if (!(size > 0)) return mean;
  const Real determinant = a * (b * c - x * x) - z * (z * c - x * y) + y * (z * x - b * y);
  const Real cosine = std::clamp(determinant / (2 * size * size * size), Real(-1), Real(1));
  const Real third_of_turn = 2 * std::numbers::pi_v<Real> / 3;
  return mean + 2 * size * std::cos(std::acos(cosine) / 3 + third_of_turn);
}

}  // namespace detail

/// After [MarroneColagrossi2010]. The smallest eigenvalue of d/n0 Σ r_ij r_ijᵀ w/r², which is 1 in
/// the full lattice, identifies spray (small) and interior particles (large). In between, a
/// particle is on the surface if the cone around −Σ w r_ij/r contains no fluid. The number density
/// is not used.
struct ConeSurface {
  double half_angle = 0.25 * 3.14159265358979;  ///< of the cone [rad]
  double length = 2.1;    ///< of the cone, in units of l0 [-]
  double spray = 0.3;     ///< eigenvalue below which a particle is on the surface [-]
  double inside = 0.9;    ///< eigenvalue above which it is not [-]

  /// Throws if a number is out of range.
  void check() const {
    require_between("ConeSurface: half_angle", half_angle, {0.05, 1.5});
    require_between("ConeSurface: length", length, {1, 10});
    require_between("ConeSurface: spray", spray, {0, 1});
    require_between("ConeSurface: inside", inside, {spray, 2});
  }

  /// The cone is empty if it contains no neighbour that covers the surface.
  template <class View>
  bool is_on_surface(const View& at) const {
    constexpr int Dim = View::dimension;
    using Real = typename View::Real;
    using Vec = silt::Vec<Dim, Real>;
    using Matrix = Eigen::Matrix<Real, Dim, Dim>;
    Matrix moments = Matrix::Zero();
    Vec outwards = Vec::Zero();
    at.for_each([&](const Vec& r_ij, Real w, bool) {
      moments += (w / r_ij.squaredNorm() * r_ij) * r_ij.transpose();
      outwards -= (w / r_ij.norm()) * r_ij;
    });
    moments *= Dim / at.n0;
    const Real smallest = detail::smallest_eigenvalue(moments);
    if (smallest < Real(spray)) return true;
    const Real size = outwards.norm();
    if (smallest > Real(inside) || !(size > 0)) return false;
    outwards /= size;
    const Real max_distance = Real(length) * at.spacing;
    const Real cosine = Real(std::cos(half_angle));
    bool is_empty = true;
    at.for_each([&](const Vec& r_ij, Real, bool covers) {
      const Real r = r_ij.norm();
      is_empty &= !covers || r >= max_distance || r_ij.dot(outwards) <= cosine * r;
    });
    return is_empty;
  }
};

}  // namespace silt::mps
