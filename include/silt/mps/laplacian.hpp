// SPDX-License-Identifier: MIT
// The weights that the Laplacian (6) sums with. They are normalised by their own second moment over
// the full lattice, and must not be negative: the pressure equation would lose its definiteness.
#pragma once

#include <silt/mps/kernel.hpp>

#include <algorithm>

namespace silt::mps {

/// The kernel's own weights      (6)
struct KernelLaplacian {
  template <class K, int Dim>
  using Weights = K;
};

/// w'' + (d − 3) w'/q, the divergence of the gradient of Khayyer and Gotoh (2010, 2012); nothing
/// where that is negative, as some kernels have it in 3D for close neighbours.
struct HigherOrderLaplacian {
  template <SmoothKernel K, int Dim>
  struct Weights {
    template <class Real>
    static Real weight(Real q) {
      return std::max(Real(0), K::curvature(q) + (Dim - 3) * K::slope(q) / q);
    }
  };
};

/// Turns a kernel into the weights of a Laplacian.
template <class L>
concept LaplacianWeights = Kernel<typename L::template Weights<CubicKernel, 2>> &&
                           Kernel<typename L::template Weights<CubicKernel, 3>>;

}  // namespace silt::mps
