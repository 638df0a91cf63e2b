// SPDX-License-Identifier: MIT
// A few steps of grains and of water: prints the kinetic energies [J] with all digits, then hashes
// of all bits of the states. Exits with 2 if Silt refuses the compiler's options.
#include <silt/dem.hpp>
#include <silt/mps.hpp>

#include "hash.hpp"

#include <cmath>
#include <cstdint>
#include <cstdio>

namespace {

using namespace silt;

struct Result {
  double energy;  // [J]
  std::uint64_t hash;
};

Result grains_at_end() {
  auto grains = dem::make_grains(lattice<2>({{0, 0}, {0.4, 0.4}}, 0.0199),
                                 {.radius = 0.01, .density = 2500});
  for (Index i = 0; i < grains.size(); ++i) {
    const double phase = 7.0 * double(grains.id(i));
    grains[velocity][i] = {0.5 * std::sin(phase), 0.5 * std::cos(phase)};
  }
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.4};
  Simulation bed{grains, NeighbourList<2>{}, dem::Contacts{law}, Leapfrog{}};
  for (int step = 0; step < 200; ++step) bed.step(1e-5);
  return {kinetic_energy(bed.snapshot()), portability::hash_of(bed)};
}

Result water_at_end() {
  constexpr double spacing = 0.02;
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.2, 0.4}, .size = {.length = 0.8, .height = 0.6}, .spacing = spacing});
  const mps::Flow<mps::Recommended, 2, double, ConjugateGradient<>> water{
      {.spacing = spacing, .speed_scale = 2, .walls = tank.walls},
      ConjugateGradient<>({.tolerance = 1e-12})};
  Simulation dam{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  for (int step = 0; step < 20; ++step) dam.step(1e-3);
  return {dam.interaction().energy().kinetic, portability::hash_of(dam)};
}

}  // namespace

int main() try {
  const Result grains = grains_at_end(), water = water_at_end();
  std::printf("%.17g %.17g %016llx %016llx\n", grains.energy, water.energy,
              static_cast<unsigned long long>(grains.hash),
              static_cast<unsigned long long>(water.hash));
} catch (const Error& error) {
  std::printf("%s\n", error.what());
  return 2;
}
