// expect: this flow's pressure source needs the number density of moved particles
// SPDX-License-Identifier: MIT
#include <silt/mps.hpp>

using namespace silt;

int main() {
#ifdef SILT_VALID
  using Scheme = mps::Case01;
#else
  using Scheme = mps::Case00;
#endif
  Simulation sim{mps::Fluid<2>{}, UniformGrid<2>{}, mps::Flow<Scheme>({.spacing = 0.01}),
                 SemiImplicit<KeepsParticles>{}};
  sim.step();
}
