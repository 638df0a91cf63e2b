// SPDX-License-Identifier: MIT
// Memory of arrays. It begins at a cache line, so that no register is loaded across two.
#pragma once

#include <cstddef>
#include <cstdint>
#include <new>

#ifdef __linux__
#include <sys/mman.h>
#include <unistd.h>
#endif

namespace silt::detail {

inline constexpr std::size_t array_alignment = 64;

/// Asks for large pages: a step reads more arrays than the processor keeps addresses of small
/// pages. Many systems give them only on request.
inline void prefer_large_pages([[maybe_unused]] void* memory,
                               [[maybe_unused]] std::size_t size) noexcept {
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  const auto page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
  const auto begin = reinterpret_cast<std::uintptr_t>(memory) / page * page;
  const auto end = (reinterpret_cast<std::uintptr_t>(memory) + size + page - 1) / page * page;
  // Without an effect if there are none.
  static_cast<void>(::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE));
#endif
}

[[gnu::noinline]] inline std::byte* new_array(std::size_t size) {
  constexpr std::size_t large = std::size_t(4) << 20;
  void* const memory = ::operator new(size, std::align_val_t(array_alignment));
  if (size >= large) prefer_large_pages(memory, size);
  return static_cast<std::byte*>(memory);
}
[[gnu::noinline]] inline void delete_array(std::byte* memory) noexcept {
  ::operator delete(memory, std::align_val_t(array_alignment));
}

}  // namespace silt::detail
