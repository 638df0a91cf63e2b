// SPDX-License-Identifier: MIT
// Random points, and their pairs by brute force, with all periodic images, without ghosts or cells.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/particles.hpp>

#include <algorithm>
#include <random>
#include <tuple>
#include <vector>

namespace silt::test {

template <int Dim, class Real>
Box<Dim, Real> cube(Real lower, Real upper) {
  Box<Dim, Real> box;
  box.lower.setConstant(lower);
  box.upper.setConstant(upper);
  return box;
}

template <int Dim, class Real>
std::vector<Vec<Dim, Real>> random_points(Index n, const Box<Dim, Real>& box, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Vec<Dim, Real>> points(n);
  for (auto& x : points) {
    for (int k = 0; k < Dim; ++k) {
      const double at = double(box.lower[k]) + unit(random) * double(box.upper[k] - box.lower[k]);
      x[k] = std::min(static_cast<Real>(at), std::nextafter(box.upper[k], box.lower[k]));
    }
  }
  return points;
}

template <int Dim, class Real>
Particles<Dim, Real> particles_at(const std::vector<Vec<Dim, Real>>& points,
                                  const Box<Dim, Real>& box = {}) {
  Particles<Dim, Real> particles(box);
  for (const auto& x : points) particles.add(x);
  return particles;
}

/// A pair: owner i, owner j, and the components of r_ij.
template <int Dim, class Real>
using NeighbourPair = std::tuple<Index, Index, std::vector<Real>>;

template <int Dim, class Real>
NeighbourPair<Dim, Real> neighbour_pair(Index i, Index j, const Vec<Dim, Real>& r_ij) {
  return {i, j, std::vector<Real>(r_ij.data(), r_ij.data() + Dim)};
}

/// Every (i, j, r_ij) with r < radius, including images in the adjacent periodic boxes.
template <class P>
auto brute_force_pairs(const P& particles, typename P::Real radius) {
  constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  const auto x = particles[position];
  const auto& box = particles.box();
  std::vector<Vec<Dim, Real>> shifts{Vec<Dim, Real>::Zero()};
  for (int k = 0; k < Dim; ++k) {
    if (!box.periodic[static_cast<std::size_t>(k)]) continue;
    for (Index s = 0, previous = shifts.size(); s < previous; ++s) {
      for (const Real sign : {Real(-1), Real(1)}) {
        auto shift = shifts[s];
        shift[k] = sign * (box.upper[k] - box.lower[k]);
        shifts.push_back(shift);
      }
    }
  }
  std::vector<NeighbourPair<Dim, Real>> found;
  for (Index i = 0; i < x.size(); ++i) {
    for (Index j = 0; j < x.size(); ++j) {
      for (const auto& shift : shifts) {
        const Vec<Dim, Real> r_ij = Vec<Dim, Real>(x[j] + shift) - x[i];
        if (i != j && r_ij.squaredNorm() < radius * radius) {
          found.push_back(neighbour_pair<Dim, Real>(i, j, r_ij));
        }
      }
    }
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The same from for_each_neighbour of a search.
template <class P, class S>
auto neighbour_pairs(const P& particles, const S& search) {
  using Real = typename P::Real;
  std::vector<NeighbourPair<P::dimension, Real>> found;
  for (Index i = 0; i < particles.size(); ++i) {
    search.for_each_neighbour(i, [&](Index j, const typename P::Vec& r_ij, Real) {
      found.push_back(neighbour_pair<P::dimension, Real>(i, particles.owner(j), r_ij));
    });
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The same from for_each_pair, which reports every pair once.
template <class P, class S>
auto pairs(const P& particles, const S& search) {
  using Real = typename P::Real;
  std::vector<NeighbourPair<P::dimension, Real>> found;
  search.for_each_pair([&](Index i, Index j, const typename P::Vec& r_ij, Real) {
    found.push_back(neighbour_pair<P::dimension, Real>(i, particles.owner(j), r_ij));
  });
  std::sort(found.begin(), found.end());
  return found;
}

/// Only the pairs with i < j.
template <class List>
List once_each(const List& pairs) {
  List once;
  for (const auto& pair : pairs) {
    if (std::get<0>(pair) < std::get<1>(pair)) once.push_back(pair);
  }
  return once;
}

}  // namespace silt::test
