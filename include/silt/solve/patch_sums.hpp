// SPDX-License-Identifier: MIT
// The sums of linear interpolation between the corners of patches and the points in them, see
// cell_interpolation.hpp.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_SOLVE_PATCH_SUMS
#define SILT_SOLVE_PATCH_SUMS

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>

namespace silt::detail {

/// Points sorted by patch, with a weight for each corner of their patch.
template <Index corners>
struct PatchPoints {
  const std::uint32_t* first;   ///< of each patch
  const std::uint32_t* member;  ///< number of the point
  const float* weight;          ///< `corners` of them for each
};

/// sum = Σ weight value, over the points of each patch in [first, last).
template <Index corners, class T>
using SumToCorners = void(const PatchPoints<corners>& points, Index first, Index last,
                          const T* values, std::array<float, corners>* sum);

/// z = inverse r + Σ weight x, over the corners, for each point of the patches in [first, last);
/// `cells` are those at the corners. Returns Σ r z over these points.
template <Index corners>
using AddFromCorners = double(const PatchPoints<corners>& points, Index first, Index last,
                              const std::array<std::uint32_t, corners>* cells, const float* x,
                              const double* inverse, const double* r, double* z);

/// The weights of the points in [first, last) of a list of members, by their fractions of the edge
/// from the lowest corner of their patches, all of whose corners are cells.
template <int Dim>
using WeightsOfCorners = void(Index first, Index last, const std::uint32_t* member,
                              const std::array<float, Dim>* fraction, float* weight);

}  // namespace silt::detail

#define SILT_KERNELS <silt/solve/patch_sums.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::detail {

template <Index corners, class T>
SumToCorners<corners, T>* sum_to_corners() {
  return SILT_FOR_PROCESSOR(sum_to_corners<corners, T>);
}
template <Index corners>
AddFromCorners<corners>* add_from_corners() {
  return SILT_FOR_PROCESSOR(add_from_corners<corners>);
}
template <int Dim>
WeightsOfCorners<Dim>* weights_of_corners() {
  return SILT_FOR_PROCESSOR(weights_of_corners<Dim>);
}

}  // namespace silt::detail

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

template <Index corners, class T>
void sum_to_corners(const PatchPoints<corners>& points, Index first, Index last, const T* values,
                    std::array<float, corners>* sum) {
  constexpr int N = std::min(static_cast<int>(corners), simd::lanes<float>);
  constexpr Index packs = corners / N;
  for (Index patch = first; patch < last; ++patch) {
    simd::Pack<float, N> sums[packs]{};
    for (Index k = points.first[patch]; k < points.first[patch + 1]; ++k) {
      const auto value = static_cast<float>(values[points.member[k]]);
      for (Index p = 0; p < packs; ++p) {
        sums[p] += simd::load<float, N>(points.weight + k * corners + p * N) * value;
      }
    }
    for (Index p = 0; p < packs; ++p) {
      simd::store<float, N>(sum[patch].data() + p * N, sums[p]);
    }
  }
}

template <int Dim>
void weights_of_corners(Index first, Index last, const std::uint32_t* member,
                        const std::array<float, Dim>* fraction, float* weight) {
  for (Index k = first; k < last; ++k) {
    const std::array<float, Dim>& next = fraction[member[k]];
    const float x = next[0];
    const float y = next[1];
    const simd::Pack<float, 4> in_plane =
        simd::Pack<float, 4>{1 - x, x, 1 - x, x} * simd::Pack<float, 4>{1 - y, 1 - y, y, y};
    if constexpr (Dim == 2) {
      simd::store<float, 4>(weight + 4 * k, in_plane);
    } else {
      const float z = next[2];
      simd::store<float, 4>(weight + 8 * k, in_plane * (1 - z));
      simd::store<float, 4>(weight + 8 * k + 4, in_plane * z);
    }
  }
}

template <Index corners>
double add_from_corners(const PatchPoints<corners>& points, Index first, Index last,
                        const std::array<std::uint32_t, corners>* cells, const float* x,
                        const double* inverse, const double* r, double* z) {
  constexpr Index fours = corners / 4;
  double product = 0;
  for (Index patch = first; patch < last; ++patch) {
    float at_corners[corners];
    for (Index c = 0; c < corners; ++c) at_corners[c] = x[cells[patch][c]];
    simd::Pack<float, 4> value[fours];
    for (Index f = 0; f < fours; ++f) value[f] = simd::load<float, 4>(at_corners + 4 * f);
    for (Index k = points.first[patch]; k < points.first[patch + 1]; ++k) {
      const float* const weight = points.weight + k * corners;
      simd::Pack<float, 4> sum = simd::load<float, 4>(weight) * value[0];
      for (Index f = 1; f < fours; ++f) sum += simd::load<float, 4>(weight + 4 * f) * value[f];
      const Index i = points.member[k];
      z[i] = inverse[i] * r[i] + double((sum[0] + sum[2]) + (sum[1] + sum[3]));
      product += r[i] * z[i];
    }
  }
  return product;
}

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
