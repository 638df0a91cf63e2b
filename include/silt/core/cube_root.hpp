// SPDX-License-Identifier: MIT
// Cube root with the same bits everywhere: the last bit of std::cbrt is that of a C library.
#pragma once

#include <silt/core/lane.hpp>

#include <cmath>

namespace silt {

/// ∛x [-] of a number from 1e-100 to 1e100, in float from 1e-30 to 1e30, to a few units in the last
/// place; for any scalar with a square root.
template <class Real>
Real cube_root(const Real& x) {
  using std::sqrt;
  // x^{1/4 + 1/16 + 1/64 + 1/256}, then Newton's method.
  Real power = x;
  Real root(1);
  SILT_UNROLLED
  for (int n = 0; n < 4; ++n) {
    power = sqrt(Real(sqrt(power)));
    root = root * power;
  }
  SILT_UNROLLED
  for (int n = 0; n < 6; ++n) root = (2 * root + x / (root * root)) / 3;
  return root;
}

}  // namespace silt
