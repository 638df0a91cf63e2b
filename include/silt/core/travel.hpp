// SPDX-License-Identifier: MIT
// An upper bound for the displacement of all particles since an earlier time, without a loop over
// the particles.
#pragma once

#include <atomic>
#include <cstdint>

namespace silt {

/// Sum of the maximum displacements of all steps since the last reset, which began the epoch: while
/// `distance` [m] has increased by less than d, no particle has moved by d.
struct Travel {
  std::uint64_t epoch = 0;  ///< number of the reset
  double distance = 0;      ///< [m]

  /// Whether no particle has moved farther than d [m] since `then`; false if `then` belongs to
  /// another epoch.
  bool is_within(double d, const Travel& then) const noexcept {
    return epoch == then.epoch && distance - then.distance <= d;
  }
};

namespace detail {

/// Set by any number of threads, cleared by one. A copy is set, or as the original is; what is
/// moved is as it was, and its source is like a copy.
class Mark {
 public:
  enum class Copied { as_it_is, set };

  Mark() = default;
  explicit Mark(Copied copied) : copied_(copied) {}
  explicit Mark(bool is_set) : is_set_(is_set) {}
  Mark(const Mark& other) noexcept : is_set_(other.value_of_copy()), copied_(other.copied_) {}
  Mark& operator=(const Mark& other) noexcept {
    is_set_.store(other.value_of_copy(), std::memory_order_relaxed);
    return *this;
  }
  Mark(Mark&& other) noexcept
      : is_set_(other.is_set_.exchange(other.value_of_copy(), std::memory_order_relaxed)),
        copied_(other.copied_) {}
  Mark& operator=(Mark&& other) noexcept {
    const bool value = other.is_set_.exchange(other.value_of_copy(), std::memory_order_relaxed);
    is_set_.store(value, std::memory_order_relaxed);
    return *this;
  }
  void set() noexcept {
    if (!is_set_.load(std::memory_order_relaxed)) is_set_.store(true, std::memory_order_relaxed);
  }
  bool is_set() const noexcept { return is_set_.load(std::memory_order_relaxed); }
  /// Returns whether it was set.
  bool test_and_clear() noexcept { return is_set_.exchange(false, std::memory_order_relaxed); }

 private:
  bool value_of_copy() const noexcept {
    return copied_ == Copied::set || is_set_.load(std::memory_order_relaxed);
  }

  std::atomic<bool> is_set_ = true;
  Copied copied_ = Copied::as_it_is;
};

}  // namespace detail

}  // namespace silt
