// SPDX-License-Identifier: MIT
// Lets one allocation of a program fail, and counts bytes (counted_memory.hpp). Replaces operator
// new; Eigen's own memory, of malloc, never fails. To be included by one source file of a program
// only.
#pragma once

#include "support/counted_memory.hpp"
#include <malloc.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

namespace silt::test {

/// Number of allocations until the one that fails; negative if none does.
inline std::atomic<std::int64_t> allocations_left{-1};

/// Calls f(); its k-th allocation, on any thread, fails. Returns whether f threw std::bad_alloc.
template <class F>
bool fails_with_allocation(std::int64_t k, F&& f) {
  struct Reset {
    ~Reset() { allocations_left = -1; }
  } reset;
  allocations_left = k;
  try {
    f();
  } catch (const std::bad_alloc&) {
    return true;
  }
  return false;
}

namespace allocator {
inline void* allocate(std::size_t bytes, std::size_t alignment) {
  if (allocations_left.load(std::memory_order_relaxed) > 0 && --allocations_left == 0) {
    throw std::bad_alloc();
  }
  const std::size_t whole = (bytes + alignment) / alignment * alignment;
  void* const memory = std::aligned_alloc(alignment, whole);
  if (memory == nullptr) throw std::bad_alloc();
  if (!count(static_cast<std::int64_t>(malloc_usable_size(memory)))) {
    std::free(memory);
    throw std::bad_alloc();
  }
  return memory;
}
inline void release(void* memory) noexcept {
  if (memory == nullptr) return;
  bytes_in_use -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}
}  // namespace allocator

}  // namespace silt::test

void* operator new(std::size_t bytes) {
  return silt::test::allocator::allocate(bytes, __STDCPP_DEFAULT_NEW_ALIGNMENT__);
}
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return silt::test::allocator::allocate(bytes, static_cast<std::size_t>(alignment));
}
// Otherwise that of a sanitizer would be used, with the operator delete below.
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  try {
    return operator new(bytes);
  } catch (...) {
    return nullptr;
  }
}
void operator delete(void* memory) noexcept { silt::test::allocator::release(memory); }
void operator delete(void* memory, std::size_t) noexcept { silt::test::allocator::release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept {
  silt::test::allocator::release(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  silt::test::allocator::release(memory);
}
