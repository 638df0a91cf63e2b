// SPDX-License-Identifier: MIT
// Bytes of a program's operator new, counted by failing_allocations.hpp, of which the program must
// include one copy. Eigen's own memory, of malloc, is not counted.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

namespace silt::test {

inline std::atomic<std::int64_t> bytes_in_use{0};
inline std::atomic<std::int64_t> most_bytes_in_use{0};
/// Allocations beyond this fail, so that a test that would take all memory ends.
inline std::atomic<std::int64_t> most_bytes_allowed{std::int64_t{1} << 40};

/// Calls f(); returns the most bytes that were in use meanwhile, beyond those before. More than
/// 1 GiB throws std::bad_alloc.
template <class F>
std::int64_t peak_of(F&& f) {
  struct Reset {
    std::int64_t allowed = most_bytes_allowed;
    ~Reset() { most_bytes_allowed = allowed; }
  } reset;
  const std::int64_t before = bytes_in_use;
  most_bytes_in_use = before;
  most_bytes_allowed = before + (std::int64_t{1} << 30);
  std::forward<F>(f)();
  return most_bytes_in_use - before;
}

namespace allocator {
/// Returns false, and counts nothing, if so many more bytes are not allowed.
inline bool count(std::int64_t bytes) {
  const std::int64_t now = bytes_in_use.fetch_add(bytes) + bytes;
  if (now > most_bytes_allowed.load(std::memory_order_relaxed)) {
    bytes_in_use -= bytes;
    return false;
  }
  std::int64_t most = most_bytes_in_use;
  while (now > most && !most_bytes_in_use.compare_exchange_weak(most, now)) {
  }
  return true;
}
}  // namespace allocator

}  // namespace silt::test
