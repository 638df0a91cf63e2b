// SPDX-License-Identifier: MIT
// The particles that all benchmarks of one dimension share: a packing's density whatever their
// number, and the same points for the same number.
#pragma once

#include <silt/core/lattice.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace bench {

inline constexpr double diameter = 1;

/// Search radius: what is nearly in contact, too.
inline constexpr double reach = 1.05 * diameter;

/// n points of a square (cubic) lattice of one diameter, each moved at random by up to 4 % of it
/// along each axis: as in a packing, about 4 (6) neighbours within the reach. Their order in memory
/// is random, as after a long run that never sorted its particles.
template <int Dim, class Real>
std::vector<silt::Vec<Dim, Real>> packing(silt::Index n) {
  using Vec = silt::Vec<Dim, Real>;
  const double edge = std::ceil(std::pow(double(n), 1.0 / Dim)) * diameter;
  std::mt19937_64 random(20040101);
  std::uniform_real_distribution<double> shift(-0.04 * diameter, 0.04 * diameter);
  auto points = silt::lattice<Dim, Real>(
      {Vec(Vec::Zero()), Vec(Vec::Constant(static_cast<Real>(edge)))}, Real(diameter));
  points.resize(n);
  for (Vec& point : points) {
    for (int k = 0; k < Dim; ++k) point[k] += static_cast<Real>(shift(random));
  }
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

template <int Dim, class Real>
silt::Particles<Dim, Real> particles(silt::Index n) {
  silt::Particles<Dim, Real> particles;
  for (const auto& point : packing<Dim, Real>(n)) particles.add(point);
  return particles;
}

}  // namespace bench
