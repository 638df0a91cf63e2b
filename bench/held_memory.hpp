// SPDX-License-Identifier: MIT
// What of the memory of a program is held, by the file of the library that asked for it: one
// concept, one file. Replaces operator new, which is how the library asks for all of its own
// memory. To be included by one source file of a program only, which is compiled with -g.
#pragma once

#include <dlfcn.h>
#include <execinfo.h>
#include <unistd.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <sstream>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace bench {

/// Records blocks of memory from its construction on, until it is destroyed.
class HeldMemory {
 public:
  HeldMemory() { current = this; }
  HeldMemory(const HeldMemory&) = delete;
  HeldMemory& operator=(const HeldMemory&) = delete;
  ~HeldMemory() { current = nullptr; }

  /// {name, bytes} of what was held when the sum was largest, and of the sum itself.
  std::map<std::string, double> at_peak() {
    const Pause pause;
    std::map<std::string, double> held;
    for (Index k = 0; k < callers_.size(); ++k) {
      held[name_of(callers_[k])] += double(at_peak_[k]);
      held["sum"] += double(at_peak_[k]);
    }
    return held;
  }

  static void add(void* block, std::size_t size) noexcept {
    if (current != nullptr && !is_paused) current->add_block(block, size);
  }
  static void remove(void* block) noexcept {
    if (current != nullptr && !is_paused) current->remove_block(block);
  }

 private:
  using Index = std::size_t;
  using Callers = std::vector<void*>;
  struct Block {
    std::size_t size;
    Index callers;
  };
  // Its own memory is not recorded.
  struct Pause {
    Pause() { is_paused = true; }
    ~Pause() { is_paused = false; }
  };

  void add_block(void* block, std::size_t size) noexcept {
    const Pause pause;
    const std::scoped_lock lock(mutex_);
    std::array<void*, 24> addresses;
    // To follow the calls takes long.
    const int count = size < 2048 ? 0 : backtrace(addresses.data(), int(addresses.size()));
    Callers callers(addresses.begin(), addresses.begin() + count);
    const auto [at, is_new] = numbers_.try_emplace(callers, callers_.size());
    if (is_new) {
      callers_.push_back(std::move(callers));
      now_.push_back(0);
      at_peak_.push_back(0);
    }
    blocks_[block] = {size, at->second};
    now_[at->second] += size;
    sum_ += size;
    if (sum_ <= peak_) return;
    peak_ = sum_;
    at_peak_ = now_;
  }
  void remove_block(void* block) noexcept {
    const Pause pause;
    const std::scoped_lock lock(mutex_);
    const auto at = blocks_.find(block);
    if (at == blocks_.end()) return;
    now_[at->second.callers] -= at->second.size;
    sum_ -= at->second.size;
    blocks_.erase(at);
  }

  // The first that a caller is in, from the innermost on.
  static std::string name_of(const Callers& callers) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 17> names{{
        {"histories.hpp", "histories"},
        {"time_levels.hpp", "second copies of columns"},
        {"id_table.hpp", "ids"},
        {"ids.hpp", "ids"},
        {"neighbour_rows.hpp", "rows of the search"},
        {"last_positions.hpp", "positions of the last update"},
        {"sorted_cells.hpp", "cells of the search"},
        {"uniform_grid.hpp", "cells of the search"},
        {"neighbour_list.hpp", "positions when the search was rebuilt"},
        {"list_constants.hpp", "constants when the list was rebuilt"},
        {"PairsOfBlock::", "pairs found for the list"},
        {"contact_list.hpp", "list of contacts"},
        {"list_rebuild.hpp", "positions when the list was rebuilt"},
        {"work_division.hpp", "division of work"},
        {"load_rows.hpp", "loads of contacts"},
        {"particle_table.hpp", "columns"},
        {"mps/", "flow"},
    }};
    if (callers.empty()) return "small blocks";
    std::istringstream lines(lines_of(callers));
    for (std::string line; std::getline(lines, line);) {
      if (line.find("/silt/") == line.npos || line.find("buffer.hpp") != line.npos) continue;
      for (const auto& [part, name] : names) {
        if (line.find(part) != line.npos) return std::string(name);
      }
    }
    return "other";
  }
  // Function and file of each caller, also of those that are inlined.
  static std::string lines_of(const Callers& callers) {
    std::ostringstream command;
    command << "addr2line -ipfC -e /proc/" << getpid() << "/exe" << std::hex;
    for (void* const caller : callers) {
      auto address = reinterpret_cast<std::uintptr_t>(caller) - 1;  // of the call itself
#ifdef __PIE__
      Dl_info info{};
      if (dladdr(caller, &info) == 0) continue;
      address -= reinterpret_cast<std::uintptr_t>(info.dli_fbase);
#endif
      command << " 0x" << address;
    }
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(popen(command.str().c_str(), "r"),
                                                               pclose);
    std::string lines;
    std::array<char, 4096> part;
    while (pipe && std::fgets(part.data(), int(part.size()), pipe.get()) != nullptr) {
      lines += part.data();
    }
    return lines;
  }

  static inline HeldMemory* current = nullptr;
  static inline thread_local bool is_paused = false;

  std::mutex mutex_;
  std::unordered_map<void*, Block> blocks_;
  std::map<Callers, Index> numbers_;
  std::vector<Callers> callers_;  // by number
  std::vector<std::size_t> now_;  // bytes, by number of the callers
  std::vector<std::size_t> at_peak_;
  std::size_t sum_ = 0;
  std::size_t peak_ = 0;
};

}  // namespace bench

// Not inlined: g++ then warns that the delete belongs to another new.
[[gnu::noinline]] void* operator new(std::size_t size) {
  void* const block = std::malloc(size);
  if (block == nullptr) throw std::bad_alloc();
  bench::HeldMemory::add(block, size);
  return block;
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto step = static_cast<std::size_t>(alignment);
  void* const block = std::aligned_alloc(step, (size + step - 1) / step * step);
  if (block == nullptr) throw std::bad_alloc();
  bench::HeldMemory::add(block, size);
  return block;
}
[[gnu::noinline]] void operator delete(void* block) noexcept {
  bench::HeldMemory::remove(block);
  std::free(block);
}
[[gnu::noinline]] void operator delete(void* block, std::size_t) noexcept {
  operator delete(block);
}
[[gnu::noinline]] void operator delete(void* block, std::align_val_t) noexcept {
  operator delete(block);
}
[[gnu::noinline]] void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
  operator delete(block);
}
