// expect: the scheme has no member `walls` that is a wall model
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

struct Scheme {
  mps::DivergenceSource source{};
  mps::Collision collision{};
  mps::CubicKernel kernel{};
  mps::DensitySurface surface{};
  mps::ConservingGradient gradient{};
#ifdef SILT_VALID
  mps::GrainyWalls walls{};
#endif
  mps::NoShifting shifting{};
  mps::NoFriction friction{};
  mps::FreeSlip wall_stress{};
  mps::KernelLaplacian laplacian{};
};

int main() {
  const mps::Flow<Scheme> flow({.spacing = 0.01});
}
