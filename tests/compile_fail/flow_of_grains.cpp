// expect: the third argument is not an interaction for these particles
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>
#include <silt/mps.hpp>

using namespace silt;

int main() {
#ifdef SILT_VALID
  const mps::Fluid<2> particles;
#else
  const dem::Grains<2> particles;
#endif
  Simulation sim{particles, UniformGrid<2>{}, mps::Flow<mps::Case10>({.spacing = 0.01}),
                 SemiImplicit{}};
}
