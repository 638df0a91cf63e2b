// SPDX-License-Identifier: MIT
// Rows of different lengths in contiguous memory (compressed sparse rows), built in parallel, with
// the same result for any number of threads.
//
//   first  [0     3  4        ]
//   items  [a b c|d |e f g h  ]
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <span>

namespace silt {

/// A list of items for each of many rows.
template <class T>
class Rows {
 public:
  /// Fills row i with the items that f(i, add) passes to add(item). Memory of earlier builds is
  /// reused.
  template <class F>
  void build(Index n, F&& f) {
    first_.assign(n + 1, 0);
    chunks_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) {
      auto& items = chunks_[chunk.number];
      items.clear();
      for (Index i = chunk.first; i < chunk.last; ++i) {
        f(i, [&items](const T& item) { items.push_back(item); });
        first_[i + 1] = items.size();
      }
    });
    for (Index c = 1; c < chunks_.size(); ++c) {
      const Index before = first_[c * chunk_size];
      const Index last = std::min(n, (c + 1) * chunk_size);
      for (Index i = c * chunk_size; i < last; ++i) first_[i + 1] += before;
    }
    items_.resize(first_[n]);
    for_each_chunk(n, [&](Chunk chunk) {
      std::copy(chunks_[chunk.number].begin(), chunks_[chunk.number].end(),
                items_.begin() + static_cast<std::ptrdiff_t>(first_[chunk.first]));
    });
  }

  /// Number of rows.
  Index size() const noexcept { return first_.empty() ? 0 : first_.size() - 1; }

  std::span<const T> operator[](Index row) const noexcept {
    return std::span(items_).subspan(first_[row], first_[row + 1] - first_[row]);
  }

 private:
  Buffer<Index> first_;  // of each row, and the total number
  Buffer<T> items_;
  Buffer<Buffer<T>> chunks_;
};

}  // namespace silt
