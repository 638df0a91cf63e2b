// SPDX-License-Identifier: MIT
// The force per mass F on the particles of a flow: gravity, and a body force if there is one.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <vector>

namespace silt::mps {

template <int Dim, class RealType>
class BodyForce {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  BodyForce() = default;
  explicit BodyForce(const Vec& gravity) : gravity_(gravity) {}

  /// Evaluates F at the positions of the particles and this time [s]; `further` is
  /// FlowSettings::body_force.
  template <FluidParticles P, class Force>
  void find(const P& particles, const Force& further, double time) {
    forces_.clear();
    if (!further) return;
    forces_.resize(particles.size());
    const auto x = particles[position];
    for_each(particles.size(), [&](Index i) {
      forces_[i] = gravity_ + further(x[i].template cast<double>(), time).template cast<Real>();
    });
  }

  const Vec& gravity() const noexcept { return gravity_; }  ///< g [m/s²]
  /// F at an owned particle [m/s²].
  Vec operator[](Index i) const { return forces_.empty() ? gravity_ : forces_[i]; }
  /// F at each owned particle [m/s²]; empty if it is gravity only.
  const std::vector<Vec>& values() const noexcept { return forces_; }

 private:
  Vec gravity_ = Vec::Zero();
  std::vector<Vec> forces_;
};

}  // namespace silt::mps
