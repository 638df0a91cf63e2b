// SPDX-License-Identifier: MIT
// Candidates shared by the particles of one block (a few cells in a row): collected once and tested
// by each particle. In a dense block, candidates beyond the radius from the bounding box of the
// block, which no particle of the block can reach, are dropped:
//
//     . ┌─────────┐ .      x  dropped
//   x   │ o ┌───┐ │        o  kept
//       │   │i i│ │ o      i  of the block
//     x └───┴───┴─┘   x
//
// Positions are stored relative to the block and in single precision, so that a register tests
// twice as many. At such distances the rounding error of a position is smaller than the tolerance
// added to the radius. A candidate that passes the test is a neighbour, or is farther than the
// radius by a rounding error.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

namespace silt {

/// The candidates of one block at a time.
template <int Dim, class Real>
class SharedCandidates {
 public:
  using Columns = simd::Columns<Dim, Real>;

  /// Begins a block with the slots [first, last) of the columns x, whose particles are `items`.
  void begin(const Columns& x, const std::uint32_t* items, Index first, Index last, Real reach) {
    x_ = x;
    items_ = items;
    first_ = first;
    last_ = last;
    count_ = 0;
    reach_ = static_cast<float>(squared(double(reach)) * (1 + 0x1p-15));
    is_dense_ = last - first >= dense;
    for (std::size_t k = 0; k < Dim; ++k) {
      Real lower = x[k][first];
      Real upper = lower;
      for (Index s = first + 1; is_dense_ && s < last; ++s) {
        lower = std::min(lower, x[k][s]);
        upper = std::max(upper, x[k][s]);
      }
      origin_[k] = lower + (upper - lower) / 2;
      half_[k] = static_cast<float>(upper - lower) * (0.5f + 0x1p-20f);
    }
  }

  /// Adds the slots [first, last) as candidates, or those that may be near. A range that overlaps
  /// with the block must contain it.
  void add(Index first, Index last) {
    reserve(count_ + (last - first) + 2 * simd::lanes<float>);
    if (!is_dense_) {
      if (first <= first_ && first_ < last) own_ = count_ + (first_ - first);
      add_all(first, last);
    } else if (first <= first_ && first_ < last) {
      add_close(first, first_);
      own_ = count_;
      add_close(first_, last);
    } else {
      add_close(first, last);
    }
  }

  /// Ends the block: there are no more candidates.
  void end() {
    // The last register is completed with points that are not near.
    constexpr int N = simd::lanes<float>;
    reserve(count_ + N);
    simd::store<float, N>(near_x_[0].data() + count_,
                          simd::broadcast<float, N>(std::numeric_limits<float>::max()));
  }

  Index size() const noexcept { return count_; }

  /// Writes the candidates near slot `slot` of the block, or only those after it (`forward`), to
  /// `to`, and returns their end. There must be space for all candidates and one more register.
  template <bool forward>
  std::uint32_t* near(Index slot, std::uint32_t* to) const {
    constexpr int N = simd::lanes<float>;
    const Index own = own_ + (slot - first_);
    const Index count = count_;
    const std::uint32_t own_item = items_[slot];
    const std::uint32_t* const items = near_items_.data();
    std::array<const float*, Dim> x;
    struct {
      simd::Pack<float, N> x;
    } centre[Dim];
    for (std::size_t k = 0; k < Dim; ++k) {
      x[k] = near_x_[k].data();
      centre[k].x = simd::broadcast<float, N>(x[k][own]);
    }
    const auto limit = simd::broadcast<float, N>(reach_);
    const auto is_near = [&](Index s) {
      simd::Pack<float, N> r2{};
      for (std::size_t k = 0; k < Dim; ++k) {
        const simd::Pack<float, N> d = simd::load<float, N>(x[k] + s) - centre[k].x;
        r2 = k == 0 ? d * d : r2 + d * d;
      }
      return simd::less<float, N>(r2, limit);
    };
    Index s = 0;
    if (forward) {
      // All particles of a block begin at the same few registers: a loop whose length differs from
      // row to row would be mispredicted.
      s = (own + 1) / N * N;
      const simd::Mask after = ~simd::first_lanes<N>(own + 1 - s);
      to += simd::compress<std::uint32_t, N>(to, simd::load<std::uint32_t, N>(items + s),
                                             is_near(s) & after);
      s += N;
    }
    for (; s < count; s += N) {
      const auto item = simd::load<std::uint32_t, N>(items + s);
      simd::Mask mask = is_near(s);
      if (!forward) mask &= simd::differs<N>(item, own_item);
      to += simd::compress<std::uint32_t, N>(to, item, mask);
    }
    return to;
  }

 private:
  static constexpr int lanes = simd::lanes<Real>;
  using Lanes = simd::Pack<float, lanes>;
  // Number of particles from which testing the bounding box saves time.
  static constexpr Index dense = 24;

  Lanes relative(const Real* x, Real origin) const {
    return __builtin_convertvector(simd::load(x) - origin, Lanes);
  }

  void add_all(Index first, Index last) {
    const Columns x = x_;
    const std::array<Real, Dim> origin = origin_;
    std::uint32_t* const items = near_items_.data() + count_;
    std::array<float*, Dim> to;
    for (std::size_t k = 0; k < Dim; ++k) to[k] = near_x_[k].data() + count_;
    for (Index s = first; s < last; s += lanes) {
      for (std::size_t k = 0; k < Dim; ++k) {
        simd::store<float, lanes>(to[k] + (s - first), relative(x[k] + s, origin[k]));
      }
      simd::store<std::uint32_t, lanes>(items + (s - first),
                                        simd::load<std::uint32_t, lanes>(items_ + s));
    }
    count_ += last - first;
  }

  void add_close(Index first, Index last) {
    const Columns x = x_;
    const std::array<Real, Dim> origin = origin_;
    const std::array<float, Dim> half = half_;
    const auto limit = simd::broadcast<float, lanes>(reach_);
    std::array<float*, Dim> to;
    for (std::size_t k = 0; k < Dim; ++k) to[k] = near_x_[k].data();
    Index count = count_;
    for (Index s = first; s < last; s += lanes) {
      struct {
        Lanes x;
      } offset[Dim];
      Lanes r2{};
      for (std::size_t k = 0; k < Dim; ++k) {
        offset[k].x = relative(x[k] + s, origin[k]);
        const Lanes outside = simd::abs<float, lanes>(offset[k].x) - half[k];
        const Lanes distance = outside > 0 ? outside : Lanes{};
        r2 += distance * distance;
      }
      const simd::Mask close =
          simd::less<float, lanes>(r2, limit) & simd::first_lanes<lanes>(last - s);
      for (std::size_t k = 0; k < Dim; ++k) {
        simd::compress<float, lanes>(to[k] + count, offset[k].x, close);
      }
      count += simd::compress<std::uint32_t, lanes>(
          near_items_.data() + count, simd::load<std::uint32_t, lanes>(items_ + s), close);
    }
    count_ = count;
  }

  void reserve(Index size) {
    if (size <= near_items_.size()) return;
    for (auto& x : near_x_) x.resize(2 * size);
    near_items_.resize(2 * size);
  }

  Columns x_{};
  const std::uint32_t* items_ = nullptr;
  Index first_ = 0;
  Index last_ = 0;
  bool is_dense_ = false;
  std::array<Real, Dim> origin_{};   // centre of the block
  std::array<float, Dim> half_{};    // half its size
  float reach_ = 0;                  // squared
  Index own_ = 0;                    // index of the first slot of the block among the candidates
  Index count_ = 0;
  std::array<Buffer<float>, Dim> near_x_;
  Buffer<std::uint32_t> near_items_;
};

}  // namespace silt
