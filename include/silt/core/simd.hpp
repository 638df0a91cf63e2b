// SPDX-License-Identifier: MIT
// SIMD operations; the only file with intrinsics.
//
// A Pack is a vector type of GCC and Clang, which compile its arithmetic to SSE, AVX, AVX-512 or
// NEON. These types lack the operation on which the speed of a neighbour search depends, writing
// only the lanes that passed a test:
//
//   values  [ a b c d e f g h ]      mask 1 0 0 1 1 0 1 0      to  [ a d e g . . . . ]
//
// compress() does this: one instruction of AVX-512, a shuffle from a table in AVX2, and a
// branchless loop elsewhere. std::experimental::simd has no compress, and Highway or xsimd would be
// a further dependency for this one function. Measured on lists of 118 neighbours in 3D, a test in
// registers of 16 lanes takes 2.9 ns, of which 1.7 ns is arithmetic. AVX-512 can also compress
// directly to memory, but this took 27 ns on an AMD EPYC; therefore the whole register is stored.
//
// No function here fuses a multiplication and an addition, and none sums over the lanes of a
// register: results are bitwise identical for every register width, provided that the compiler does
// not fuse either (-ffp-contract=off).
//
// SILT_NO_INTRINSICS selects the portable code on every processor, for tests.
//
// Included once for each instruction set, see each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_CORE_SIMD
#define SILT_CORE_SIMD

#include <silt/core/instruction_set.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>

#if SILT_LEVEL_OF_FLAGS > 0
#include <immintrin.h>
#endif

namespace silt::simd {

/// Number of lanes of type T in the widest register of all instruction sets: code that reads or
/// writes whole registers needs so much memory beyond the last value.
template <class T>
inline constexpr int most_lanes = 64 / static_cast<int>(sizeof(T));

/// Coordinates as columns: x[k][s] is coordinate k of point s.
template <int Dim, class Real>
using Columns = std::array<const Real*, Dim>;

/// For each mask, the source lane of each destination lane, one byte each.
inline constexpr std::array<std::uint64_t, 256> compressing_shuffles = [] {
  std::array<std::uint64_t, 256> table{};
  for (unsigned mask = 0; mask < 256; ++mask) {
    unsigned to = 0;
    for (unsigned lane = 0; lane < 8; ++lane) {
      if (mask >> lane & 1u) table[mask] |= std::uint64_t{lane} << (8 * to++);
    }
  }
  return table;
}();

}  // namespace silt::simd

#define SILT_KERNELS <silt/core/simd.hpp>
#include <silt/core/each_instruction_set.hpp>

namespace silt {
namespace simd {
using namespace SILT_ISA_OF_FLAGS;
}
/// Four numbers.
template <class Real>
using Four = typename simd::PackOf<Real, 4>::type;
}  // namespace silt
#endif
#else

namespace silt::simd::SILT_INSTRUCTION_SET {

/// Of a register [bytes].
inline constexpr int width = SILT_LEVEL == 3 ? 64 : SILT_LEVEL == 2 ? 32 : 16;

/// Number of lanes of type T in a register.
template <class T>
inline constexpr int lanes = width / static_cast<int>(sizeof(T));

/// The vector type of the compiler with N numbers of type T.
template <class T, int N>
struct PackOf {
  typedef T type __attribute__((vector_size(N * sizeof(T))));
};
/// N numbers of type T, with elementwise operators.
template <class T, int N = lanes<T>>
using Pack = typename PackOf<T, N>::type;

/// One bit per lane.
using Mask = std::uint32_t;

// A pack at any address of a T. (g++ expands std::memcpy of a pack in pieces of 16 bytes unless it
// is tuned for a certain processor, and a load of the whole after such stores has to wait.)
/// The same for access to memory of any alignment.
template <class T, int N>
struct UnalignedPackOf {
  typedef T type __attribute__((vector_size(N * sizeof(T)), aligned(alignof(T)), may_alias));
};

/// Reads N numbers, which need not be aligned.
template <class T, int N = lanes<T>>
Pack<T, N> load(const T* from) {
  return *reinterpret_cast<const typename UnalignedPackOf<T, N>::type*>(from);
}
/// Writes N numbers to memory of any alignment.
template <class T, int N = lanes<T>>
void store(T* to, const Pack<T, N>& pack) {
  *reinterpret_cast<typename UnalignedPackOf<T, N>::type*>(to) = pack;
}
/// {from[0], from[1], from[2], 0}; the number after the three is not read.
template <class T>
void load_three(const T* from, Pack<T, 4>& to) {
#if SILT_LEVEL == 3
  if constexpr (std::is_same_v<T, double>) {
    to = (Pack<T, 4>)_mm256_maskz_loadu_pd(7, from);
  } else {
    to = (Pack<T, 4>)_mm_maskz_loadu_ps(7, from);
  }
#elif SILT_LEVEL == 2
  if constexpr (std::is_same_v<T, double>) {
    to = (Pack<T, 4>)_mm256_maskload_pd(from, _mm256_setr_epi64x(-1, -1, -1, 0));
  } else {
    to = (Pack<T, 4>)_mm_maskload_ps(from, _mm_setr_epi32(-1, -1, -1, 0));
  }
#else
  to = Pack<T, 4>{from[0], from[1], from[2], 0};
#endif
}

/// Reads as many numbers as there are in a pack; by reference, because how a pack is returned
/// depends on the processor flags.
template <class T, class P>
void load_pack(const T* from, P& to) {
  to = *reinterpret_cast<const typename UnalignedPackOf<T, sizeof(P) / sizeof(T)>::type*>(from);
}

/// The value in all lanes.
template <class T, int N = lanes<T>>
Pack<T, N> broadcast(T value) {
  return value - Pack<T, N>{};
}

/// |a|, lane by lane.
template <class T, int N = lanes<T>>
Pack<T, N> abs(const Pack<T, N>& a) {
  using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
  return (Pack<T, N>)((Pack<Bits, N>)a & ~(Bits{1} << (8 * sizeof(T) - 1)));
}

/// √a in each lane.
template <class T, int N = lanes<T>>
Pack<T, N> square_root(const Pack<T, N>& a) {
#if SILT_LEVEL >= 2
  if constexpr (std::is_same_v<T, float> && N == 8) {
    return (Pack<T, N>)_mm256_sqrt_ps((__m256)a);
  } else if constexpr (std::is_same_v<T, double> && N == 4) {
    return (Pack<T, N>)_mm256_sqrt_pd((__m256d)a);
  } else
#endif
#if SILT_LEVEL == 3
      if constexpr (std::is_same_v<T, double> && N == 8) {
    return (Pack<T, N>)_mm512_maskz_sqrt_pd(0xff, (__m512d)a);
  } else
#endif
#if SILT_LEVEL == 1
      if constexpr (std::is_same_v<T, double> && N == 2) {
    return (Pack<T, N>)_mm_sqrt_pd((__m128d)a);
  } else
#endif
  {
    T root[N];
    for (int k = 0; k < N; ++k) root[k] = std::sqrt(a[k]);
    return load<T, N>(root);
  }
}

/// from, from + 1, …
template <int N>
Pack<std::uint32_t, N> count_from(Index from) {
  std::uint32_t count[N];
  for (int k = 0; k < N; ++k)
    count[k] = static_cast<std::uint32_t>(from) + static_cast<std::uint32_t>(k);
  return load<std::uint32_t, N>(count);
}

/// Four numbers in single precision, as those of another type. (g++ 12 splits the built-in conversion
/// into two halves.)
template <class T>
void load_floats(const float* from, Pack<T, 4>& to) {
#if SILT_LEVEL >= 2
  if constexpr (std::is_same_v<T, double>) {
    to = (Pack<T, 4>)_mm256_cvtps_pd(_mm_loadu_ps(from));
  } else
#endif
  {
    to = Pack<T, 4>{T(from[0]), T(from[1]), T(from[2]), T(from[3])};
  }
}

/// sum += a x in four lanes. (g++ 12 splits the built-in conversion into two halves.)
inline void add_products(const float* a, const double* x, Pack<double, 4>& sum) {
#if SILT_LEVEL >= 2
  sum += (Pack<double, 4>)_mm256_cvtps_pd(_mm_loadu_ps(a)) * (Pack<double, 4>)_mm256_loadu_pd(x);
#else
  for (int k = 0; k < 4; ++k) sum[k] += double(a[k]) * x[k];
#endif
}

/// Mask of the first `count` lanes.
template <int N>
Mask first_lanes(Index count) {
  return static_cast<Mask>((std::uint64_t{1} << std::min<Index>(count, N)) - 1);
}

/// Mask of the lanes in which a < b.
template <class T, int N = lanes<T>>
Mask less(const Pack<T, N>& a, const Pack<T, N>& b) {
#if SILT_LEVEL == 3
  if constexpr (std::is_same_v<T, float> && N == 16) {
    return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
  } else if constexpr (std::is_same_v<T, float> && N == 8) {
    return _mm256_cmp_ps_mask((__m256)a, (__m256)b, _CMP_LT_OQ);
  } else if constexpr (std::is_same_v<T, double> && N == 8) {
    return _mm512_cmp_pd_mask((__m512d)a, (__m512d)b, _CMP_LT_OQ);
  } else
#elif SILT_LEVEL == 2
  if constexpr (std::is_same_v<T, float> && N == 8) {
    return static_cast<Mask>(_mm256_movemask_ps((__m256)(a < b)));
  } else if constexpr (std::is_same_v<T, float> && N == 4) {
    return static_cast<Mask>(_mm_movemask_ps((__m128)(a < b)));
  } else if constexpr (std::is_same_v<T, double> && N == 4) {
    return static_cast<Mask>(_mm256_movemask_pd((__m256d)(a < b)));
  } else
#elif SILT_LEVEL == 1
  if constexpr (std::is_same_v<T, double> && N == 2) {
    return static_cast<Mask>(_mm_movemask_pd((__m128d)(a < b)));
  } else
#endif
  {
    Mask mask = 0;
    for (int k = 0; k < N; ++k) mask |= static_cast<Mask>(a[k] < b[k]) << k;
    return mask;
  }
}

/// a in the lanes of the mask, b in the others.
template <class T, int N = lanes<T>>
Pack<T, N> select(Mask mask, const Pack<T, N>& a, const Pack<T, N>& b) {
#if SILT_LEVEL == 3
  if constexpr (std::is_same_v<T, double> && N == 8) {
    return (Pack<T, N>)_mm512_mask_blend_pd(static_cast<__mmask8>(mask), (__m512d)b, (__m512d)a);
  } else
#endif
  {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    Bits of_lane[N];
    for (int k = 0; k < N; ++k) of_lane[k] = Bits{1} << k;
    const auto bits = load<Bits, N>(of_lane);
    const auto chosen = (Pack<Bits, N>)((broadcast<Bits, N>(mask) & bits) == bits);
    return (Pack<T, N>)((chosen & (Pack<Bits, N>)a) | (~chosen & (Pack<Bits, N>)b));
  }
}

/// Mask of the lanes in which a ≠ b.
template <int N>
Mask differs(const Pack<std::uint32_t, N>& a, std::uint32_t b) {
#if SILT_LEVEL == 3
  if constexpr (N == 16) {
    return _mm512_cmpneq_epi32_mask((__m512i)a, _mm512_set1_epi32(static_cast<int>(b)));
  } else if constexpr (N == 8) {
    return _mm256_cmpneq_epi32_mask((__m256i)a, _mm256_set1_epi32(static_cast<int>(b)));
  } else
#elif SILT_LEVEL == 2
  if constexpr (N == 8) {
    return 0xff & ~static_cast<Mask>(_mm256_movemask_ps((__m256)(a == b)));
  } else if constexpr (N == 4) {
    return 0xf & ~static_cast<Mask>(_mm_movemask_ps((__m128)(a == b)));
  } else
#endif
  {
    Mask mask = 0;
    for (int k = 0; k < N; ++k) mask |= static_cast<Mask>(a[k] != b) << k;
    return mask;
  }
}

/// Writes the lanes of the mask to `to`, in order, and returns their number. The remaining elements
/// of `to`, up to N in total, are overwritten.
template <class T, int N = lanes<T>>
Index compress(T* to, const Pack<T, N>& values, Mask mask) {
  static_assert(sizeof(T) == 4);
#if SILT_LEVEL == 3
  if constexpr (N == 16) {
    const __m512i chosen =
        _mm512_maskz_compress_epi32(static_cast<__mmask16>(mask), (__m512i)values);
    _mm512_storeu_si512(to, chosen);
  } else if constexpr (N == 8) {
    const __m256i chosen =
        _mm256_maskz_compress_epi32(static_cast<__mmask8>(mask), (__m256i)values);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), chosen);
  } else
#elif SILT_LEVEL == 2
  if constexpr (N == 8 || N == 4) {
    const __m128i bytes = _mm_cvtsi64_si128(static_cast<long long>(compressing_shuffles[mask]));
    const __m256i shuffle = _mm256_cvtepu8_epi32(bytes);
    if constexpr (N == 8) {
      const __m256i chosen = _mm256_permutevar8x32_epi32((__m256i)values, shuffle);
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), chosen);
    } else {
      const __m256i wide = _mm256_castsi128_si256((__m128i)values);
      const __m128i chosen = _mm256_castsi256_si128(_mm256_permutevar8x32_epi32(wide, shuffle));
      _mm_storeu_si128(reinterpret_cast<__m128i*>(to), chosen);
    }
  } else
#endif
  {
    Index count = 0;
    for (int k = 0; k < N; ++k) {
      to[count] = values[k];
      count += mask >> k & 1u;
    }
    return count;
  }
  return static_cast<Index>(std::popcount(mask));
}

/// The same for N values in memory.
template <class T, int N = lanes<T>>
Index compress(T* to, const T* values, Mask mask) {
  if constexpr (N * sizeof(T) <= width) {
    return compress<T, N>(to, load<T, N>(values), mask);
  } else {
    Index count = 0;
    for (int k = 0; k < N; ++k) {
      to[count] = values[k];
      count += mask >> k & 1u;
    }
    return count;
  }
}

/// Writes the items of all points s in [first, last) that lie within √reach of the centre to `to`,
/// in order, except the item `own`, and returns the end of what was written. item(s) returns the
/// items of N points from s on. Reads the columns and overwrites `to` up to one register beyond the
/// end.
template <int N, std::size_t Dim, class Real, class Item>
std::uint32_t* compress_near(const std::array<const Real*, Dim>& x, Index first, Index last,
                             const std::array<Real, Dim>& centre, Real reach, Item&& item,
                             std::uint32_t own, std::uint32_t* to) {
  // Copies, because the compiler must assume that stores to `to` change what references refer to.
  const std::array<const Real*, Dim> from = x;
  struct {
    Pack<Real, N> x;
  } middle[Dim];
  for (std::size_t k = 0; k < Dim; ++k) middle[k].x = broadcast<Real, N>(centre[k]);
  const auto limit = broadcast<Real, N>(reach);
  for (Index s = first; s < last; s += N) {
    const Pack<Real, N> d0 = load<Real, N>(from[0] + s) - middle[0].x;
    Pack<Real, N> r2 = d0 * d0;
    for (std::size_t k = 1; k < Dim; ++k) {
      const Pack<Real, N> d = load<Real, N>(from[k] + s) - middle[k].x;
      r2 += d * d;
    }
    const Pack<std::uint32_t, N> items = item(s);
    const Mask near = less<Real, N>(r2, limit) & first_lanes<N>(last - s);
    to += compress<std::uint32_t, N>(to, items, near & differs<N>(items, own));
  }
  return to;
}

}  // namespace silt::simd::SILT_INSTRUCTION_SET

#endif
