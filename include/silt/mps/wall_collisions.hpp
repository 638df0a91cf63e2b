// SPDX-License-Identifier: MIT
// The collisions of a step with images in walls, which are a part of the load of the walls.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <vector>

namespace silt::mps {

template <int Dim>
struct WallCollision {
  Vec<Dim> position;         ///< of the particle [m]
  Vec<Dim> velocity_change;  ///< [m/s]
};

template <int Dim>
class WallCollisions {
 public:
  const std::vector<WallCollision<Dim>>& found() const noexcept { return found_; }
  void clear() noexcept { found_.clear(); }

  /// `changes` are those of the velocities by all collisions, pairs_of(i) the close pairs of a
  /// particle. They are few: particles that are stopped by the pressure do not collide.
  template <FluidParticles P, class Vec, class PairsOf, class Model>
  void find(const P& particles, const std::vector<Vec>& changes, PairsOf&& pairs_of,
            const Model& collision) {
    for (Index i = 0; i < changes.size(); ++i) {
      if ((changes[i].array() == 0).all()) continue;
      Vec change = Vec::Zero();
      pairs_of(i).for_each_image(
          [&](const auto& pair, Index) { change += collision.velocity_change(pair); });
      if ((change.array() == 0).all()) continue;
      found_.push_back({particles[position][i].template cast<double>(),
                        change.template cast<double>()});
    }
  }

 private:
  std::vector<WallCollision<Dim>> found_;
};

}  // namespace silt::mps
