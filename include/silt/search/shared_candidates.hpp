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

  Index size() const noexcept { return count_; }

  /// Writes the candidates near slot `slot` of the block, or only those after it (`forward`), to
  /// `to`, and returns their end. There must be space for all candidates and one more register.
  std::uint32_t* near(Index slot, bool forward, std::uint32_t* to) const {
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
    return simd::compress_near<N>(x, forward ? own + 1 : 0, count_, centre, reach_, item,
                                  items_[slot], to);
  }

 private:
  static constexpr int lanes = simd::lanes<Real>;
  using Lanes = simd::Pack<float, lanes>;
  // Number of particles from which testing the bounding box saves time.
  static constexpr Index dense = 16;

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
  std::array<std::vector<float>, Dim> near_x_;
  std::vector<std::uint32_t> near_items_;
};

}  // namespace silt
