// SPDX-License-Identifier: MIT
// Four numbers at once, in the vector types that g++ and clang share, so for every processor.
#pragma once

#include <silt/core/types.hpp>

#include <cstring>

namespace silt {

namespace detail {
template <class Real>
struct FourOf {
  typedef Real type __attribute__((vector_size(4 * sizeof(Real))));
};
}  // namespace detail
template <class Real>
using Four = typename detail::FourOf<Real>::type;

// Fours are given by reference: how a function returns one depends on the processor's flags.

template <class Real>
void load_four(const Real* from, Four<Real>& four) {
  std::memcpy(&four, from, sizeof four);
}

/// c −= s a × b of the first three; of the fourth, nothing is said.
template <class Real, class F>
void subtract_cross(F& c, Real s, const F& a, const F& b) {
  c -= s * (__builtin_shufflevector(a, a, 1, 2, 0, 3) * __builtin_shufflevector(b, b, 2, 0, 1, 3) -
            __builtin_shufflevector(a, a, 2, 0, 1, 3) * __builtin_shufflevector(b, b, 1, 2, 0, 3));
}

/// Four rows become four columns: to(k)[lane] = from(lane)[k] for k and lane in 0 … 3, which are pointers
/// to four Reals. It is how a loop over contacts reads what lies together per grain: eight loads and
/// eight shuffles take a third of the time of sixteen gathered loads.
template <class Real, class From, class To>
inline void transpose_four(From&& from, To&& to) {
  Four<Real> a, b, c, d;
  load_four<Real>(from(0), a);
  load_four<Real>(from(1), b);
  load_four<Real>(from(2), c);
  load_four<Real>(from(3), d);
  const Four<Real> ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four<Real> ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four<Real> cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four<Real> cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(ab_even, cd_even, 0, 1, 4, 5);
  b = __builtin_shufflevector(ab_odd, cd_odd, 0, 1, 4, 5);
  c = __builtin_shufflevector(ab_even, cd_even, 2, 3, 6, 7);
  d = __builtin_shufflevector(ab_odd, cd_odd, 2, 3, 6, 7);
  std::memcpy(to(0), &a, sizeof a);
  std::memcpy(to(1), &b, sizeof b);
  std::memcpy(to(2), &c, sizeof c);
  std::memcpy(to(3), &d, sizeof d);
}

}  // namespace silt
