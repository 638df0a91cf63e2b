// SPDX-License-Identifier: MIT
// The order in which particles are to be put.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <span>

namespace silt::detail {

/// Throws unless `order` has each of 0 … size-1 once.
inline void check_permutation(std::span<const Index> order, Index size) {
  Buffer<char> seen(size, 0);
  bool good = order.size() == size;
  for (Index k = 0; good && k < order.size(); ++k) {
    good = order[k] < size && !seen[order[k]];
    if (good) seen[order[k]] = 1;
  }
  if (!good) {
    fail({"Particles::reorder: the order of ", order.size(),
          " indices is not a permutation of the ", size, " particles; give each index once"});
  }
}

}  // namespace silt::detail
