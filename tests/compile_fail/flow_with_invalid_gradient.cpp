// expect: the scheme has no member `gradient` that is a gradient
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

int main() {
#ifdef SILT_VALID
  using Gradient = mps::MinimumGradient;
#else
  using Gradient = mps::CubicKernel;
#endif
  struct Scheme : mps::Case10 {
    Gradient gradient{};
  };
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
