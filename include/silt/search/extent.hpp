// SPDX-License-Identifier: MIT
// Bounding box of points.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/search/points.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace silt {

/// Corners of the smallest box around some points.
template <int Dim, class Real>
struct Extent {
  Vec<Dim, Real> lower = Vec<Dim, Real>::Zero();   ///< [m]
  Vec<Dim, Real> upper = Vec<Dim, Real>::Zero();   ///< [m]
  Vec<Dim, Real> middle = Vec<Dim, Real>::Zero();  ///< a typical point [m]

  /// Whether all coordinates are finite.
  bool is_finite() const { return silt::is_finite(lower) && silt::is_finite(upper); }
};

namespace detail {

// Maps the bits of a number to an integer such that integers compare as the numbers do, with NaN
// beyond the infinities. Its own inverse. Unlike those of Reals, minima and maxima of integers are
// vectorised, and none loses a NaN.
template <class Bits>
constexpr Bits ordered(Bits bits) {
  using Unsigned = std::make_unsigned_t<Bits>;
  const auto sign = static_cast<Unsigned>(bits >> (8 * sizeof(Bits) - 1));
  return bits ^ static_cast<Bits>(sign >> 1);
}

}  // namespace detail

/// Extent of points. It is not finite if one of them is not.
template <int dimension, class Real>
Extent<dimension, Real> extent_of(const Points<dimension, Real>& x) {
  using Bits = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  constexpr auto Dim = static_cast<std::size_t>(dimension);
  Extent<dimension, Real> extent;
  if (x.empty()) return extent;

  struct Corners {
    std::array<Bits, Dim> lower;
    std::array<Bits, Dim> upper;
  };
  Corners all;
  all.lower.fill(std::numeric_limits<Bits>::max());
  all.upper.fill(std::numeric_limits<Bits>::min());
  PerChunk<Corners> corners(x.size(), all);
  for_each_chunk(x.size(), [&x, &corners](Chunk chunk) {
    Corners own = corners[chunk.number];
    for (Index i = chunk.first; i < chunk.last; ++i) {
      const auto x_i = x[i];
      for (std::size_t k = 0; k < Dim; ++k) {
        const Bits bits = detail::ordered(std::bit_cast<Bits>(Real(x_i[static_cast<int>(k)])));
        own.lower[k] = std::min(own.lower[k], bits);
        own.upper[k] = std::max(own.upper[k], bits);
      }
    }
    corners[chunk.number] = own;
  });
  for (std::size_t k = 0; k < Dim; ++k) {
    for (const Corners& own : corners) {
      all.lower[k] = std::min(all.lower[k], own.lower[k]);
      all.upper[k] = std::max(all.upper[k], own.upper[k]);
    }
    extent.lower[static_cast<int>(k)] = std::bit_cast<Real>(detail::ordered(all.lower[k]));
    extent.upper[static_cast<int>(k)] = std::bit_cast<Real>(detail::ordered(all.upper[k]));
  }
  extent.middle = x[x.size() / 2];
  return extent;
}
/// The same of a column of positions, or of the like.
template <class Positions>
auto extent_of_points(const Positions& x) {
  using Vec = std::remove_cvref_t<decltype(x[0])>;
  return extent_of(Points<Vec::RowsAtCompileTime, typename Vec::Scalar>(x));
}

}  // namespace silt
