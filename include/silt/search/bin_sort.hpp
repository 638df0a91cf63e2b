// SPDX-License-Identifier: MIT
// Parallel counting sort of particles by bin. It is stable: particles of one bin keep the order of
// their indices, so that the result is the same for any number of threads.
//
//   bin      [ 2 0 2 1 0 ]       by particle
//   start    [ 0 2 3 5 ]         first slot of each bin, and the number of particles
//   item_of  [ 1 4 3 0 2 ]       by slot
//   slot_of  [ 3 0 4 2 1 ]       by particle
//
// Particles that are in order already, as after Particles::reorder, are not counted.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>

namespace silt {

/// Sorts the numbers 0 … n−1 of particles by bin.
class BinSort {
 public:
  /// bins_of(chunk, bins) writes the bins of the particles of a chunk.
  using BinsOf = FunctionRef<void(Chunk, std::uint32_t*)>;

  /// Sorts 0 … n-1 by their bins, from 0 to bins - 1; n and bins are less than 2³². in_order(chunk)
  /// is called for every chunk whose particles are in order, which are all if descents() is 0.
  void sort(Index n, Index bins, BinsOf bins_of, FunctionRef<void(Chunk)> in_order) {
    resize_tightly(bin_, n);
    resize_tightly(start_, bins + 1);
    descents_of_.resize(chunk_count(n));
    for_each_chunk(n, [&](Chunk chunk) {
      Index descents = 0;
      bins_of(chunk, bin_.data() + chunk.first);
      for (Index i = chunk.first + 1; i < chunk.last; ++i) descents += bin_[i] < bin_[i - 1];
      descents_of_[chunk.number] = descents;
      if (descents == 0) in_order(chunk);
    });
    descents_ = std::accumulate(descents_of_.begin(), descents_of_.end(), Index{0});
    for (Index i = chunk_size; i < n; i += chunk_size) descents_ += bin_[i] < bin_[i - 1];
    if (descents_ == 0) {
      set_identity();
    } else {
      count_and_sort();
    }
  }

  Index size() const noexcept { return bin_.size(); }
  /// Number of particles in a lower bin than the previous particle; 0 if all are in order.
  Index descents() const noexcept { return descents_; }

  /// Sum of m² over all bins with m particles [-]; if none has 31 or more, it may be 0 instead.
  double squares() const {
    // A bin with 31 or more has an aligned window of 16, one with 16 or more may have one. To test
    // these windows is much faster than to read all bins; there may be 16 for each particle.
    constexpr Index window = 16;
    bool is_crowded = false;
    for (Index slot = 0; slot + window <= size() && !is_crowded; slot += window) {
      is_crowded = bin_[item_of_[slot]] == bin_[item_of_[slot + window - 1]];
    }
    double sum = 0;
    for (Index bin = 0; is_crowded && bin + 1 < start_.size(); ++bin) {
      sum += squared(double(start_[bin + 1] - start_[bin]));
    }
    return sum;
  }

  /// The first slot of each bin, and the number of particles.
  std::span<const std::uint32_t> start() const noexcept { return start_; }
  /// The particle in each slot.
  std::span<const std::uint32_t> item_of() const noexcept { return {item_of_.data(), size()}; }
  /// The slot of each particle.
  std::span<const std::uint32_t> slot_of() const noexcept { return slot_of_; }

 private:
  void set_identity() {
    const Index n = size();
    const Index bins = start_.size() - 1;
    if (!in_order_ || slot_of_.size() != n) {
      resize();
      std::iota(slot_of_.begin(), slot_of_.end(), std::uint32_t{0});
      std::iota(item_of_.begin(), item_of_.end(), std::uint32_t{0});
      in_order_ = true;
    }
    for_each_chunk(n, [&](Chunk chunk) { set_starts(chunk); });
    std::fill(start_.begin() + (n == 0 ? 0 : static_cast<std::ptrdiff_t>(bin_[n - 1]) + 1),
              start_.begin() + static_cast<std::ptrdiff_t>(bins) + 1,
              static_cast<std::uint32_t>(n));
  }

  // Sets the starts of the bins above that of the particle before the chunk, up to that of its last
  // particle: each is the first particle whose bin is not lower.
  void set_starts(Chunk chunk) {
    // A particle sets eight starts, most of which the next particles overwrite, because a loop of
    // zero or a few iterations would be mispredicted.
    constexpr Index at_once = 8;
    std::uint32_t* const start = start_.data();
    const Index end = bin_[chunk.last - 1] + Index{1};
    Index bin = chunk.first == 0 ? 0 : bin_[chunk.first - 1] + Index{1};
    Index i = chunk.first;
    for (; i < chunk.last && bin + at_once <= end; ++i) {
      std::fill_n(start + bin, at_once, static_cast<std::uint32_t>(i));
      const Index next = bin_[i] + Index{1};
      if (next > bin + at_once) {
        std::fill(start + bin + at_once, start + next, static_cast<std::uint32_t>(i));
      }
      bin = next;
    }
    for (; i < chunk.last; ++i) {
      for (; bin <= bin_[i]; ++bin) start[bin] = static_cast<std::uint32_t>(i);
    }
  }

  // Each range of particles counts its own particles. The starts are the cumulative sums over
  // bins and, within a bin, over ranges, so that particles keep the order of their indices.
  void count_and_sort() {
    const Index n = size();
    const Index bins = start_.size() - 1;
    const Index ranges = std::min(static_cast<Index>(threads_for(n)), chunk_count(n));
    resize();
    in_order_ = false;
    resize_tightly(next_, ranges * bins);
    const auto for_each_in_range = [&](Index range, auto&& f) {
      for (Index i = n * range / ranges; i < n * (range + 1) / ranges; ++i) f(i);
    };
    // The counts of a range are also summed over each chunk of bins.
    const Index chunks = chunk_count(bins);
    in_chunk_.resize(ranges * chunks);
    for_each_task(ranges, [&](Index range) {
      std::uint32_t* const counts = next_.data() + range * bins;
      std::fill(counts, counts + bins, 0u);
      for_each_in_range(range, [&](Index i) { ++counts[bin_[i]]; });
      for (Index c = 0; c < chunks; ++c) {
        std::uint32_t* const first = counts + c * chunk_size;
        std::uint32_t* const last = counts + std::min(bins, (c + 1) * chunk_size);
        in_chunk_[range * chunks + c] = std::accumulate(first, last, 0u);
      }
    });

    before_chunk_.assign(chunks, 0u);
    for (Index k = 0; k < in_chunk_.size(); ++k) before_chunk_[k % chunks] += in_chunk_[k];
    std::exclusive_scan(before_chunk_.begin(), before_chunk_.end(), before_chunk_.begin(), 0u);
    for_each_chunk(bins, [&](Chunk chunk) {
      std::uint32_t slot = before_chunk_[chunk.number];
      for (Index bin = chunk.first; bin < chunk.last; ++bin) {
        start_[bin] = slot;
        for (Index range = 0; range < ranges; ++range) {
          std::uint32_t& next = next_[range * bins + bin];
          slot += std::exchange(next, slot);
        }
      }
    });
    start_[bins] = static_cast<std::uint32_t>(n);

    for_each_task(ranges, [&](Index range) {
      std::uint32_t* const next = next_.data() + range * bins;
      for_each_in_range(range, [&](Index i) {
        const std::uint32_t slot = next[bin_[i]]++;
        slot_of_[i] = slot;
        item_of_[slot] = static_cast<std::uint32_t>(i);
      });
    });
  }

  // SIMD code may read item_of_ up to one register beyond its end.
  void resize() {
    resize_tightly(slot_of_, size());
    resize_tightly(item_of_, size() + simd::most_lanes<std::uint32_t>);
  }

  Buffer<std::uint32_t> bin_;
  Buffer<std::uint32_t> start_;
  Buffer<std::uint32_t> item_of_;
  Buffer<std::uint32_t> slot_of_;
  Buffer<std::uint32_t> next_;          // by range and bin
  Buffer<std::uint32_t> in_chunk_;      // by range and chunk of bins
  Buffer<std::uint32_t> before_chunk_;  // of bins
  Buffer<Index> descents_of_;           // by chunk
  Index descents_ = 0;
  bool in_order_ = false;
};

}  // namespace silt
