// SPDX-License-Identifier: MIT
// Weight functions w(r), r < re, [HwangLeePark2010] (3). Beyond re the search finds nobody.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>
#include <concepts>

namespace silt::mps {

/// Weight of a neighbour at q = r/re in (0, 1) [-]; does not rise with q.
template <class K>
concept Kernel = requires(double q, float p) {
  { K::weight(q) } -> std::same_as<double>;
  { K::weight(p) } -> std::same_as<float>;
};

/// re/r − 1 (3a), Koshizuka and Oka (1996): infinite at r = 0.
struct InverseKernel {
  template <class Real>
  static Real weight(Real q) {
    return 1 / q - 1;
  }
};

/// exp(−6.3 r²/re²) (3b): jumps by 0.0018 at re.
struct GaussianKernel {
  template <class Real>
  static Real weight(Real q) {
    return std::exp(Real(-6.3) * q * q);
  }
};

/// (1 − r/re)³ (1 + r/re)³ (3c): what the paper adopts.
struct CubicKernel {
  template <class Real>
  static Real weight(Real q) {
    const Real s = (1 - q) * (1 + q);
    return s * s * s;
  }
};

}  // namespace silt::mps
