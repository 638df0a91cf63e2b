// SPDX-License-Identifier: MIT
// Counts what a whole program asks of the heap, by standing in front of the C library's malloc:
// operator new and Eigen come through it, too. One source file of a program may include this.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#ifdef __has_feature
#define SILT_HAS_FEATURE(feature) __has_feature(feature)
#else
#define SILT_HAS_FEATURE(feature) 0
#endif
// Sanitizers stand there already.
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !SILT_HAS_FEATURE(address_sanitizer)
#define SILT_COUNTS_ALLOCATIONS 1
#else
#define SILT_COUNTS_ALLOCATIONS 0
#endif
#undef SILT_HAS_FEATURE

namespace silt::test {

inline constexpr bool counts_allocations = SILT_COUNTS_ALLOCATIONS;

/// Calls of malloc and its kin so far.
inline std::atomic<std::uint64_t> allocations{0};

}  // namespace silt::test

#if SILT_COUNTS_ALLOCATIONS
extern "C" {
void* __libc_malloc(std::size_t bytes);
void* __libc_calloc(std::size_t number, std::size_t bytes);
void* __libc_realloc(void* memory, std::size_t bytes);
void* __libc_memalign(std::size_t alignment, std::size_t bytes);

void* malloc(std::size_t bytes) noexcept {
  ++silt::test::allocations;
  return __libc_malloc(bytes);
}
void* calloc(std::size_t number, std::size_t bytes) noexcept {
  ++silt::test::allocations;
  return __libc_calloc(number, bytes);
}
void* realloc(void* memory, std::size_t bytes) noexcept {
  ++silt::test::allocations;
  return __libc_realloc(memory, bytes);
}
void* aligned_alloc(std::size_t alignment, std::size_t bytes) noexcept {
  ++silt::test::allocations;
  return __libc_memalign(alignment, bytes);
}
}
#endif
