// SPDX-License-Identifier: MIT
// Which grains a bond connects, and which bonds a grain has, by their indices in memory.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace silt::dem::detail {

/// Indices of a bond's two grains; `no_index` for a removed grain.
struct BondEnds {
  Index a;
  Index b;
};
template <class P, class B>
BondEnds ends_of(const P& grains, const B& bond) {
  return {grains.index_of(bond.a), grains.index_of(bond.b)};
}

/// The indices of the grains of each bond, the bonds of each grain, and their stable time step.
/// Updated when bonds or grains are added, removed or reordered.
class BondIndices {
 public:
  template <class P>
  bool are_valid_for(const P& grains) const {
    return is_valid_ && grains.revision() == revision_;
  }
  void invalidate() noexcept { is_valid_ = false; }

  /// Removes the bonds of removed grains from the list and finds the grains of the others.
  template <class P, class B>
  void find(const P& grains, std::vector<B>& bonds) {
    std::erase_if(bonds, [&](const B& bond) {
      const BondEnds ends = ends_of(grains, bond);
      return ends.a == no_index || ends.b == no_index;
    });
    ends_.clear();
    first_.assign(grains.size() + 1, 0);
    for (const B& bond : bonds) {
      const BondEnds ends = ends_of(grains, bond);
      ends_.push_back(ends);
      ++first_[ends.a + 1];
      ++first_[ends.b + 1];
    }
    for (Index i = 0; i < grains.size(); ++i) first_[i + 1] += first_[i];
    numbers_.resize(2 * bonds.size());
    next_.assign(first_.begin(), first_.end() - 1);
    for (Index k = 0; k < bonds.size(); ++k) {
      numbers_[next_[ends_[k].a]++] = k;
      numbers_[next_[ends_[k].b]++] = k;
    }
    revision_ = grains.revision();
    is_valid_ = true;
  }

  const BondEnds& ends(Index bond) const noexcept { return ends_[bond]; }
  /// Indices of the bonds of grain i, in ascending order.
  std::span<const Index> of(Index i) const noexcept {
    return std::span(numbers_).subspan(first_[i], first_[i + 1] - first_[i]);
  }

 private:
  std::vector<BondEnds> ends_;
  Buffer<Index> first_;  // by grain
  Buffer<Index> numbers_;
  Buffer<Index> next_;
  std::uint64_t revision_ = 0;
  bool is_valid_ = false;
};

}  // namespace silt::dem::detail
