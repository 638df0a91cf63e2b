// SPDX-License-Identifier: MIT
// Weights of the Laplacian (6). They are normalised by their own second moment over the full
// lattice, and must not be negative, or the pressure equation would not be definite.
#pragma once

#include <silt/mps/operator/kernel.hpp>

#include <algorithm>

namespace silt::mps {

/// The weights of the kernel, [HwangLeePark2010] (6).
struct KernelLaplacian {
  template <int Dim, Kernel K>
  K weights(const K& kernel) const {
    return kernel;
  }
};

/// w'' + (d − 3) w'/q, the divergence of the gradient, of [KhayyerGotoh2010] and Khayyer and Gotoh
/// (2012); zero where this is negative, as for some kernels at small q in 3D.
struct HigherOrderLaplacian {
  /// The weights for this `kernel`.
  template <int Dim, SmoothKernel K>
  struct Weights {
    [[no_unique_address]] K kernel = {};

    template <class Real>
    Real weight(Real q) const {
      return std::max(Real(0), kernel.curvature(q) + (Dim - 3) * kernel.slope(q) / q);
    }
  };
  template <int Dim, SmoothKernel K>
  Weights<Dim, K> weights(const K& kernel) const {
    return {kernel};
  }
};

/// weights<Dim>(kernel) returns the weights of the Laplacian for a kernel, which are a Kernel.
template <class L>
concept LaplacianWeights = requires(const L laplacian, const CubicKernel kernel) {
  { laplacian.template weights<2>(kernel) } -> Kernel;
  { laplacian.template weights<3>(kernel) } -> Kernel;
};

}  // namespace silt::mps
