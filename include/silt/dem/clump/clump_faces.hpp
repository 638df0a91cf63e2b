// SPDX-License-Identifier: MIT
// The surfaces of clumps, for pictures.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/clump/clumps.hpp>
#include <silt/geometry/ball.hpp>
#include <silt/geometry/face.hpp>
#include <silt/geometry/rigid_body.hpp>
#include <silt/geometry/shapes.hpp>

#include <algorithm>
#include <cstddef>
#include <vector>

namespace silt::dem {

/// f(face, k, state) for the faces of the surface of each clump k, in space [m]: those of its
/// spheres, 42 corners a sphere, without those that lie within another sphere of the clump.
template <int Dim, class P, class F>
void for_each_face(const Clumps<Dim>& clumps, const P& grains, F&& f) {
  const auto outlines = [] {
    if constexpr (Dim == 2) {
      return faces_of_disc(Vec<2>::Zero(), 1, 0.2);
    } else {
      return faces_of_sphere(Vec<3>::Zero(), 1, 0.7);
    }
  }();
  std::vector<Ball<Dim>> balls;
  for (Index k = 0; k < clumps.size(); ++k) {
    const BodyState<Dim> now = clumps.state(k);
    balls.clear();
    clumps.for_each_sphere(grains, k, [&](Index i, const Vec<Dim>& r) {
      balls.push_back({Vec<Dim>(now.position + r), double(grains[radius][i])});
    });
    for (std::size_t s = 0; s < balls.size(); ++s) {
      const auto is_hidden = [&](const Face<Dim>& face) {
        for (std::size_t other = 0; other < balls.size(); ++other) {
          const auto is_in_other = [&](const Vec<Dim>& x) {
            return other != s && (x - balls[other].centre).norm() < balls[other].radius;
          };
          if (std::all_of(face.corners.begin(), face.corners.end(), is_in_other)) return true;
        }
        return false;
      };
      for (Face<Dim> face : outlines) {
        for (Vec<Dim>& x : face.corners) x = balls[s].centre + balls[s].radius * x;
        if (!is_hidden(face)) f(face, k, now);
      }
    }
  }
}

}  // namespace silt::dem
