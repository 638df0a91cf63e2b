// SPDX-License-Identifier: MIT
// The force per mass F on the particles of a flow: gravity, and, if there are any, a body force and
// the exchange with the second phase of a mixture.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>

namespace silt::mps {

/// F of a flow: the acceleration of its particles by gravity, the body force and the exchange.
template <int Dim, class RealType>
class BodyForce {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  BodyForce() = default;
  /// Gravity g [m/s²].
  explicit BodyForce(const Vec& gravity) : gravity_(gravity) {}

  /// Evaluates F at the positions of the particles and this time [s]; `further` is
  /// FlowSettings::body_force.
  template <FluidParticles P, class Force>
  void find(const P& particles, const Force& further, double time) {
    constexpr bool has_exchange = ParticlesInMixture<P>;
    forces_.clear();
    if (!further && !has_exchange) return;
    const auto x = particles.with_halo(position);
    forces_.resize(x.size());
    for_each(x.size(), [&](Index i) {
      forces_[i] = gravity_;
      if (further) forces_[i] += further(x[i].template cast<double>(), time).template cast<Real>();
      if constexpr (has_exchange) forces_[i] += particles[momentum_exchange][i];
    });
  }

  const Vec& gravity() const noexcept { return gravity_; }  ///< g [m/s²]
  /// F at a particle, owned or of the halo [m/s²].
  Vec operator[](Index i) const { return forces_.empty() ? gravity_ : forces_[i]; }
  /// F at each of these [m/s²]; empty if it is gravity only.
  const Buffer<Vec>& values() const noexcept { return forces_; }

 private:
  Vec gravity_ = Vec::Zero();
  Buffer<Vec> forces_;
};

}  // namespace silt::mps
