// SPDX-License-Identifier: MIT
// Random changes of inputs, for compilers without libFuzzer. The n-th input is a function of the
// corpus and n alone, so that any of them can be repeated.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/setup/random.hpp>

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace silt::fuzz {

class Mutations {
 public:
  /// The corpus has at least one input.
  explicit Mutations(std::vector<std::string> corpus) : corpus_(std::move(corpus)) {}

  std::string input(std::uint64_t number) const {
    Random random{.seed = 1, .id = number};
    std::string bytes = corpus_[below(random, corpus_.size())];
    // Rarely many changes: most of an input must stay valid to be understood.
    for (Index left = Index(1) << below(random, 5); left > 0; --left) change(random, bytes);
    bytes.resize(std::min(bytes.size(), max_size));
    return bytes;
  }

 private:
  static constexpr Index max_size = 4096;  // the default of libFuzzer

  // 0 … n-1, and 0 if n is 0.
  static Index below(Random& random, Index n) {
    return static_cast<Index>(random.uniform() * double(n));
  }
  static char any(Random& random) { return static_cast<char>(below(random, 256)); }

  struct Part {
    Index from;
    Index size;
  };
  // A part of so many bytes; mostly a short one.
  static Part part_of(Random& random, Index size) {
    const Index from = below(random, size);
    const Index longest = std::min(size - from, Index(1) << below(random, 9));
    return {from, below(random, longest + 1)};
  }

  void change(Random& random, std::string& bytes) const {
    const auto [from, size] = part_of(random, bytes.size());
    switch (below(random, 9)) {
      case 0:
        if (!bytes.empty()) bytes[from] = static_cast<char>(bytes[from] ^ 1 << below(random, 8));
        break;
      case 1:
        if (!bytes.empty()) bytes[from] = any(random);
        break;
      case 2:
        if (!bytes.empty())
          bytes[from] = static_cast<char>(bytes[from] + (random.uniform() < 0.5 ? 1 : -1));
        break;
      case 3:
        bytes.insert(from, 1 + below(random, 8), any(random));
        break;
      case 4:
        bytes.erase(from, size);
        break;
      case 5:
        bytes.insert(below(random, bytes.size() + 1), bytes.substr(from, size));
        break;
      case 6: {  // the extremes of integers, and of floating-point numbers
        constexpr char extremes[] = {0, 1, '\x7f', '\x80', '\xff', '\xf0'};
        for (Index k = from; k < std::min(bytes.size(), from + 8); ++k) {
          bytes[k] = extremes[below(random, std::size(extremes))];
        }
        break;
      }
      default: {
        const std::string& other = corpus_[below(random, corpus_.size())];
        const auto theirs = part_of(random, other.size());
        const bool replaces = random.uniform() < 0.5;
        bytes.replace(from, replaces ? theirs.size : 0, other, theirs.from, theirs.size);
      }
    }
  }

  std::vector<std::string> corpus_;
};

}  // namespace silt::fuzz
