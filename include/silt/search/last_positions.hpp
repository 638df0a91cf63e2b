// SPDX-License-Identifier: MIT
// Positions of the particles at the last update of a search, and displacements since. Failed steps
// can be rolled back.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_SEARCH_LAST_POSITIONS
#define SILT_SEARCH_LAST_POSITIONS

#include <silt/core/buffer.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/nearest_image.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/shared_array.hpp>
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

#define SILT_KERNELS <silt/search/last_positions.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt {

namespace detail {
template <class Real, class Bits, class Squared>
Bits largest_bits_of(const Squared& squared, Chunk chunk) {
  return SILT_FOR_PROCESSOR(largest_bits<Real, Bits, Squared>)(squared, chunk);
}
}  // namespace detail

/// Remembers positions, to find out how far particles have moved.
template <int Dim, class RealType>
class LastPositions {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// Position of a particle, owned or of the halo, or of a ghost [m].
  const Vec& operator[](Index i) const { return positions_[i]; }
  /// The positions of the first n particles [m].
  std::span<const Vec> first(Index n) const { return {positions_.data(), n}; }
  /// All of them, to be kept by others.
  const SharedArray<Vec>& shared() const { return positions_; }

  /// Whether the positions are those of these particles, in the same order.
  template <class P>
  bool belong_to(const P& particles) const {
    return particles.owned_revision() == update_.revision && particles.local() == update_.local;
  }

  /// Maximum displacement [m] of the particles, owned and of the halo, from these positions, where
  /// crossing a periodic side does not count; infinity if a position is NaN.
  template <class P>
  Real max_displacement_from(const SharedArray<Vec>& reference, const P& particles) {
    const auto x = lanes_of(particles.with_halo(position));
    const auto* const from = lanes_of(reference.data());
    const NearestImage<Dim, Real> image(particles.box());
    const auto squared = [=](Index i) {
      std::remove_cvref_t<decltype(from[i])> r = x[i] - from[i];
      for (int k = 0; k < Dim; ++k) image.apply(k, r[k]);
      return r.squaredNorm();
    };
    maxima_.resize(chunk_count(particles.local()));
    for_each_chunk(particles.local(), [&](Chunk chunk) {
      maxima_[chunk.number] = detail::largest_bits_of<Real, Bits>(squared, chunk);
    });
    if (maxima_.empty()) return 0;
    const auto maximum = std::bit_cast<Real>(*std::max_element(maxima_.begin(), maxima_.end()));
    return maximum >= 0 ? std::sqrt(maximum) : std::numeric_limits<Real>::infinity();
  }

  /// Begins an update: copies the positions of the particles, owned and of the halo, and returns
  /// their maximum displacement [m] since the previous update. Copies nothing and returns nothing
  /// if that was with other particles.
  template <class P>
  std::optional<Real> update_local(const P& particles) {
    const bool is_first = !has_previous_;
    keep_previous();
    if (!belong_to(particles)) return std::nullopt;
    const Real moved = max_displacement_from(is_first ? previous_ : positions_, particles);
    Vec* const current = positions_.resize(positions_.size());
    const auto x = particles.with_halo(position);
    for_each(particles.local(), [=](Index i) { current[i] = x[i]; });
    return moved;
  }
  /// Ends an update with the same particles: copies the positions of their ghosts.
  template <class P>
  void update_ghosts(const P& particles) {
    const auto x = particles.with_ghosts(position);
    const auto rows = static_cast<std::ptrdiff_t>(particles.local());
    std::copy(x.begin() + rows, x.end(), positions_.resize(x.size()) + rows);
  }
  /// Ends an update with other particles: copies all positions.
  template <class P>
  void update_all(const P& particles) {
    const auto x = particles.with_ghosts(position);
    positions_.assign(x.begin(), x.end());
    set_owner(particles);
  }

  void save() noexcept {
    saved_ = update_;
    has_previous_ = false;
  }
  void restore() noexcept {
    update_ = saved_;
    if (has_previous_) positions_.swap(previous_);
    has_previous_ = false;
  }

 private:
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  struct Update {
    std::uint64_t revision = 0;  // of the owned particles
    Index local = 0;             // number of these and of the halo
  };

  template <class P>
  void set_owner(const P& particles) {
    update_ = {.revision = particles.owned_revision(), .local = particles.local()};
  }

  // Keeps the positions of the last update before the step, for rolling back.
  void keep_previous() {
    if (has_previous_) return;
    previous_.renew(positions_.size());  // may throw: before anything is changed
    positions_.swap(previous_);
    has_previous_ = true;
  }

  SharedArray<Vec> positions_;  // with ghosts
  SharedArray<Vec> previous_;   // of the last update before the step
  bool has_previous_ = true;
  Update update_;
  Update saved_;
  Buffer<Bits> maxima_;  // squared, by chunk
};

}  // namespace silt

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {

/// The maximum of squared(i) over a chunk, as bits: those of non-negative numbers compare as the
/// numbers do, and those of NaN are the largest. Unlike the maximum of Reals, it is vectorised.
template <class Real, class Bits, class Squared>
[[gnu::flatten, gnu::noinline]] Bits largest_bits(const Squared& of, Chunk chunk) {
  constexpr Bits without_sign = ~Bits(0) / 2;
  const Squared squared = of;
  Bits maximum = 0;
  SILT_INDEPENDENT_ITERATIONS
  for (Index i = chunk.first; i < chunk.last; ++i) {
    maximum = std::max(maximum, std::bit_cast<Bits>(Real(squared(i))) & without_sign);
  }
  return maximum;
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
