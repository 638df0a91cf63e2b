// SPDX-License-Identifier: MIT
// Initial arrangements of fluid used by many tests.
#pragma once

#include "support/points.hpp"
#include "support/slow_types.hpp"

#include <silt/mps.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace silt::test {

inline constexpr double nan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double inf = std::numeric_limits<double>::infinity();

/// A dimension and a precision, for typed tests.
template <int Dim, class RealType>
struct Space {
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Fluid = mps::Fluid<Dim, Real>;
  /// Bound of the rounding error of a sum over a neighbourhood.
  static constexpr Real rounding = 200 * std::numeric_limits<Real>::epsilon();
};
using Spaces = AllOrUsual<
    ::testing::Types<Space<2, double>, Space<2, float>, Space<3, double>, Space<3, float>>,
    ::testing::Types<Space<2, double>, Space<3, double>>>;

template <int Dim, class Real>
mps::Fluid<Dim, Real> fluid_at(const std::vector<Vec<Dim, Real>>& points,
                               const Box<Dim, Real>& box = {}) {
  mps::Fluid<Dim, Real> fluid(box);
  for (const auto& x : points) mps::add_particle(fluid, x, mps::Kind::fluid);
  return fluid;
}

/// A lattice of spacing l0 with random displacements of up to `jitter` spacings along each axis.
template <int Dim, class Real>
std::vector<Vec<Dim, Real>> jittered(int along, Real l0, Real jitter, unsigned seed = 1) {
  auto points = lattice<Dim, Real>(cube<Dim, Real>(0, Real(along) * l0), l0);
  const auto moves = random_points(points.size(), cube<Dim, Real>(-1, 1), seed);
  for (Index i = 0; i < points.size(); ++i) points[i] += (jitter * l0) * moves[i];
  return points;
}

/// A periodic box full of fluid, so that every particle has all its neighbours.
template <int Dim, class Real>
mps::Fluid<Dim, Real> full_box(int along, Real l0, Real jitter = 0, unsigned seed = 1) {
  auto box = cube<Dim, Real>(0, Real(along) * l0);
  box.periodic.fill(true);
  return fluid_at(jittered<Dim, Real>(along, l0, jitter, seed), box);
}

/// A cube of fluid in empty space.
template <int Dim, class Real>
mps::Fluid<Dim, Real> blob(int along, Real l0, Real jitter = 0, unsigned seed = 1) {
  return fluid_at(jittered<Dim, Real>(along, l0, jitter, seed));
}

template <class P>
void give_random_velocities(P& fluid, typename P::Real max_speed, unsigned seed) {
  constexpr int dim = P::dimension;
  using Real = typename P::Real;
  const auto u = random_points(fluid.size(), cube<dim, Real>(-max_speed, max_speed), seed);
  for (Index i = 0; i < fluid.size(); ++i) {
    if (fluid[mps::kind][i] == mps::Kind::fluid) fluid[velocity][i] = u[i];
  }
}

/// Σ u over all particles, which have equal masses.
template <class P>
Vec<P::dimension> velocity_sum(const P& fluid) {
  Vec<P::dimension> sum = Vec<P::dimension>::Zero();
  for (Index i = 0; i < fluid.size(); ++i) sum += fluid[velocity][i].template cast<double>();
  return sum;
}

/// Σ |u|.
template <class P>
double speed_sum(const P& fluid) {
  double sum = 0;
  for (const auto& u : fluid[velocity]) sum += double(u.norm());
  return sum;
}

/// Surface detection for a closed, full tank: no particle is on the surface.
struct NoSurface {
  void check() const {}
  bool is_on_surface(const mps::LocalDensity&) const { return false; }
};

/// A small 2D dam break: 10 by 15 spacings of fluid in a tank of 25.
template <int Dim>
mps::Tank<Dim> small_tank(double l0 = 0.02, double depth = 5) {
  return {.column = {10 * l0, (Dim == 2 ? 15 : 8) * l0},
          .size = {.length = 25 * l0, .height = 20 * l0, .depth = depth * l0},
          .spacing = l0};
}
template <int Dim, class Real = double>
mps::Fluid<Dim, Real> small_dam(double l0 = 0.02, double depth = 5) {
  return mps::make_tank<Dim, Real>(small_tank<Dim>(l0, depth));
}

}  // namespace silt::test
