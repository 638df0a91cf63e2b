// SPDX-License-Identifier: MIT
// Weight functions w(r), r < re, [HwangLeePark2010] (3); particles beyond re are not neighbours.
#pragma once

#include <silt/core/types.hpp>

#include <cmath>
#include <concepts>

namespace silt::mps {

/// Weight of a neighbour at q = r/re in (0, 1) [-]; must not increase with q.
template <class K>
concept Kernel = std::default_initializable<K> && requires(const K kernel, double q, float p) {
  { kernel.weight(q) } -> std::same_as<double>;
  { kernel.weight(p) } -> std::same_as<float>;
};

/// A kernel with w'(q) and w''(q), for the higher-order source and Laplacian.
template <class K>
concept SmoothKernel = Kernel<K> && requires(const K kernel, double q, float p) {
  { kernel.slope(q) } -> std::same_as<double>;
  { kernel.slope(p) } -> std::same_as<float>;
  { kernel.curvature(q) } -> std::same_as<double>;
  { kernel.curvature(p) } -> std::same_as<float>;
};

/// re/r − 1, [HwangLeePark2010] (3a), [KoshizukaOka1996]: infinite at r = 0.
struct InverseKernel {
  template <class Real>
  static Real weight(Real q) {
    return 1 / q - 1;
  }
  template <class Real>
  static Real slope(Real q) {
    return -1 / (q * q);
  }
  template <class Real>
  static Real curvature(Real q) {
    return 2 / (q * q * q);
  }
};

/// exp(−6.3 r²/re²), [HwangLeePark2010] (3b): discontinuous at re, by 0.0018.
struct GaussianKernel {
  template <class Real>
  static Real weight(Real q) {
    return std::exp(Real(-6.3) * q * q);
  }
  template <class Real>
  static Real slope(Real q) {
    return Real(-12.6) * q * weight(q);
  }
  template <class Real>
  static Real curvature(Real q) {
    return Real(12.6) * (Real(12.6) * q * q - 1) * weight(q);
  }
};

/// (1 − r/re)³ (1 + r/re)³, [HwangLeePark2010] (3c), adopted there.
struct CubicKernel {
  template <class Real>
  static Real weight(Real q) {
    const Real s = (1 - q) * (1 + q);
    return s * s * s;
  }
  template <class Real>
  static Real slope(Real q) {
    const Real s = (1 - q) * (1 + q);
    return -6 * q * s * s;
  }
  template <class Real>
  static Real curvature(Real q) {
    const Real s = (1 - q) * (1 + q);
    return 6 * s * (5 * q * q - 1);
  }
};

/// (1 − q)⁴ (1 + 4 q), q = r/re [Wendland1995]: smooth at re, and its Fourier transform is
/// positive, which prevents the pairing of particles.
struct WendlandKernel {
  template <class Real>
  static Real weight(Real q) {
    const Real s = (1 - q) * (1 - q);
    return s * s * (1 + 4 * q);
  }
  template <class Real>
  static Real slope(Real q) {
    return -20 * q * (1 - q) * (1 - q) * (1 - q);
  }
  template <class Real>
  static Real curvature(Real q) {
    return 20 * (1 - q) * (1 - q) * (4 * q - 1);
  }
};

}  // namespace silt::mps
