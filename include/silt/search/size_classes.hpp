// SPDX-License-Identifier: MIT
// How to part particles of many sizes into levels, each with cells of its own size. One grid for
// all has cells for the largest, into which a crowd of the small ones falls; with levels, a
// particle looks among its own level, and up to the coarser ones, whose cells are as large as they
// need be.
//
// What a choice costs is counted in distance tests, from the histogram of the sizes. A level of N
// particles with cells of edge E has (3E)^Dim N / V of them around any point, V being the
// particles' own volume:
//
//   N (½ (3E)^Dim N/V + c)      among themselves, each pair once
//   n ((3E)^Dim N/V + c)        looked up to by the n particles of finer levels
//
// where c is what it takes to find the cells. Levels are runs of the histogram, so that the best
// choice of all comes from dynamic programming.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace silt {

/// A class of sizes: two to each power of 2.
using SizeClass = std::uint32_t;
inline constexpr SizeClass size_classes = 4096;

/// The class of a radius; of what is not positive, the lowest.
inline SizeClass size_class_of(double size) {
  if (!(size > 0)) return 0;
  return static_cast<SizeClass>(std::bit_cast<std::uint64_t>(size) >> 51);
}
/// No radius of the class is larger.
inline double largest_of(SizeClass size) {
  return std::bit_cast<double>((std::uint64_t{size} + 1) << 51);
}

/// The highest size class of each level, the finest first: the best choice for this many particles
/// of each class, seen as far as `gap` [m] beyond touching. No level is empty.
inline std::vector<SizeClass> choose_levels(const std::vector<Index>& histogram, double gap,
                                            int dimension) {
  // In tests: finding the cells and beginning anew in each of their rows.
  constexpr double to_find_the_cells = 30;
  std::vector<SizeClass> sizes;
  std::vector<double> up_to{0};  // particles of the sizes before
  double volume = 0;
  for (SizeClass size = 0; size < histogram.size(); ++size) {
    if (histogram[size] == 0) continue;
    sizes.push_back(size);
    const auto count = double(histogram[size]);
    up_to.push_back(up_to.back() + count);
    volume += count * std::pow(2 * largest_of(size), dimension);
  }
  const auto cost_of_level = [&](std::size_t from, std::size_t to) {
    const double own = up_to[to] - up_to[from];
    const double finer = up_to[from];
    const double edge = 2 * largest_of(sizes[to - 1]) + gap;
    const double met = std::pow(3 * edge, dimension) * own / volume;
    return own * (met / 2 + to_find_the_cells) + finer * (met + to_find_the_cells);
  };
  std::vector<double> cost(sizes.size() + 1, std::numeric_limits<double>::infinity());
  std::vector<std::size_t> begin(sizes.size() + 1, 0);
  cost[0] = 0;
  for (std::size_t to = 1; to <= sizes.size(); ++to) {
    for (std::size_t from = 0; from < to; ++from) {
      const double total = cost[from] + cost_of_level(from, to);
      if (total < cost[to]) {
        cost[to] = total;
        begin[to] = from;
      }
    }
  }
  std::vector<SizeClass> highest;
  for (std::size_t to = sizes.size(); to > 0; to = begin[to]) highest.push_back(sizes[to - 1]);
  std::reverse(highest.begin(), highest.end());
  return highest;
}

}  // namespace silt
