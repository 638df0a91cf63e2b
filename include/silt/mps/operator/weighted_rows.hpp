// SPDX-License-Identifier: MIT
// Neighbours of particles with their weights, one row after another in memory.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>

namespace silt::mps {

/// r² of particles with the same position to the round-off of weights in single precision [m²].
template <class T>
auto least_square(const T& stencil) {
  using Real = typename T::Real;
  return squared(Real(std::numeric_limits<float>::epsilon()) * stencil.re);
}

/// The neighbours of one particle, in three arrays.
struct WeightedRow {
  const std::uint32_t* index;  ///< of an owned or ghost particle
  const float* weight;
  const float* weight_over_square;  ///< w/r² [1/m²]
  Index length;                     ///< number of neighbours

  Index size() const noexcept { return length; }
};

/// Rows that one thread fills, with spare capacity. Weights w, and w/r² for gradient and divergence,
/// are stored in single precision, which halves the memory traffic.
template <class Real>
class WeightedRows {
 public:
  /// Where a row is.
  struct Place {
    std::uint32_t first = 0;   ///< of its neighbours, among those of all rows
    std::uint32_t length = 0;  ///< number of them
  };
  /// A row that was added.
  struct Added {
    Place row;
    Real density;      ///< Σ w, not rounded to single precision [-]
    bool is_distinct;  ///< false if a neighbour has the same position as the particle
  };

  /// From now on, there is none.
  void clear() noexcept { used_ = 0; }
  WeightedRow operator[](const Place& row) const noexcept {
    return {index_.data() + row.first, weight_.data() + row.first,
            weight_over_square_.data() + row.first, row.length};
  }

  /// Adds that of particle i, of those particles js that are within the stencil and visible, see
  /// Neighbourhood::find().
  template <int Dim, class T, class Visible>
  Added add(Index i, std::span<const std::uint32_t> js, const Buffer<Vec<Dim, Real>>& positions,
            T stencil, const Visible& visible) {
    reserve(js.size());
    std::uint32_t* const index = index_.data() + used_;
    float* const weight = weight_.data() + used_;
    float* const weight_over_square = weight_over_square_.data() + used_;
    Real* const square = square_.data();
    Real* const exact = exact_.data();
    Real* const share = share_.data();

    const Vec<Dim, Real> x_i = positions[i];
    const Real re2 = stencil.re * stencil.re;
    const Real min_square = least_square(stencil);
    Index length = 0;
    bool distinct = true;
    for (const std::uint32_t j : js) {
      const Real r2 = (positions[j] - x_i).squaredNorm();
      index[length] = j;
      square[length] = r2;
      length += r2 < re2;
      distinct &= r2 > min_square;
    }

    const bool sees_all = visible.sees_all(i);
    if (!sees_all) {
      Index seen = 0;
      for (Index k = 0; k < length; ++k) {
        const Real of_k = Real(visible.visible_share(i, Index(index[k])));
        share[seen] = of_k;
        index[seen] = index[k];
        square[seen] = square[k];
        seen += of_k > 0;
      }
      length = seen;
    }
    const Index padded = (length + sum_lanes - 1) / sum_lanes * sum_lanes;
    std::fill(square + length, square + padded, re2);
    for (Index k = 0; k < padded; ++k) {
      const Real w = stencil.weight(std::sqrt(square[k]));
      exact[k] = w;
      weight[k] = static_cast<float>(w);
      weight_over_square[k] = static_cast<float>(w / square[k]);
    }
    if (!sees_all) {
      for (Index k = 0; k < length; ++k) {
        exact[k] *= share[k];
        weight[k] = static_cast<float>(exact[k]);
        weight_over_square[k] = static_cast<float>(exact[k] / square[k]);
      }
    }
    std::fill(index + length, index + padded, static_cast<std::uint32_t>(i));
    std::fill(weight + length, weight + padded, 0.0f);
    std::fill(weight_over_square + length, weight_over_square + padded, 0.0f);
    std::fill(exact + length, exact + padded, Real(0));
    std::array<Real, sum_lanes> sum{};
    for (Index k = 0; k < padded; k += sum_lanes) {
      for (Index lane = 0; lane < sum_lanes; ++lane) sum[lane] += exact[k + lane];
    }
    const Added added{.row = {.first = static_cast<std::uint32_t>(used_),
                              .length = static_cast<std::uint32_t>(length)},
                      .density = std::accumulate(sum.begin(), sum.end(), Real(0)),
                      .is_distinct = distinct};
    used_ += (length + lanes_of_sums - 1) / lanes_of_sums * lanes_of_sums;
    return added;
  }

 private:
  // Rows are completed by the particle itself, without weight, to a multiple of so many neighbours:
  // see NeighbourPack.
  static constexpr Index lanes_of_sums = 4;
  // Of the sum of a row, on every processor: the same bits.
  static constexpr Index sum_lanes = 8;
  // Memory beyond the end of a row, for sums and packs.
  static constexpr Index padding = std::max<Index>(sum_lanes, simd::lanes<float>);

  // Reserves memory for a row of this length and its padding.
  void reserve(Index length) {
    // The arrays compared are the last to grow: they all have, unless an allocation has failed.
    if (length + padding > exact_.size() || used_ + length + padding > weight_over_square_.size()) {
      grow(length);
    }
  }
  [[gnu::noinline]] void grow(Index length) {
    if (length + padding > exact_.size()) {
      square_.resize(2 * length + padding);
      share_.resize(2 * length + padding);
      exact_.resize(2 * length + padding);
    }
    const Index min_size = used_ + length + padding;
    if (min_size <= weight_over_square_.size()) return;
    const auto resize = [size = min_size * 9 / 8](auto& values) {
      values.reserve(size);  // resize() alone would double the capacity
      values.resize(size);
    };
    resize(index_);
    resize(weight_);
    resize(weight_over_square_);
  }

  Buffer<std::uint32_t> index_;
  Buffer<float> weight_;
  Buffer<float> weight_over_square_;
  Index used_ = 0;
  Buffer<Real> square_;  // r² of the row being added
  Buffer<Real> share_;   // of its neighbours that is visible
  Buffer<Real> exact_;   // its weights before rounding to single precision
};

}  // namespace silt::mps
