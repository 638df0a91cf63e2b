// SPDX-License-Identifier: MIT
// Random numbers without hidden state: each is a function of (seed, id, counter) only, so that it
// depends neither on the order of the particles, nor on the number of threads, nor on a restart.
//
// Philox 4×32-10 of J.K. Salmon, M.A. Moraes, R.O. Dror, D.E. Shaw, "Parallel random numbers: as
// easy as 1, 2, 3", SC'11 (2011).
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace silt {

namespace detail {
/// Four random words from a counter of four words and a key of two.
constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                              std::array<std::uint32_t, 2> key) {
  constexpr int rounds = 10;
  for (int round = 0; round < rounds; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0];
    const std::uint64_t b = std::uint64_t{0xCD9E8D57} * counter[2];
    const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); };
    const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
    counter = {high(b) ^ counter[1] ^ key[0], low(b), high(a) ^ counter[3] ^ key[1], low(a)};
    key[0] += 0x9E3779B9;
    key[1] += 0xBB67AE85;
  }
  return counter;
}
}  // namespace detail

/// A stream of random numbers for each (seed, id). The three members are its whole state:
/// Random{.seed = 1, .id = 17, .counter = 5} continues a stream from which five numbers were drawn.
struct Random {
  std::uint64_t seed = 0;     ///< common to a run
  Id id = 0;                  ///< of the particle or other object
  std::uint64_t counter = 0;  ///< numbers drawn so far

  /// Uniform in [0, 1), a number [-]; the same bits on every machine.
  double uniform() { return unit(draw()[0]); }

  /// Uniform in [lower, upper) [unit of the range].
  double uniform(const Range& range) {
    return range.lower + uniform() * (range.upper - range.lower);
  }

  /// Normal with mean 0 and variance 1 [-] (Box and Muller 1958); the same bits on machines with
  /// the same log and cos.
  double normal() {
    const auto words = draw();
    const double u = 1 - unit(words[0]);  // in (0, 1]
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * unit(words[1]));
  }

  /// Uniform in a bounded box [m].
  template <int Dim, class Real>
  Vec<Dim, Real> point_in(const Box<Dim, Real>& box) {
    Vec<Dim, Real> x;
    for (int k = 0; k < Dim; ++k) {
      x[k] = static_cast<Real>(uniform({double(box.lower[k]), double(box.upper[k])}));
    }
    return x;
  }

 private:
  static double unit(std::uint64_t word) { return double(word >> 11) * 0x1p-53; }

  std::array<std::uint64_t, 2> draw() {
    const auto low = [](std::uint64_t word) { return static_cast<std::uint32_t>(word); };
    const auto high = [](std::uint64_t word) { return static_cast<std::uint32_t>(word >> 32); };
    const auto words =
        detail::philox({low(counter), high(counter), low(id), high(id)}, {low(seed), high(seed)});
    ++counter;
    const auto join = [](std::uint32_t a, std::uint32_t b) { return a | std::uint64_t{b} << 32; };
    return {join(words[0], words[1]), join(words[2], words[3])};
  }
};

}  // namespace silt
