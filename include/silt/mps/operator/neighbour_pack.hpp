// SPDX-License-Identifier: MIT
// Four neighbours of a particle at a time, in packs: for sums over all neighbours, which then have
// four partial sums, one for each lane.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_MPS_OPERATOR_NEIGHBOUR_PACK
#define SILT_MPS_OPERATOR_NEIGHBOUR_PACK

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/operator/neighbourhood.hpp>

#include <cstdint>
#include <type_traits>

namespace silt::mps {

/// A vector of each of four neighbours, in a pack for each component.
template <int Dim, class Real>
struct FourVectors {
  Four<Real> components[Dim];

  const Four<Real>& operator[](int k) const { return components[k]; }
  Four<Real>& operator[](int k) { return components[k]; }
};

}  // namespace silt::mps

#define SILT_KERNELS_UP_TO_AVX2
#define SILT_KERNELS <silt/mps/operator/neighbour_pack.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt::mps {

using SILT_ISA_OF_FLAGS::NeighbourPack;
using SILT_ISA_OF_FLAGS::sum_of;

/// Sums that take the values of four neighbours at a time, too: see CorrectedGradient.
template <class F, int Dim, class Real>
concept TakesFour =
    requires(F f, const Four<Real>& numbers, const FourVectors<Dim, Real>& vectors) {
      f(numbers, vectors, numbers, numbers);
    };

}  // namespace silt::mps

#endif
#else

namespace silt::mps::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// Four neighbours, as a Neighbour each. Where a particle has no further neighbour, a lane has the
/// particle itself, with r_ij = 0 and no weight.
template <int Dim, class Real>
struct NeighbourPack {
  const std::uint32_t* index;  ///< of owned or ghost particles
  FourVectors<Dim, Real> r_ij;
  Four<Real> weight;
  Four<Real> weight_over_square;  ///< w/r² [1/m²]

  /// The numbers or vectors of the neighbours, of those of all particles.
  [[gnu::always_inline]] void get(const auto& numbers, Four<Real>& of_these) const {
    of_these = Four<Real>{numbers[index[0]], numbers[index[1]], numbers[index[2]], numbers[index[3]]};
  }
  [[gnu::always_inline]] void get(const auto& vectors, FourVectors<Dim, Real>& of_these) const {
    // In pairs: a processor shuffles registers at half the rate of loads.
    using Two = typename simd::UnalignedPackOf<Real, 2>::type;
    const auto two = [&](int lane) -> Two {
      decltype(auto) v = vectors[index[lane]];
      if constexpr (std::is_reference_v<decltype(v)>) {
        return *reinterpret_cast<const Two*>(v.data());
      } else {
        return Two{v[0], v[1]};
      }
    };
    const Four<Real> even = __builtin_shufflevector(two(0), two(2), 0, 1, 2, 3);
    const Four<Real> odd = __builtin_shufflevector(two(1), two(3), 0, 1, 2, 3);
    of_these[0] = __builtin_shufflevector(even, odd, 0, 4, 2, 6);
    of_these[1] = __builtin_shufflevector(even, odd, 1, 5, 3, 7);
    // With -Og, g++ 12 takes the two halves into which it splits a pack for values that are read.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
    if constexpr (Dim == 3) {
      const auto third = [&](int lane) -> Real { return vectors[index[lane]][2]; };
      of_these[2] = Four<Real>{third(0), third(1), third(2), third(3)};
    }
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic pop
#endif
  }

  /// f(pack) for the neighbours [first, last) of i; `first` is a multiple of four. Inlined, so that
  /// the sums of f stay in registers.
  template <class F>
  [[gnu::always_inline]] static inline void for_each(const Neighbourhood<Dim, Real>& neighbourhood,
                                                     Index i, Index first, Index last, F&& f) {
    const auto row = neighbourhood[i];
    const Vec<Dim, Real> x_i = neighbourhood.position_of(i);
    for (Index k = first; k < last; k += 4) {
      NeighbourPack pack{};
      pack.index = row.index + k;
      pack.get(neighbourhood.positions(), pack.r_ij);
      for (int a = 0; a < Dim; ++a) pack.r_ij[a] -= x_i[a];
      simd::load_floats<Real>(row.weight + k, pack.weight);
      simd::load_floats<Real>(row.weight_over_square + k, pack.weight_over_square);
      f(pack);
    }
  }
  /// The same for all neighbours of i.
  template <class F>
  [[gnu::always_inline]] static inline void for_each(const Neighbourhood<Dim, Real>& neighbourhood,
                                                     Index i, F&& f) {
    for_each(neighbourhood, i, 0, neighbourhood[i].size(), f);
  }
};

/// The sum of the four lanes.
template <class Pack>
auto sum_of(const Pack& lanes) {
  return (lanes[0] + lanes[2]) + (lanes[1] + lanes[3]);
}

template <int Dim, class Real>
Vec<Dim, Real> sum_of(const FourVectors<Dim, Real>& lanes) {
  Vec<Dim, Real> sum;
  for (int a = 0; a < Dim; ++a) sum[a] = sum_of(lanes[a]);
  return sum;
}

}  // namespace silt::mps::SILT_INSTRUCTION_SET

#endif
