// SPDX-License-Identifier: MIT
// The vorticity of the fluid around a grain.
#pragma once

#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/coupled/weights.hpp>

#include <Eigen/LU>

#include <cmath>

namespace silt::coupled {

/// ∇ × u of the fluid around grain k [1/s], by least squares with the weights: exact where u is
/// linear. Zero where the particles are nearly on a line or plane.
template <int Dim, class Real, class Velocities>
AngularVec<Dim, Real> vorticity_around(const Weights<Dim, Real>& weights, Index k,
                                       const Velocities& u) {
  using Vec = silt::Vec<Dim, Real>;
  using Matrix = Eigen::Matrix<Real, Dim, Dim>;
  constexpr double least_determinant = 0.08;  // 1 if they are all around
  Vec centre = Vec::Zero(), mean = Vec::Zero();
  weights.for_each_offset(k, [&](Index i, Real weight, const Vec& r) {
    centre += weight * r;
    mean += weight * u[i];
  });
  // Not Eigen's products, see multiply().
  Matrix moments = Matrix::Zero(), products = Matrix::Zero();
  weights.for_each_offset(k, [&](Index i, Real weight, const Vec& r) {
    const Vec arm = r - centre, relative = u[i] - mean;
    for (int a = 0; a < Dim; ++a) {
      for (int b = 0; b < Dim; ++b) {
        moments(a, b) += weight * arm[a] * arm[b];
        products(a, b) += weight * relative[a] * arm[b];
      }
    }
  });
  const double size = double(moments.trace()) / Dim;
  if (!(double(moments.determinant()) > least_determinant * std::pow(size, Dim))) {
    return zero_of<AngularVec<Dim, Real>>();
  }
  const Matrix inverse = moments.inverse();  // symmetric
  Matrix gradient;
  for (int a = 0; a < Dim; ++a) {
    Vec row;
    for (int b = 0; b < Dim; ++b) row[b] = products(a, b);
    row = multiply<Dim, Real>(inverse, row);
    for (int b = 0; b < Dim; ++b) gradient(a, b) = row[b];
  }
  if constexpr (Dim == 2) {
    return gradient(1, 0) - gradient(0, 1);
  } else {
    return {gradient(2, 1) - gradient(1, 2), gradient(0, 2) - gradient(2, 0),
            gradient(1, 0) - gradient(0, 1)};
  }
}

}  // namespace silt::coupled
