// expect: the fifth argument is not a gradient
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

int main() {
#ifdef SILT_VALID
  using Gradient = mps::MinimumGradient;
#else
  using Gradient = mps::CubicKernel;
#endif
  using Scheme = mps::Scheme<mps::DivergenceSource, mps::AdoptedCollision, mps::CubicKernel,
                             mps::DensitySurface, Gradient>;
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
