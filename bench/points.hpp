// SPDX-License-Identifier: MIT
// Particles for the search benchmarks: the density does not depend on their number, and the same
// number gives the same points.
#pragma once

#include <silt/core/lattice.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace bench {

/// A square (cubic) lattice with random displacements along each axis, and a search radius.
enum class Density {
  dense,  ///< equal grains in a packing, nearly in contact: about 4 (6) neighbours
  mps,    ///< fluid particles and the larger radius of MPS: about 29 (118) neighbours
};

/// Spacing of the lattice; the diameter of a grain is 1.
constexpr double spacing(Density density) { return density == Density::dense ? 0.97 : 1; }
/// Maximum displacement of a point.
constexpr double jitter(Density density) { return density == Density::dense ? 0.04 : 0.2; }
/// Search radius.
constexpr double reach(Density density) { return density == Density::dense ? 1.05 : 3.1; }

/// n of these particles, in random order in memory, as after a long run without sorting.
template <int Dim, class Real>
silt::Particles<Dim, Real> particles(silt::Index n, Density density) {
  using Vec = silt::Vec<Dim, Real>;
  const double step = spacing(density);
  const double edge = std::ceil(std::pow(double(n), 1.0 / Dim)) * step;
  std::mt19937_64 random(20040101);
  std::uniform_real_distribution<double> shift(-jitter(density), jitter(density));
  auto points = silt::lattice<Dim, Real>(
      {Vec(Vec::Zero()), Vec(Vec::Constant(static_cast<Real>(edge)))}, static_cast<Real>(step));
  points.resize(n);
  for (Vec& point : points) {
    for (int k = 0; k < Dim; ++k) point[k] += static_cast<Real>(shift(random));
  }
  std::shuffle(points.begin(), points.end(), random);
  silt::Particles<Dim, Real> particles;
  particles.reserve(n);
  for (const Vec& point : points) particles.add(point);
  return particles;
}

}  // namespace bench
