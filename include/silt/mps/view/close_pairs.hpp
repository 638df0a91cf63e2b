// SPDX-License-Identifier: MIT
// The close pairs of a particle, for which a collision model is evaluated.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/policy/collision.hpp>

namespace silt::mps {

/// Which pairs collide in a step, the same for all particles.
template <class RealType>
struct CloseRange {
  using Real = RealType;

  Real reach;        ///< [m]
  float min_weight;  ///< below that of any neighbour within reach [-]
  Real time_step;    ///< Δt [s]

  /// reach is that of the collision model of the settings; step is Δt [s].
  template <class Stencil, class Settings>
  CloseRange(const Stencil& stencil, const Settings& settings, double step)
      : reach(Real(settings.collision.reach() * settings.spacing)),
        // Weights decrease with the distance; the factor is a margin for round-off.
        min_weight(static_cast<float>(stencil.weight(reach)) * (1 - 0x1p-16f)),
        time_step(Real(step)) {}
};

/// The pairs of one particle that are closer than the reach of the collisions of a flow, with the
/// velocities before all of them. Refers to its arguments: valid during the call that it is given to.
/// Velocities of ghosts must be up to date.
template <class Operators, FluidParticles P>
class ClosePairs {
 public:
  static constexpr int dimension = P::dimension;
  using Real = typename P::Real;
  using Vec = silt::Vec<dimension, Real>;
  using Pair = CollidingPair<dimension, Real>;

  /// The close pairs of particle i.
  ClosePairs(const P& particles, const Operators& operators, const CloseRange<Real>& range,
             Index i)
      : particles_(particles), operators_(operators), range_(range), index_(i) {}

  Index index() const { return index_; }
  /// Position of the particle [m].
  Vec position() const { return particles_[silt::position][index_]; }
  /// The owned particle of which j is a ghost, or j itself.
  Index owner(Index j) const { return particles_.owner(j); }
  /// Kind of a particle or ghost j.
  Kind kind(Index j) const { return particles_.with_ghosts(mps::kind)[j]; }

  /// f(pair, j) for each; j is an owned or ghost particle.
  template <class F>
  void for_each(F&& f) const {
    const auto u = particles_.with_ghosts(velocity);
    const auto kinds = particles_.with_ghosts(mps::kind);
    operators_.neighbourhood().for_each_closer(
        index_, range_.reach, range_.min_weight, [&](Index j, const Vec& r_ij, Real r) {
          f(pair(r_ij, r, u[j] - u[index_], {.wall = kinds[j] != Kind::fluid}), j);
        });
  }
  /// f(pair, j) for the images of particles j that walls add to the neighbours.
  template <class F>
  [[gnu::always_inline]] void for_each_image(F&& f) const {
    const auto u = particles_.with_ghosts(velocity);
    operators_.for_each_image(index_, [&](const auto& image) {
      const Real r = image.r_ij.norm();
      if (!(r < range_.reach)) return;
      f(pair(image.r_ij, r, image.mirrored(u) - u[index_], {.image = true}), image.index);
    });
  }

 private:
  struct What {
    bool wall = false;
    bool image = false;
  };
  Pair pair(const Vec& r_ij, Real r, const Vec& u_ij, const What& j) const {
    return {.r_ij = r_ij,
            .r = r,
            .u_ij = u_ij,
            .wall = j.wall,
            .image = j.image,
            .spacing = operators_.stencil().spacing,
            .time_step = range_.time_step};
  }

  const P& particles_;
  const Operators& operators_;
  const CloseRange<Real>& range_;
  Index index_;
};

}  // namespace silt::mps
