// SPDX-License-Identifier: MIT
// The moments of CorrectedGradient, which the source and the corrector of a step have in common.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/corrected_gradient.hpp>

#include <cstdint>
#include <type_traits>

namespace silt::mps {

/// Of the neighbours with pressure, kept from their first use until the particles move.
template <int Dim, class RealType>
class KeptMoments {
 public:
  using Real = RealType;
  using Moments = CorrectedGradient::Moments<Dim, Real>;

  /// Nothing is kept from now on.
  void clear() { is_known_.clear(); }
  /// Those of this number of particles are kept from now on; none is known.
  void begin(Index particles) {
    is_known_.assign(particles, 0);
    moments_.resize(particles);
  }

  /// Those of particle i, if they are known.
  const Moments* find(Index i) const {
    return i < is_known_.size() && is_known_[i] ? &moments_[i] : nullptr;
  }

  /// gradient.evaluate() of particle i.
  template <class G, class T, class Neighbours>
  [[gnu::always_inline]] inline Vec<Dim, Real> evaluate(Index i, const G& gradient,
                                                        const T& stencil, Real phi_i,
                                                        Neighbours&& for_each) const {
    if constexpr (std::is_same_v<G, CorrectedGradient>) {
      const bool is_kept = i < is_known_.size();
      if (is_kept && is_known_[i]) {
        return gradient.evaluate_with(moments_[i], stencil, phi_i, for_each);
      }
      // One call for both, as all of it is inlined.
      Moments not_kept;
      if (is_kept) is_known_[i] = 1;
      return gradient.evaluate(stencil, phi_i, for_each, is_kept ? moments_[i] : not_kept);
    } else {
      return gradient.evaluate(stencil, phi_i, for_each);
    }
  }

 private:
  // Each written by the evaluation of its particle.
  mutable Buffer<std::uint8_t> is_known_;
  mutable Buffer<Moments> moments_;
};

}  // namespace silt::mps
