// SPDX-License-Identifier: MIT
// A vector in one register: sums over neighbours take half as many instructions, with the same bits
// as those of Vec.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

namespace silt {

/// The components of a Vec, in 3D followed by one that is 0.
template <int Dim, class Real>
using VecPack = simd::Pack<Real, Dim == 2 ? 2 : 4>;

// Packs are passed by reference, because how they are returned depends on the processor flags.

template <int Dim, class Real>
[[gnu::always_inline]] inline void load_vec(const Real* from, VecPack<Dim, Real>& to) {
  if constexpr (Dim == 2) {
    to = *reinterpret_cast<const typename simd::UnalignedPackOf<Real, 2>::type*>(from);
  } else {
    simd::load_three(from, to);
  }
}
template <class Real, int Dim>
[[gnu::always_inline]] inline void load_vec(const Eigen::Matrix<Real, Dim, 1>& from,
                                            VecPack<Dim, Real>& to) {
  load_vec<Dim, Real>(from.data(), to);
}

/// The sum of the components, in the order of Vec::dot().
template <int Dim, class Pack>
[[gnu::always_inline]] inline auto sum_of(const Pack& p) {
  if constexpr (Dim == 2) {
    return p[0] + p[1];
  } else {
    return (p[0] + p[1]) + p[2];
  }
}

template <int Dim, class Pack>
[[gnu::always_inline]] inline auto to_vec(const Pack& p) {
  using Real = std::remove_cvref_t<decltype(p[0])>;
  Vec<Dim, Real> v;
  for (int k = 0; k < Dim; ++k) v[k] = p[k];
  return v;
}

/// Σ a bᵀ. Not an array of packs, which g++ would keep in memory.
template <int Dim, class Real>
class SumOfOuterProducts {
 public:
  using Pack = VecPack<Dim, Real>;

  [[gnu::always_inline]] inline void add(const Pack& a, const Pack& b) {
    first_ += b[0] * a;
    second_ += b[1] * a;
    if constexpr (Dim == 3) third_ += b[2] * a;
  }
  Eigen::Matrix<Real, Dim, Dim> value() const {
    Eigen::Matrix<Real, Dim, Dim> value;
    value.col(0) = to_vec<Dim>(first_);
    value.col(1) = to_vec<Dim>(second_);
    if constexpr (Dim == 3) value.col(2) = to_vec<Dim>(third_);
    return value;
  }

 private:
  Pack first_{}, second_{}, third_{};  // columns
};

}  // namespace silt
