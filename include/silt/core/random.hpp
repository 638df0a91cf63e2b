// SPDX-License-Identifier: MIT
// Random numbers without hidden state: each is a pure function of (seed, id, counter), so that
// neither the order in which particles come, nor threads, nor a restart changes any of them.
//
// Philox 4×32-10 of J.K. Salmon, M.A. Moraes, R.O. Dror, D.E. Shaw, "Parallel random numbers: as
// easy as 1, 2, 3", SC'11 (2011): ten rounds of multiplications that scramble a counter.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace silt {

/// The block of four words that belongs to a counter of four words and a key of two.
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

/// A stream of random numbers, one stream to each (seed, id). These three numbers are all there is
/// to it: Random{.seed = 1, .id = 17, .counter = 5} goes on where one that has drawn five numbers
/// is.
struct Random {
  std::uint64_t seed = 0;     ///< of the whole run
  Id id = 0;                  ///< whose numbers they are
  std::uint64_t counter = 0;  ///< numbers drawn so far

  /// Evenly in [0, 1): the same bits on every machine.
  double uniform() { return unit(draw()[0]); }

  /// Evenly in [lower, upper).
  double uniform(const Range& range) {
    return range.lower + uniform() * (range.upper - range.lower);
  }

  /// Normal, of mean 0 and variance 1 (Box and Muller 1958); the same bits wherever log and cos
  /// are.
  double normal() {
    const auto words = draw();
    const double u = 1 - unit(words[0]);  // in (0, 1]
    return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * unit(words[1]));
  }

  /// Evenly in a box with finite sides [m].
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
        philox({low(counter), high(counter), low(id), high(id)}, {low(seed), high(seed)});
    ++counter;
    const auto join = [](std::uint32_t a, std::uint32_t b) { return a | std::uint64_t{b} << 32; };
    return {join(words[0], words[1]), join(words[2], words[3])};
  }
};

}  // namespace silt
