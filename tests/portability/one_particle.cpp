// SPDX-License-Identifier: MIT
// A simulation that compiles fast: exits with 2 if Silt refuses the compiler's options.
#include <silt/core/forces.hpp>
#include <silt/core/simulation.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/integrate/leapfrog.hpp>
#include <silt/search/brute_force.hpp>

#include <cstdio>

int main() try {
  using namespace silt;
  dem::Grains<2> grains;
  dem::add_grain(grains, {0, 0}, {.radius = 0.01, .density = 2500});
  Simulation fall{grains, BruteForce<2>{}, Gravity<2>{{0, -9.81}}, Leapfrog{}};
  fall.step(1e-3);
} catch (const silt::Error& error) {
  std::printf("%s\n", error.what());
  return 2;
}
