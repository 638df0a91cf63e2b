// SPDX-License-Identifier: MIT
// Distances across the periodic sides of a box.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/types.hpp>

#include <cstddef>
#include <limits>

namespace silt {

/// The shortest of the vectors between the periodic images of two points.
template <int Dim, class Real>
class NearestImage {
 public:
  /// Without periodic sides.
  NearestImage() = default;
  explicit NearestImage(const Box<Dim, Real>& box) {
    for (int k = 0; k < Dim; ++k) {
      if (!box.periodic[static_cast<std::size_t>(k)]) continue;
      any_ = true;
      period_[k] = box.upper[k] - box.lower[k];
      inverse_[k] = 1 / period_[k];
    }
  }

  /// Whether an axis is periodic.
  bool any() const noexcept { return any_; }

  /// Along axis k; Number is Real or a pack of Reals.
  template <class Number>
  [[gnu::always_inline]] void apply(int k, Number& r) const {
    // Rounds to the nearest integer: numbers of this size have no fractional part.
    constexpr Real big = Real(1.5) / std::numeric_limits<Real>::epsilon();
    const Number periods = (r * inverse_[k] + big) - big;
    r -= period_[k] * periods;
  }

  Vec<Dim, Real> operator()(Vec<Dim, Real> r) const {
    if (any_) {
      for (int k = 0; k < Dim; ++k) apply(k, r[k]);
    }
    return r;
  }

 private:
  bool any_ = false;
  // 0 along axes that are not periodic.
  Real period_[Dim] = {};
  Real inverse_[Dim] = {};
};

}  // namespace silt
