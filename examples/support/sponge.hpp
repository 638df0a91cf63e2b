// SPDX-License-Identifier: MIT
// A sponge at the end of a tank, which absorbs waves.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps.hpp>

#include "water_waves.hpp"

#include <algorithm>
#include <limits>

namespace support {

/// Policy of a flow: friction between particles, and for x > begin that of the sponge, in which
/// water loses velocity: u' = −rate ((x − begin)/length)² u.
struct Sponge : silt::mps::PairFriction {
  double begin = std::numeric_limits<double>::infinity();  // [m]
  double length = 1;                                       // [m]
  double rate_at_end = 0;                                  // [1/s]

  template <int Dim, class Real>
  class InFlow;
};

template <int Dim, class Real>
class Sponge::InFlow {
 public:
  explicit InFlow(const Sponge& sponge) : sponge_(sponge), of_pairs_(sponge) {}

  void find(const auto& step) {
    of_pairs_.find(step);
    const auto x = step.particles[silt::position];
    shares_.resize(step.particles.size());
    silt::for_each(shares_.size(), [&](silt::Index i) {
      const double s = std::max(0.0, (double(x[i][0]) - sponge_.begin) / sponge_.length);
      const double loss = sponge_.rate_at_end * s * s * double(step.time_step);
      shares_[i] = Real(loss / (1 + loss));
    });
  }
  silt::Vec<Dim, Real> velocity_change(const auto& at) const {
    return of_pairs_.velocity_change(at) - shares_[at.index()] * at.velocity();
  }

 private:
  Sponge sponge_;
  silt::mps::PairFriction::InFlow<Dim, Real> of_pairs_;
  silt::Buffer<Real> shares_;  // of its velocity that a particle loses in a step
};

/// A sponge from begin on, as long as given [m]: waves that go through it and back keep
/// e^{−rate length/(3 speed)} of their height, 1 %.
inline Sponge sponge_for(const LinearWave& wave, double begin, double length) {
  Sponge sponge;
  sponge.begin = begin;
  sponge.length = length;
  sponge.rate_at_end = 14 * wave.group_speed() / length;
  return sponge;
}

}  // namespace support
