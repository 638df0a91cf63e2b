// SPDX-License-Identifier: MIT
// Counts all heap allocations of a program; operator new and Eigen also use malloc. Replaces the
// malloc of the C library or, with a sanitizer, installs a hook. To be included by one source file
// of a program only.
#pragma once

#include "sanitizers.hpp"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace silt::test {

/// Number of calls of malloc, calloc, realloc and aligned_alloc so far.
inline std::atomic<std::uint64_t> allocations{0};

}  // namespace silt::test

#if SILT_HAS_ADDRESS_SANITIZER || SILT_HAS_THREAD_SANITIZER

extern "C" int __sanitizer_install_malloc_and_free_hooks(
    void (*on_malloc)(const volatile void*, std::size_t), void (*on_free)(const volatile void*));

namespace silt::test {
inline const int listens_to_sanitizer = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { ++allocations; }, [](const volatile void*) {});
}  // namespace silt::test

#else

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
#undef SILT_HAS_FEATURE
