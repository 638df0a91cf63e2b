// SPDX-License-Identifier: MIT
// A vector in one register, if the processor has one that is wide enough: sums over neighbours then
// take fewer instructions, with the same bits as those of Vec.
#pragma once

#include <silt/core/simd.hpp>
#include <silt/core/types.hpp>

#include <type_traits>

namespace silt {

/// Whether a vector is kept in a register. In pieces, it would take longer than as a Vec.
template <int Dim, class Real>
inline constexpr bool fits_in_register = Dim == 2 || 4 * sizeof(Real) <= simd::width;

/// The components of a Vec, in 3D followed by one that is 0; or a Vec.
template <int Dim, class Real>
using VecPack = std::conditional_t<fits_in_register<Dim, Real>, simd::Pack<Real, Dim == 2 ? 2 : 4>,
                                   Vec<Dim, Real>>;

// Packs are passed by reference, because how they are returned depends on the processor flags.

template <class Real, int Dim>
[[gnu::always_inline]] inline void load_vec(const Eigen::Matrix<Real, Dim, 1>& from,
                                            VecPack<Dim, Real>& to) {
  if constexpr (!fits_in_register<Dim, Real>) {
    to = from;
  } else if constexpr (Dim == 2) {
    to = *reinterpret_cast<const typename simd::UnalignedPackOf<Real, 2>::type*>(from.data());
  } else {
    simd::load_three(from.data(), to);
  }
}
template <int Dim, class Real>
[[gnu::always_inline]] inline void set_zero(VecPack<Dim, Real>& p) {
  if constexpr (fits_in_register<Dim, Real>) {
    p = VecPack<Dim, Real>{};
  } else {
    p.setZero();
  }
}
/// a·b, with the additions in the order of Vec::dot().
template <int Dim, class Real>
[[gnu::always_inline]] inline Real dot_of(const VecPack<Dim, Real>& a,
                                          const VecPack<Dim, Real>& b) {
  if constexpr (fits_in_register<Dim, Real>) {
    const VecPack<Dim, Real> p = a * b;
    if constexpr (Dim == 2) return p[0] + p[1];
    if constexpr (Dim == 3) return (p[0] + p[1]) + p[2];
  } else {
    return a.dot(b);
  }
}
template <int Dim, class Real>
[[gnu::always_inline]] inline Vec<Dim, Real> to_vec(const VecPack<Dim, Real>& p) {
  Vec<Dim, Real> v;
  for (int k = 0; k < Dim; ++k) v[k] = p[k];
  return v;
}

/// Σ a bᵀ. Not an array of packs, which g++ would keep in memory.
template <int Dim, class Real>
class SumOfOuterProducts {
 public:
  using Pack = VecPack<Dim, Real>;

  SumOfOuterProducts() {
    set_zero<Dim, Real>(first_);
    set_zero<Dim, Real>(second_);
    set_zero<Dim, Real>(third_);
  }
  [[gnu::always_inline]] inline void add(const Pack& a, const Pack& b) {
    first_ += b[0] * a;
    second_ += b[1] * a;
    if constexpr (Dim == 3) third_ += b[2] * a;
  }
  Eigen::Matrix<Real, Dim, Dim> value() const {
    Eigen::Matrix<Real, Dim, Dim> value;
    value.col(0) = to_vec<Dim, Real>(first_);
    value.col(1) = to_vec<Dim, Real>(second_);
    if constexpr (Dim == 3) value.col(2) = to_vec<Dim, Real>(third_);
    return value;
  }

 private:
  Pack first_, second_, third_;  // columns
};

}  // namespace silt
