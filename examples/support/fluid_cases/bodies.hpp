// SPDX-License-Identifier: MIT
// Initial bodies of fluid, cut from a lattice, and measures of their later fragmentation.
#pragma once

#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace fluid_cases {

using namespace silt;

/// Fluid at the lattice points x of `box` with belongs(x), with velocity velocity_at(x) [m/s], in
/// the box `space`.
template <class Belongs, class VelocityAt>
mps::Fluid<2> fluid_where(const Box<2>& box, double spacing, const Box<2>& space, Belongs&& belongs,
                          VelocityAt&& velocity_at) {
  mps::Fluid<2> fluid(space);
  for (const auto& x : lattice<2>(box, spacing)) {
    if (!belongs(x)) continue;
    const Index i = mps::add_particle(fluid, x, mps::Kind::fluid);
    fluid[velocity][i] = velocity_at(x);
  }
  return fluid;
}

/// Radius of the largest empty circle in a periodic box [m], with a resolution of a quarter of a
/// spacing, limited to two spacings. On a square lattice it is 0.71 l0.
inline double largest_gap(const mps::Fluid<2>& fluid, double spacing) {
  const auto& box = fluid.box();
  const auto points = [&](int axis) {
    return static_cast<long>(std::round(4 * box.length()[axis] / spacing));
  };
  const long nx = points(0), ny = points(1);
  const Vec<2> step{box.length()[0] / double(nx), box.length()[1] / double(ny)};
  constexpr long reach = 8;
  std::vector<double> nearest(static_cast<Index>(nx * ny), 4 * spacing * spacing);
  for (const auto& centre : fluid[position]) {
    const Vec<2> x = (box.wrap(centre) - box.lower).cwiseQuotient(step);
    const long x0 = std::lround(x[0]), y0 = std::lround(x[1]);
    for (long b = y0 - reach; b <= y0 + reach; ++b) {
      for (long a = x0 - reach; a <= x0 + reach; ++a) {
        const Vec<2> off = (x - Vec<2>(double(a), double(b))).cwiseProduct(step);
        double& smallest = nearest[static_cast<Index>((b + ny) % ny * nx + (a + nx) % nx)];
        smallest = std::min(smallest, off.squaredNorm());
      }
    }
  }
  return std::sqrt(*std::max_element(nearest.begin(), nearest.end()));
}

/// Fraction of the particles in the largest connected body; particles closer than `reach` [m] are
/// connected.
inline double largest_body(const mps::Fluid<2>& fluid, double reach) {
  mps::Fluid<2> copy = fluid;
  UniformGrid<2> grid;
  grid.set_radius(reach);
  grid.update(copy);
  std::vector<Index> body(copy.size());
  std::iota(body.begin(), body.end(), Index(0));
  const auto root = [&](Index i) {
    while (body[i] != i) i = body[i] = body[body[i]];
    return i;
  };
  grid.for_each_pair([&](Index i, Index j, const auto&, double) {
    body[root(copy.owner(i))] = root(copy.owner(j));
  });
  std::vector<Index> members(copy.size(), 0);
  for (Index i = 0; i < copy.size(); ++i) ++members[root(i)];
  return double(*std::max_element(members.begin(), members.end())) / double(copy.size());
}

/// Mean of f(i) over all particles.
template <class F>
double mean_over(const mps::Fluid<2>& fluid, F&& f) {
  return ordered_sum(fluid.size(), 0.0, f) / double(fluid.size());
}

}  // namespace fluid_cases
