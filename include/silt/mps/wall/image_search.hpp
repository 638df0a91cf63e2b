// SPDX-License-Identifier: MIT
// Finds the images that a particle sees.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/geometry/mirror.hpp>
#include <silt/mps/wall/faces_near_particles.hpp>
#include <silt/mps/wall/image_row.hpp>
#include <silt/mps/wall/wall_motions.hpp>

#include <cstddef>
#include <cstdint>
#include <span>

namespace silt::mps {

/// Adds row i: the images, closer than the reach, of particle i itself and of `others`; with the
/// volumes of the particles, see BulkVolumes.
template <int Dim, class Real, class T, class Volumes>
void add_images(ImageRows<Dim, Real>& images, const FacesNearParticles<Dim>& near, Index i,
                std::span<const std::uint32_t> others, const T& stencil,
                const WallMotions<Dim>& motions, const Volumes& volumes) {
  images.begin_row(i);
  const Vec<Dim> x_i = near.position(i);
  const double reach2 = squared(near.reach());
  static thread_local Buffer<Vec<Dim>> points;  // keeps its capacity
  points.assign(1, x_i);
  for (const std::uint32_t j : others) points.push_back(near.position(j));
  near[i].for_each_mirror(
      points, [&](const Mirror<Dim>& mirror, const auto& share_of, const auto& for_each_plane) {
        // From the image of x_i, the particles are as far as their images from x_i, to round-off.
        const Vec<Dim> viewpoint = mirror.inverse()(x_i);
        const double clearly_beyond = 1.1 * reach2;
        for (std::size_t k = 0; k < points.size(); ++k) {
          if ((points[k] - viewpoint).squaredNorm() > clearly_beyond) continue;
          const Vec<Dim> r_ij = mirror(points[k]) - x_i;
          const double r2 = r_ij.squaredNorm();
          if (!(r2 < reach2)) continue;
          const double share = share_of(points[k]);
          if (!(share > 0)) continue;
          const Index j = k == 0 ? i : others[k - 1];
          images.add(i, j, share * double(volumes[j]), Real(r2), stencil);
        }
        if (!near.faces().move()) return images.end_mirror(i, mirror, nullptr);
        static thread_local Buffer<PlaneOfMirror<Dim>> planes;  // keeps its capacity
        planes.clear();
        bool moves = false;
        for_each_plane([&](const PlaneOfMirror<Dim>& plane) {
          planes.push_back(plane);
          moves = moves || plane.group > 0;
        });
        if (!moves) return images.end_mirror(i, mirror, nullptr);
        const MotionOfMirror<Dim> motion = motions->motion_of(planes);
        images.end_mirror(i, mirror, &motion);
      });
}

}  // namespace silt::mps
