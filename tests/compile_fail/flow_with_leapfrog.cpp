// expect: this integrator cannot advance these particles with this interaction
// SPDX-License-Identifier: MIT
#include <silt/integrate/leapfrog.hpp>
#include <silt/mps.hpp>

using namespace silt;

int main() {
#ifdef SILT_VALID
  const SemiImplicit integrator;
#else
  const Leapfrog integrator;
#endif
  Simulation sim{mps::Fluid<2>{}, UniformGrid<2>{}, mps::Flow<mps::Case10>({.spacing = 0.01}),
                 integrator};
}
