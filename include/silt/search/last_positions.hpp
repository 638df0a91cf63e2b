// SPDX-License-Identifier: MIT
// Where particles were when a search last looked, and how far they have moved since. A step that
// fails takes a look back.
#pragma once

#include <silt/core/fields.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace silt {

template <int Dim, class RealType>
class LastPositions {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Of an owned particle, or a ghost [m].
  const Vec& operator[](Index i) const { return positions_[i]; }
  std::span<const Vec> first(Index n) const { return {positions_.data(), n}; }

  /// Whether the positions are of these particles, place by place.
  template <class P>
  bool are_of(const P& particles) const {
    return particles.owned_revision() == look_.revision && particles.size() == look_.owned;
  }

  /// How far [m] the farthest has moved from these positions, of the owned particles; infinity if
  /// a position is no number.
  template <class P>
  Real farthest_from(const std::vector<Vec>& reference, const P& particles) {
    const auto* const x = lanes_of(particles[position].data());
    const auto* const from = lanes_of(reference.data());
    return farthest(particles.size(), [=](Index i) { return (x[i] - from[i]).squaredNorm(); });
  }

  /// Begins a look: takes the owned particles, and tells how far [m] the farthest has moved since
  /// the one before. Does neither if that was of others.
  template <class P>
  std::optional<Real> take_owned(const P& particles) {
    const std::span<const Vec> before = set_aside();
    if (!are_of(particles)) return std::nullopt;
    const auto* const x = lanes_of(particles[position].data());
    const auto* const last = lanes_of(before.data());
    auto* const taken = lanes_of(positions_.data());
    return farthest(particles.size(), [=](Index i) {
      const auto moved = (x[i] - last[i]).squaredNorm();
      taken[i] = x[i];
      return moved;
    });
  }
  /// Ends it: of the same particles, with their ghosts.
  template <class P>
  void take_ghosts(const P& particles) {
    const auto x = particles.with_ghosts(position);
    const auto owned = static_cast<std::ptrdiff_t>(particles.size());
    positions_.resize(x.size());
    std::copy(x.begin() + owned, x.end(), positions_.begin() + owned);
    note(particles);
  }
  /// Or of others.
  template <class P>
  void take_all(const P& particles) {
    const auto x = particles.with_ghosts(position);
    positions_.assign(x.begin(), x.end());
    note(particles);
  }

  void save() noexcept {
    saved_ = look_;
    keeps_last_ = false;
  }
  void restore() noexcept {
    look_ = saved_;
    if (keeps_last_) positions_.swap(last_);
    keeps_last_ = false;
  }

 private:
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  struct Look {
    std::uint64_t revision = 0;  // of the owned particles
    Index owned = 0;             // of them
  };

  template <class P>
  void note(const P& particles) {
    look_ = {.revision = particles.owned_revision(), .owned = particles.size()};
  }

  // Those of the last look; new ones do not write over them while a step may be undone.
  std::span<const Vec> set_aside() {
    if (keeps_last_) return positions_;
    positions_.swap(last_);
    positions_.resize(last_.size());
    keeps_last_ = true;
    return last_;
  }

  // √ of the largest of squared(i); infinity if one is no number.
  template <class Squared>
  Real farthest(Index n, Squared&& squared) {
    // Of numbers that are not negative the larger has the larger bits, and what is no number has
    // the largest: unlike the larger of two Reals, that is found for many at once.
    constexpr Bits without_sign = ~Bits(0) / 2;
    farthest_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) {
      Bits most = 0;
      SILT_EACH_LANE_ALONE
      for (Index i = chunk.first; i < chunk.last; ++i) {
        most = std::max(most, std::bit_cast<Bits>(Real(squared(i))) & without_sign);
      }
      farthest_[chunk.number] = most;
    });
    if (farthest_.empty()) return 0;
    const auto most = std::bit_cast<Real>(*std::max_element(farthest_.begin(), farthest_.end()));
    return most >= 0 ? std::sqrt(most) : std::numeric_limits<Real>::infinity();
  }

  std::vector<Vec> positions_;  // with ghosts
  std::vector<Vec> last_;       // of the look before the step
  bool keeps_last_ = true;
  Look look_;
  Look saved_;
  std::vector<Bits> farthest_;  // squared, by chunk
};

}  // namespace silt
