// SPDX-License-Identifier: MIT
// A few steps of grains and of water: prints energies [J] with all digits. Exits with 2 if Silt
// refuses the compiler's options.
#include <silt/dem.hpp>
#include <silt/mps.hpp>

#include <cmath>
#include <cstdio>

namespace {

using namespace silt;

double energy_of_grains() {
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
  return kinetic_energy(bed.snapshot());
}

double energy_of_water() {
  constexpr double spacing = 0.02;
  const auto tank = mps::make_tank<2>(
      {.column = {0.2, 0.4}, .size = {.length = 0.8, .height = 0.6}, .spacing = spacing});
  const mps::Flow<mps::Recommended, 2, double, ConjugateGradient<>> water{
      {.spacing = spacing, .density = 1000, .speed_scale = 2},
      ConjugateGradient<>({.tolerance = 1e-12})};
  Simulation dam{tank, UniformGrid<2>{}, water, SemiImplicit<>{}};
  for (int step = 0; step < 20; ++step) dam.step(1e-3);
  return dam.interaction().energy().kinetic;
}

}  // namespace

int main() try {
  std::printf("%.17g %.17g\n", energy_of_grains(), energy_of_water());
} catch (const Error& error) {
  std::printf("%s\n", error.what());
  return 2;
}
