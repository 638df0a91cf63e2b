// SPDX-License-Identifier: MIT
// Grains whose forces are summed after other threads have evaluated their contacts. The last of these
// threads sums them, with the help of threads that have nothing else to do: none waits for another,
// which may be asleep.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace silt::dem::detail {

/// Ranges of grains in the blocks of one thread, and the threads that must have evaluated their
/// contacts before.
class DeferredRanges {
 public:
  /// Single grains would take several times as long.
  static constexpr Index size = 32;

  void clear(Index threads) {
    ranges_.clear();
    needs_.assign(threads, false);
    number_of_threads_ = 0;
  }
  void add(Index first, Index last) { ranges_.push_back({first, last}); }
  void add_thread(Index thread) {
    number_of_threads_ += !needs_[thread];
    needs_[thread] = true;
  }

  /// No thread has evaluated its contacts.
  void begin_step() {
    waits_for_ = number_of_threads_;
    next_ = 0;
  }
  /// A thread has.
  void finish(Index thread) {
    if (needs_[thread]) std::atomic_ref(waits_for_).fetch_sub(1, std::memory_order_acq_rel);
  }
  /// f(first, last) for the ranges that no other thread has taken, if all have.
  template <class F>
  void take_if_ready(F&& f) {
    if (std::atomic_ref(waits_for_).load(std::memory_order_acquire) > 0) return;
    std::atomic_ref next(next_);
    while (are_any_left()) {
      const Index k = next.fetch_add(1, std::memory_order_relaxed);
      if (k < ranges_.size()) f(ranges_[k].first, ranges_[k].last);
    }
  }
  bool are_any_left() {
    return std::atomic_ref(next_).load(std::memory_order_relaxed) < ranges_.size();
  }

 private:
  struct Range {
    Index first;
    Index last;
  };
  Buffer<Range> ranges_;
  Buffer<char> needs_;  // by thread
  Index number_of_threads_ = 0;
  Index waits_for_ = 0;  // of these, in this step
  Index next_ = 0;       // range to be taken
};

/// Those of all threads.
class DeferredGrains {
 public:
  void clear(Index threads) { of_threads_.resize(threads); }
  DeferredRanges& of(Index thread) { return of_threads_[thread]; }

  /// No thread has evaluated its contacts.
  void begin_step() {
    for (DeferredRanges& each : of_threads_) each.begin_step();
  }
  /// A thread has: f(first, last) for ranges of grains, until there are none left that it could take.
  template <class F>
  void finish(Index thread, F&& f) {
    for (DeferredRanges& each : of_threads_) each.finish(thread);
    for (int tries = 0; tries < 2000; ++tries) {
      bool are_any_left = false;
      for (DeferredRanges& each : of_threads_) {
        each.take_if_ready(f);
        are_any_left |= each.are_any_left();
      }
      if (!are_any_left) return;
      pause();
    }
  }

 private:
  static void pause() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#endif
  }

  Buffer<DeferredRanges> of_threads_;
};

}  // namespace silt::dem::detail
