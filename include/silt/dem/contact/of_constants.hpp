// SPDX-License-Identifier: MIT
// Functions of the constants of the grains, evaluated again only when these may have changed.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cstdint>
#include <limits>

namespace silt::dem::detail {

/// The last result of a function of the constants of the grains.
template <class T>
class OfConstants {
 public:
  /// Whether the last result is of these grains; holds_for(result, i) tells whether it is with a
  /// grain i that was added since.
  template <class P, class HoldsFor>
  bool is_of(const P& grains, HoldsFor&& holds_for) {
    if (revision_ != grains.constants_revision() || rows_ != grains.rows_revision()) return false;
    while (number_ < grains.local() && holds_for(std::as_const(value_), number_)) ++number_;
    return number_ == grains.local();
  }
  void forget() { revision_ = 0; }
  /// evaluate(), or its last result. If it throws, it is evaluated again by the next call.
  template <class P, class F, class HoldsFor>
  const T& get(const P& grains, F&& evaluate, HoldsFor&& holds_for) {
    if (!is_of(grains, holds_for)) {
      forget();
      value_ = evaluate();
      revision_ = grains.constants_revision();
      rows_ = grains.rows_revision();
      number_ = grains.local();
    }
    return value_;
  }

 private:
  std::uint64_t revision_ = 0;  // of the constants
  std::uint64_t rows_ = 0;      // revision
  Index number_ = 0;            // of grains
  T value_{};
};

/// Of the radii of all grains, with the halo.
template <class Real>
struct RadiusRange {
  Real smallest = 0;  ///< [m]; infinite without grains
  Real largest = 0;   ///< [m]

  /// Whether it contains this radius [m].
  bool contains(Real R) const { return R >= smallest && R <= largest; }
};
template <class P>
RadiusRange<typename P::Real> radius_range(const P& grains) {
  using Real = typename P::Real;
  const auto R = grains.with_halo(radius);
  constexpr Real infinity = std::numeric_limits<Real>::infinity();
  return {.smallest = -largest(R.size(), -infinity, [&](Index i) { return -R[i]; }),
          .largest = largest(R.size(), Real(0), [&](Index i) { return R[i]; })};
}

}  // namespace silt::dem::detail
