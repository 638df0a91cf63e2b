// SPDX-License-Identifier: MIT
// Images of points beyond the periodic sides of a box, and distances across these sides.
#pragma once

#include <silt/core/box.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/types.hpp>

#include <cstddef>
#include <limits>
#include <type_traits>

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

/// f(x) and f(image) for the images of x [m] beyond the periodic sides closer than a distance [m].
template <int Dim, class Real, class Number>
void for_each_image(const Box<Dim, Real>& box, const Vec<Dim, Number>& x, Number distance,
                    std::type_identity_t<FunctionRef<void(const Vec<Dim, Number>&)>> f,
                    int axis = 0) {
  if (axis == Dim) return f(x);
  for_each_image(box, x, distance, f, axis + 1);
  if (!box.periodic[static_cast<std::size_t>(axis)]) return;
  const Real period = box.upper[axis] - box.lower[axis];
  Vec<Dim, Number> image = x;
  if (x[axis] < box.lower[axis] + distance) {
    image[axis] = x[axis] + period;
    for_each_image(box, image, distance, f, axis + 1);
  }
  if (x[axis] > box.upper[axis] - distance) {
    image[axis] = x[axis] - period;
    for_each_image(box, image, distance, f, axis + 1);
  }
}

}  // namespace silt
