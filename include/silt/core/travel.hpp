// SPDX-License-Identifier: MIT
// An upper bound for the displacement of all particles since an earlier time, without a loop over
// the particles.
#pragma once

#include <atomic>
#include <concepts>
#include <cstdint>

namespace silt {

/// A number that is unique in the process; a copy gets a new one.
class Epoch {
 public:
  Epoch() : number_(++last()) {}
  Epoch(const Epoch&) : Epoch() {}
  Epoch& operator=(const Epoch&) {
    number_ = ++last();
    return *this;
  }
  std::uint64_t number() const noexcept { return number_; }

 private:
  static std::atomic<std::uint64_t>& last() noexcept {
    static std::atomic<std::uint64_t> number = 0;
    return number;
  }
  std::uint64_t number_;
};

/// Sum of the maximum displacements of all steps since the last reset, which began the epoch: while
/// `distance` [m] has increased by less than d, no particle has moved by d.
struct Travel {
  std::uint64_t epoch = 0;
  double distance = 0;

  /// Whether no particle has moved farther than d [m] since `then`; false if `then` belongs to
  /// another epoch.
  bool is_within(double d, const Travel& then) const noexcept {
    return epoch == then.epoch && distance - then.distance <= d;
  }
};

namespace detail {

/// Set by any number of threads, taken by one. A copy is set.
class Mark {
 public:
  Mark() = default;
  Mark(const Mark&) noexcept {}
  Mark& operator=(const Mark&) noexcept {
    set();
    return *this;
  }
  void set() noexcept {
    if (!is_set_.load(std::memory_order_relaxed)) is_set_.store(true, std::memory_order_relaxed);
  }
  /// Clears it; returns whether it was set.
  bool take() noexcept { return is_set_.exchange(false, std::memory_order_relaxed); }

 private:
  std::atomic<bool> is_set_ = true;
};

}  // namespace detail

}  // namespace silt
