// SPDX-License-Identifier: MIT
// The divergence of a velocity, to which neighbours and images contribute alike.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/neighbour.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace silt::mps {

namespace detail {

/// f(j, s) for the neighbours and images of a view, with s = −w'/(r slope_sum) times the share that
/// is seen. Roots and quotients first, for many at a time.
template <int Dim, class Real, class View, class Walls, class F>
[[gnu::always_inline]] inline void for_each_with_slope(const View& at, const Walls& walls, F&& f) {
  using Vec = silt::Vec<Dim, Real>;
  const auto stencil = at.stencil();
  const Index i = at.index();
  const auto& neighbourhood = at.neighbourhood();
  const auto row = neighbourhood[i];
  const Vec x_i = neighbourhood.position_of(i);
  const auto slope_at = [&](Real r) -> Real { return -stencil.slope(r) / (r * stencil.slope_sum); };
  constexpr Index block = 64;
  std::array<Real, block> distances, slopes;
  for (Index from = 0; from < row.size(); from += block) {
    const Index size = std::min(block, row.size() - from);
    const std::uint32_t* const index = row.index + from;
    const float* const weights = row.weight + from;
    for (Index k = 0; k < size; ++k) {
      distances[k] = (neighbourhood.position_of(index[k]) - x_i).squaredNorm();
    }
    for (Index k = 0; k < size; ++k) {
      const Real r = std::sqrt(distances[k]);
      distances[k] = r;
      slopes[k] = slope_at(r);
    }
    if (!walls.sees_all(i)) {
      for (Index k = 0; k < size; ++k) {
        const Real weight = stencil.weight(distances[k]);
        // The share is else 0/0, and the slope is zero as well.
        slopes[k] = weight > Real(1e-6) ? Real(weights[k]) / weight * slopes[k] : 0;
      }
    }
    for (Index k = 0; k < size; ++k) {
      const Vec r_ij = neighbourhood.position_of(index[k]) - x_i;
      f(Neighbour<Dim, Real>{index[k], r_ij, Real(weights[k]), 0}, slopes[k]);
    }
  }
  walls.for_each_image(i, stencil, [&](const auto& image) {
    f(image, image.share * slope_at(image.r_ij.norm()));
  });
}

}  // namespace detail

/// <∇·u>_i = −(Dn/Dt) / (−1/d Σ w' r), with the sum over the full lattice: a flow without
/// divergence keeps n, to which fluid and images contribute alike, and so its volume. Below an
/// even surface, missing neighbours are taken to have the velocities of the linear flow around i: `flow`,
/// see ExtrapolatedFlow::OfParticle.
template <int Dim, class Real, class View, class Walls, class Flow, class U>
[[gnu::flatten]] Real divergence_with_images(const View& at, const Walls& walls, const Flow& flow,
                                             const U& u) {
  using Vec = silt::Vec<Dim, Real>;
  const auto& stencil = at.stencil();
  static_assert(requires { stencil.slope(Real()); },
                "mps: ImageWalls need a kernel with a slope, see SmoothKernel");
  const Vec own = u[at.index()];
  Real sum = 0;
  detail::for_each_with_slope<Dim, Real>(at, walls, [&](const auto& j, Real slope) {
    sum += slope * Vec(j.velocity(u) - own).dot(j.r_ij);
  });
  if (!flow.misses_neighbours || !flow.gradient.is_known) return sum;
  // Σ w_j ∇u r·r over the missing ones: that over the full lattice, ∇·u, less that over the others.
  sum += flow.gradient.value.trace();
  detail::for_each_with_slope<Dim, Real>(at, walls, [&](const auto& j, Real slope) {
    sum -= slope * multiply<Dim, Real>(flow.gradient.value, j.r_ij).dot(j.r_ij);
  });
  return sum;
}

}  // namespace silt::mps
