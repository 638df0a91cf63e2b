// SPDX-License-Identifier: MIT
// Included before a program of programs/ by `run --test`: in place of frames, it prints the hash of
// its state at the end, which that of the page must equal.
#pragma once

#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>

#include "../../tests/portability/hash.hpp"

#include <cstdint>
#include <cstdio>

namespace live {

class HashOfFrame {
 public:
  explicit HashOfFrame(const char*) {}
  HashOfFrame(const HashOfFrame&) = delete;
  HashOfFrame& operator=(const HashOfFrame&) = delete;
  ~HashOfFrame() { std::printf("%016llx\n", static_cast<unsigned long long>(hash_)); }

  template <class Sim>
  void operator()(const Sim& simulation) {
    hash_ = silt::portability::hash_of(simulation);
  }

 private:
  std::uint64_t hash_ = 0;
};

struct Silence {
  template <class Sim>
  void operator()(const Sim&) const {}
};

}  // namespace live

#define VtkSeries live::HashOfFrame
#define Progress live::Silence
