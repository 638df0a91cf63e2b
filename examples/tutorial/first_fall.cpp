// SPDX-License-Identifier: MIT
// A ball hits a tower of grains.
#include <silt/dem.hpp>
#include <silt/io/vtk.hpp>

#include <algorithm>
#include <cstdio>

int main() {
  using namespace silt;

  // Particles: discs on a lattice, and a larger one that flies at them.
  auto grains =
      dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.6}}, 0.02), {.radius = 0.01, .density = 2500});
  const Index ball = dem::add_grain(grains, {-0.1, 0.35}, {.radius = 0.06, .density = 2500});
  grains[velocity][ball] = {2, 0};

  // Interaction: gravity, and contacts of the grains with each other and with a floor.
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.5,
                               .friction_angle = 0.5};
  const Forces forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, dem::Plane<2>{}}};

  // A search finds the neighbours of each grain, and an integrator moves the grains.
  Simulation fall{grains, NeighbourList<2>{}, forces, Leapfrog{}};
  fall.run({.until = 0.45, .output_every = 0.15}, VtkSeries{"fall"}, [](const auto& now) {
    double highest = 0;
    for (const auto& x : now.particles()[position]) highest = std::max(highest, x[1]);
    std::printf("%.2f s: the highest grain is at %.2f m\n", now.time(), highest);
  });
}
