// SPDX-License-Identifier: MIT
// Packs of four numbers, in the vector types of g++ and clang, for every processor.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <cstring>

namespace silt {

template <class Real>
using Four = simd::Pack<Real, 4>;

// Packs are passed by reference, because how they are returned depends on the processor flags.

template <class Real, class F>
void load_four(const Real* from, F& four) {
  four = *reinterpret_cast<const typename simd::UnalignedPackOf<Real, 4>::type*>(from);
}

/// b × a of the first three numbers, rotated by one lane, as (z, x, y); the fourth is unspecified.
template <class F>
void cross_turned(const F& a, const F& b, F& c) {
  c = __builtin_shufflevector(a, a, 1, 2, 0, 3) * b - a * __builtin_shufflevector(b, b, 1, 2, 0, 3);
}
template <class F>
void turn_back(F& c) {
  c = __builtin_shufflevector(c, c, 1, 2, 0, 3);
}

/// Transposes four rows into four columns: lane l of a column comes from row l.
template <class Real>
void transpose(Four<Real>& a, Four<Real>& b, Four<Real>& c, Four<Real>& d) {
  const Four<Real> ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four<Real> ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four<Real> cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four<Real> cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
}

namespace detail {
// Number k of rows from(first), …, from(first + 3), in lanes 0 to 3 of columns[k].
template <class Real, class From>
[[gnu::always_inline]] inline void four_columns_from(From&& from, int first,
                                                     Four<Real> (&columns)[4]) {
  for (int lane = 0; lane < 4; ++lane) load_four(from(first + lane), columns[lane]);
  transpose<Real>(columns[0], columns[1], columns[2], columns[3]);
}
}  // namespace detail

/// Transposes four numbers of each of N rows into columns: each lane of to[k] is number k of row
/// from(lane). Used to read data that are contiguous per grain in a loop over contacts: eight loads
/// and eight shuffles take a third of the time of sixteen gather loads.
template <class Real, int N, class From>
[[gnu::always_inline]] inline void columns_from(From&& from, simd::Pack<Real, N> (&to)[4]) {
  if constexpr (N == 4) {
    detail::four_columns_from<Real>(from, 0, to);
  } else if constexpr (N == 8) {
    Four<Real> lower[4], upper[4];
    detail::four_columns_from<Real>(from, 0, lower);
    detail::four_columns_from<Real>(from, 4, upper);
    for (int k = 0; k < 4; ++k) {
      to[k] = __builtin_shufflevector(lower[k], upper[k], 0, 1, 2, 3, 4, 5, 6, 7);
    }
  } else {
    // Through arrays, because g++ 12 miscompiles packs that are filled lane by lane at -O3.
    Real rows[N][4], columns[4][N];
    for (int lane = 0; lane < N; ++lane) std::memcpy(rows[lane], from(lane), sizeof rows[lane]);
    for (int k = 0; k < 4; ++k) {
      for (int lane = 0; lane < N; ++lane) columns[k][lane] = rows[lane][k];
      to[k] = simd::load<Real, N>(columns[k]);
    }
  }
}

/// Transposes four columns into four numbers of each of `lanes` rows, `stride` Reals apart.
template <class Real, int lanes>
[[gnu::always_inline]] inline void rows_from(const Real (*from)[lanes], Real* to, int stride) {
  for (int first = 0; first < lanes; first += 4) {
    Four<Real> a, b, c, d;
    load_four(from[0] + first, a);
    load_four(from[1] + first, b);
    load_four(from[2] + first, c);
    load_four(from[3] + first, d);
    transpose<Real>(a, b, c, d);
    Real* const row = to + first * stride;
    simd::store<Real, 4>(row, a);
    simd::store<Real, 4>(row + stride, b);
    simd::store<Real, 4>(row + 2 * stride, c);
    simd::store<Real, 4>(row + 3 * stride, d);
  }
}

}  // namespace silt
