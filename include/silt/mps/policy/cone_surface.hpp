// SPDX-License-Identifier: MIT
// Geometric detection of the free surface: an empty cone on the side where neighbours are missing.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/free_surface.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>

namespace silt::mps {

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
    Eigen::SelfAdjointEigenSolver<Matrix> solver;
    solver.computeDirect(moments, Eigen::EigenvaluesOnly);
    const Real smallest_eigenvalue = solver.eigenvalues()[0];
    if (smallest_eigenvalue < Real(spray)) return true;
    const Real size = outwards.norm();
    if (smallest_eigenvalue > Real(inside) || !(size > 0)) return false;
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
