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
  /// Whether the last result is of these grains.
  template <class P>
  bool is_of(const P& grains) const {
    return revision_ == grains.constants_revision();
  }
  void forget() { revision_ = 0; }
  /// evaluate(), or its last result. If it throws, it is evaluated again by the next call.
  template <class P, class F>
  const T& get(const P& grains, F&& evaluate) {
    if (revision_ != grains.constants_revision()) {
      value_ = evaluate();
      revision_ = grains.constants_revision();
    }
    return value_;
  }

 private:
  std::uint64_t revision_ = 0;
  T value_{};
};

/// Of the radii of all grains, with the halo.
template <class Real>
struct RadiusRange {
  Real smallest = 0;  ///< [m]; infinite without grains
  Real largest = 0;   ///< [m]
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
