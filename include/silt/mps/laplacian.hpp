// SPDX-License-Identifier: MIT
// Weights of the Laplacian (6). They are normalised by their own second moment over the full
// lattice, and must not be negative, or the pressure equation would not be definite.
#pragma once

#include <silt/mps/kernel.hpp>

#include <algorithm>

namespace silt::mps {

/// The weights of the kernel      (6)
struct KernelLaplacian {
  template <class K, int Dim>
  using Weights = K;
};

/// w'' + (d − 3) w'/q, the divergence of the gradient, of Khayyer and Gotoh (2010, 2012); zero
/// where this is negative, as for some kernels at small q in 3D.
struct HigherOrderLaplacian {
  template <SmoothKernel K, int Dim>
  struct Weights {
    template <class Real>
    static Real weight(Real q) {
      return std::max(Real(0), K::curvature(q) + (Dim - 3) * K::slope(q) / q);
    }
  };
};

/// L::Weights<K, Dim> are the weights of the Laplacian for kernel K.
template <class L>
concept LaplacianWeights = Kernel<typename L::template Weights<CubicKernel, 2>> &&
                           Kernel<typename L::template Weights<CubicKernel, 3>>;

}  // namespace silt::mps
