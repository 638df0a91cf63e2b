// SPDX-License-Identifier: MIT
// The order in which particles are to be put.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <span>

namespace silt::detail {

/// An order of particles, which moves their rows without a copy of all: cycle by cycle. Refers to
/// its argument.
class Permutation {
 public:
  /// Throws unless `order` has each of 0 … size-1 once.
  Permutation(std::span<const Index> order, Index size) : order_(order), to_move_(size, 0) {
    bool good = order.size() == size;
    for (Index k = 0; good && k < order.size(); ++k) {
      good = order[k] < size && !to_move_[order[k]];
      if (good) to_move_[order[k]] = 1;
    }
    if (!good) {
      fail({"Particles::reorder: the order of ", order.size(),
            " indices is not a permutation of the ", size, " particles; give each index once"});
    }
  }

  /// rows.move(order[i], i) for every row i, where no_index is a place of its own, which the rows
  /// have for one row. Once.
  template <class Rows>
  void move(Rows&& rows) noexcept {
    for (Index i = 0; i < order_.size(); ++i) {
      if (!to_move_[i] || order_[i] == i) continue;
      rows.move(i, no_index);
      Index to = i;
      for (; order_[to] != i; to = order_[to]) {
        rows.move(order_[to], to);
        to_move_[to] = 0;
      }
      rows.move(no_index, to);
      to_move_[to] = 0;
    }
  }

 private:
  std::span<const Index> order_;
  Buffer<char> to_move_;  // by row, 1 until it has been moved
};

}  // namespace silt::detail
