// SPDX-License-Identifier: MIT
// The divergence of a velocity, to which neighbours and images contribute alike.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/neighbour_pack.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace silt::mps {

namespace detail {

/// f(pack, s) for the neighbours of a view, without their weights, and g(image, s) for its images,
/// with s = −w'/(r slope_sum) times the share that is seen. Roots and quotients first, for many at
/// a time.
template <int Dim, class Real, class View, class Walls, class F, class G>
[[gnu::always_inline]] inline void for_each_with_slope(const View& at, const Walls& walls, F&& f,
                                                       G&& g) {
  const auto stencil = at.stencil();
  const Index i = at.index();
  const auto& neighbourhood = at.neighbourhood();
  const auto row = neighbourhood[i];
  const auto slope_at = [&](Real r) -> Real { return -stencil.slope(r) / (r * stencil.slope_sum); };
  constexpr Index block = 64;
  std::array<Real, block> distances, slopes;
  std::array<std::array<Real, block>, Dim> r_ij;
  for (Index from = 0; from < row.size(); from += block) {
    const Index size = std::min(block, row.size() - from);
    Index next = 0;
    NeighbourPack<Dim, Real>::for_each(neighbourhood, i, from, from + size, [&](const auto& j) {
      Four<Real> squares{};
      for (int a = 0; a < Dim; ++a) squares += j.r_ij[a] * j.r_ij[a];
      for (int a = 0; a < Dim; ++a) simd::store<Real, 4>(&r_ij[std::size_t(a)][next], j.r_ij[a]);
      simd::store<Real, 4>(&distances[next], squares);
      next += 4;
    });
    for (Index k = 0; k < size; ++k) {
      const Real r = std::sqrt(distances[k]);
      distances[k] = r;
      slopes[k] = slope_at(r);
    }
    if (!View::have_equal_volumes || !walls.sees_all(i)) {
      const float* const weights = row.weight + from;
      for (Index k = 0; k < size; ++k) {
        const Real weight = stencil.weight(distances[k]);
        // At the effective radius, where the share would be 0/0, the slope is zero as well. Not
        // closer: cut off while it is not, it would make the source jump as particles pass.
        slopes[k] = weight > 0 ? Real(weights[k]) / weight * slopes[k] : 0;
      }
    }
    std::fill(slopes.data() + size, slopes.data() + next, Real(0));
    for (Index k = 0; k < size; k += 4) {
      NeighbourPack<Dim, Real> j;
      j.index = row.index + from + k;
      for (int a = 0; a < Dim; ++a) simd::load_pack(&r_ij[std::size_t(a)][k], j.r_ij[a]);
      Four<Real> slope;
      simd::load_pack(&slopes[k], slope);
      f(j, slope);
    }
  }
  walls.for_each_image(i, stencil, [&](const auto& image) {
    g(image, image.share * slope_at(image.r_ij.norm()));
  });
}

}  // namespace detail

/// ⟨∇·u⟩_i = −(Dn/Dt) / (−1/d Σ w' r), with the sum over the full lattice [1/s]: a flow without
/// divergence keeps n, to which fluid and images contribute alike, and so its volume. Below an
/// even surface, missing neighbours are taken to have the velocities of the linear flow around i:
/// `flow`, see ExtrapolatedFlow::OfParticle.
template <int Dim, class Real, class View, class Walls, class Flow, class U>
[[gnu::flatten]] Real divergence_with_images(const View& at, const Walls& walls, const Flow& flow,
                                             const U& u) {
  using Vec = silt::Vec<Dim, Real>;
  const auto& stencil = at.stencil();
  static_assert(requires { stencil.slope(Real()); },
                "mps: ImageWalls need a kernel with a slope, see SmoothKernel");
  const Vec own = u[at.index()];
  Four<Real> of_four{};
  Real sum = 0;
  detail::for_each_with_slope<Dim, Real>(
      at, walls,
      [&](const NeighbourPack<Dim, Real>& j, const Four<Real>& slope) {
        FourVectors<Dim, Real> u_j{};
        j.get(u, u_j);
        Four<Real> product{};
        for (int a = 0; a < Dim; ++a) product += (u_j[a] - own[a]) * j.r_ij[a];
        of_four += slope * product;
      },
      [&](const auto& image, Real slope) {
        sum += slope * Vec(image.velocity(u) - own).dot(image.r_ij);
      });
  if (!flow.misses_neighbours || !flow.gradient.is_known) return sum + sum_of(of_four);
  // Σ w_j ∇u r·r over the missing ones: that over the full lattice, ∇·u, less that over the others.
  const auto& gradient = flow.gradient.value;
  sum += gradient.trace();
  detail::for_each_with_slope<Dim, Real>(
      at, walls,
      [&](const NeighbourPack<Dim, Real>& j, const Four<Real>& slope) {
        Four<Real> product{};
        for (int a = 0; a < Dim; ++a) {
          for (int b = 0; b < Dim; ++b) product += (gradient(a, b) * j.r_ij[b]) * j.r_ij[a];
        }
        of_four -= slope * product;
      },
      [&](const auto& image, Real slope) {
        sum -= slope * multiply<Dim, Real>(gradient, image.r_ij).dot(image.r_ij);
      });
  return sum + sum_of(of_four);
}

/// ∮ P V·n dA over the walls that move, the part of particle i over its volume [W/m³]: the
/// divergence of their velocity V, times the pressure half way to an image; rise(image) is as in
/// PressureRise.
template <int Dim, class Real, class View, class Walls, class Pressures, class Rise>
[[gnu::cold]] double power_of_walls(const View& at, const Walls& walls, const Pressures& p,
                                    const Rise& rise) {
  const auto& stencil = at.stencil();
  double power = 0;
  walls.for_each_image(at.index(), stencil, [&](const auto& image) {
    if (!image.motion) return;
    const Real r = image.r_ij.norm();
    const Real slope = -image.share * stencil.slope(r) / (r * stencil.slope_sum);
    const Real half_way = (p[at.index()] + p[image.index] + rise(image)) / 2;
    power -= double(slope * image.motion->velocity.dot(image.r_ij) * half_way);
  });
  return power;
}

}  // namespace silt::mps
