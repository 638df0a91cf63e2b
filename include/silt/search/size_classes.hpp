// SPDX-License-Identifier: MIT
// Divides particles of many sizes into levels, each with its own cell size. A single grid has cells
// for the largest particles, each of which contains many small ones. With levels, a particle
// searches its own level and the coarser ones, whose cells are no larger than necessary.
//
// The cost of a division is the number of distance tests, from the histogram of the sizes. A level
// of N particles with cells of edge E has (3E)^Dim N / V particles around any point, where V is the
// volume of all particles:
//
//   N (½ (3E)^Dim N/V + c)      within the level, each pair once
//   n ((3E)^Dim N/V + c)        by the n particles of finer levels
//
// where c is the cost of finding the cells. Levels are contiguous ranges of the histogram, so that
// the optimum is found by dynamic programming. Radii of one level have a ratio of 16 at most: more
// would pay only if the small particles were not close together, which the histogram does not tell.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace silt {

/// Number of a size class; there are two for each power of 2.
using SizeClass = std::uint32_t;
inline constexpr SizeClass size_classes = 4096;  ///< number of bins of the histogram of sizes

/// Class of a radius [m]; the lowest if it is not positive.
inline SizeClass size_class_of(double size) {
  if (!(size > 0)) return 0;
  return static_cast<SizeClass>(std::bit_cast<std::uint64_t>(size) >> 51);
}
/// Upper bound of the radii of a class [m].
inline double largest_of(SizeClass size) {
  return std::bit_cast<double>((std::uint64_t{size} + 1) << 51);
}

/// The highest size class of each level, finest level first: the optimum for so many particles of
/// each class, if pairs up to a gap of `gap` [m] are found. No level is empty.
inline Buffer<SizeClass> choose_levels(const Buffer<Index>& histogram, double gap, int dimension) {
  // Cost of finding the cells and of starting a loop in each row, in distance tests.
  constexpr double cell_cost = 30;
  constexpr SizeClass max_span = 8;
  Buffer<SizeClass> sizes;
  Buffer<double> cumulative{0};  // cumulative number of particles
  double volume = 0;
  for (SizeClass size = 0; size < histogram.size(); ++size) {
    if (histogram[size] == 0) continue;
    sizes.push_back(size);
    const auto count = double(histogram[size]);
    cumulative.push_back(cumulative.back() + count);
    volume += count * std::pow(2 * largest_of(size), dimension);
  }
  const auto cost_of_level = [&](std::size_t from, std::size_t to) {
    const double own = cumulative[to] - cumulative[from];
    const double finer = cumulative[from];
    const double edge = 2 * largest_of(sizes[to - 1]) + gap;
    const double tests = std::pow(3 * edge, dimension) * own / volume;
    return own * (tests / 2 + cell_cost) + finer * (tests + cell_cost);
  };
  Buffer<double> cost(sizes.size() + 1, std::numeric_limits<double>::infinity());
  Buffer<std::size_t> begin(sizes.size() + 1, 0);
  cost[0] = 0;
  for (std::size_t to = 1; to <= sizes.size(); ++to) {
    for (std::size_t from = 0; from < to; ++from) {
      if (sizes[to - 1] - sizes[from] >= max_span) continue;
      const double total = cost[from] + cost_of_level(from, to);
      if (total < cost[to]) {
        cost[to] = total;
        begin[to] = from;
      }
    }
  }
  Buffer<SizeClass> highest;
  for (std::size_t to = sizes.size(); to > 0; to = begin[to]) highest.push_back(sizes[to - 1]);
  std::reverse(highest.begin(), highest.end());
  return highest;
}

}  // namespace silt
