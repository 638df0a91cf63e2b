// SPDX-License-Identifier: MIT
// Candidates that the particles of one block (a few cells in a row) share: found once, tested by
// each of them. In a dense block, those that none of them can reach, because they are beyond the
// radius from the block's bounding box, are dropped on the way:
//
//     . ┌─────────┐ .      x  dropped
//   x   │ o ┌───┐ │        o  kept
//       │   │i i│ │ o      i  of the block
//     x └───┴───┴─┘   x
//
// Candidates are kept relative to the block and in single precision, so that a register tests twice
// as many: this close, rounding moves a particle by less than the tolerance by which the reach is
// widened. What passes is a neighbour, or a neighbour but for rounding.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace silt {

template <int Dim, class Real>
class SharedCandidates {
 public:
  using Columns = simd::Columns<Dim, Real>;

  /// Begins the block of the slots [first, last) of the columns x, whose particles are `items`.
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

  /// Adds the slots [first, last), or those of them that may be near. A range that overlaps with
  /// the block contains it.
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

  Index size() const noexcept { return count_; }

  /// Writes the candidates that lie near slot `slot` of the block, or those behind it only, to
  /// `to`, and returns where they end. There must be room for all, and a register beyond.
  std::uint32_t* near(Index slot, bool onwards, std::uint32_t* to) const {
    constexpr int N = simd::lanes<float>;
    const Index own = own_ + (slot - first_);
    simd::Columns<Dim, float> x;
    std::array<float, Dim> centre;
    for (std::size_t k = 0; k < Dim; ++k) {
      x[k] = near_x_[k].data();
      centre[k] = near_x_[k][own];
    }
    const auto item = [items = near_items_.data()](Index s) {
      return simd::load<std::uint32_t, N>(items + s);
    };
    return simd::compress_near<N>(x, onwards ? own + 1 : 0, count_, centre, reach_, item,
                                  items_[slot], to);
  }

 private:
  static constexpr int lanes = simd::lanes<Real>;
  using Lanes = simd::Pack<float, lanes>;
  // From so many particles on, a bounding box is worth its price.
  static constexpr Index dense = 12;

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
      } at[Dim];
      Lanes r2{};
      for (std::size_t k = 0; k < Dim; ++k) {
        at[k].x = relative(x[k] + s, origin[k]);
        const Lanes away = simd::abs<float, lanes>(at[k].x) - half[k];
        const Lanes beyond = away > 0 ? away : Lanes{};
        r2 += beyond * beyond;
      }
      const simd::Mask close =
          simd::less<float, lanes>(r2, limit) & simd::first_lanes<lanes>(last - s);
      for (std::size_t k = 0; k < Dim; ++k) {
        simd::compress<float, lanes>(to[k] + count, at[k].x, close);
      }
      count += simd::compress<std::uint32_t, lanes>(
          near_items_.data() + count, simd::load<std::uint32_t, lanes>(items_ + s), close);
    }
    count_ = count;
  }

  void reserve(Index most) {
    if (most <= near_items_.size()) return;
    for (auto& x : near_x_) x.resize(2 * most);
    near_items_.resize(2 * most);
  }

  Columns x_{};
  const std::uint32_t* items_ = nullptr;
  Index first_ = 0;
  Index last_ = 0;
  bool is_dense_ = false;
  std::array<Real, Dim> origin_{};   // middle of the block
  std::array<float, Dim> half_{};    // its size, halved
  float reach_ = 0;                  // squared
  Index own_ = 0;                    // place of the block's first among the candidates
  Index count_ = 0;
  std::array<std::vector<float>, Dim> near_x_;
  std::vector<std::uint32_t> near_items_;
};

}  // namespace silt
