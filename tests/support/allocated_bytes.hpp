// SPDX-License-Identifier: MIT
// The bytes allocated by operator new in programs of which one file includes
// failing_allocations.hpp.
#pragma once

#include <atomic>
#include <cstdint>

namespace silt::test {

struct AllocatedBytes {
  std::atomic<std::int64_t> now{0};
  std::atomic<std::int64_t> most{0};

  void add(std::int64_t bytes) noexcept {
    const std::int64_t sum = now += bytes;
    if (sum > most.load(std::memory_order_relaxed)) most = sum;
  }
};
inline AllocatedBytes allocated_bytes;

/// The largest number of bytes that f() has allocated, and not yet released, at any time.
template <class F>
std::int64_t bytes_needed_by(F&& f) {
  const std::int64_t before = allocated_bytes.now;
  allocated_bytes.most = before;
  f();
  return allocated_bytes.most - before;
}

}  // namespace silt::test
