// SPDX-License-Identifier: MIT
// Four rows of four numbers become four columns: how a loop over contacts reads what lies together
// per grain. In the vector types that g++ and clang share, so for every processor; eight loads and
// eight shuffles take a third of the time of sixteen gathered loads.
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

/// to(k)[lane] = from(lane)[k] for k and lane in 0 … 3; from(lane) and to(k) are pointers to four
/// Reals.
template <class Real, class From, class To>
inline void transpose_four(From&& from, To&& to) {
  using Four = typename detail::FourOf<Real>::type;
  Four a, b, c, d;
  std::memcpy(&a, from(0), sizeof a);
  std::memcpy(&b, from(1), sizeof b);
  std::memcpy(&c, from(2), sizeof c);
  std::memcpy(&d, from(3), sizeof d);
  const Four ab_even = __builtin_shufflevector(a, b, 0, 4, 2, 6);
  const Four ab_odd = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd_even = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Four cd_odd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
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
