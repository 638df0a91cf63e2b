// SPDX-License-Identifier: MIT
// Which grains have contacts that touch: where few do, sums over the others' contacts, all zero,
// would take most of the time.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_list.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace silt::dem::detail {

/// A set of grains, one bit each. Threads may change it at the same time, but not for grains of the
/// same block.
class TouchingGrains {
 public:
  void resize(Index grains) { words_.resize(block_count(grains) * words_per_block); }

  void clear() { std::fill(words_.begin(), words_.end(), std::uint64_t(0)); }
  void add(Index grain) { words_[grain / 64] |= std::uint64_t(1) << (grain % 64); }
  void add_block(Index block) {
    std::fill_n(words_.begin() + std::ptrdiff_t(block * words_per_block), words_per_block,
                ~std::uint64_t(0));
  }

  /// f(grain) for each grain of the set in [first, last).
  template <class F>
  void for_each(Index first, Index last, F&& f) const {
    for (Index begin = first; begin < last; begin = (begin / 64 + 1) * 64) {
      const Index end = std::min(last, (begin / 64 + 1) * 64);
      std::uint64_t bits = words_[begin / 64] >> (begin % 64) << (begin % 64);
      if (end % 64 != 0) bits &= (std::uint64_t(1) << (end % 64)) - 1;
      for (; bits != 0; bits &= bits - 1) {
        f(begin / 64 * 64 + static_cast<Index>(std::countr_zero(bits)));
      }
    }
  }

 private:
  static constexpr Index words_per_block = block_size / 64;
  static_assert(block_size % 64 == 0);
  Buffer<std::uint64_t> words_;
};

}  // namespace silt::dem::detail
