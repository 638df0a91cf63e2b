// SPDX-License-Identifier: MIT
// A drop falls into a pool.
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cstdio>

int main() {
  using namespace silt;
  constexpr double l0 = 0.005;  // particle spacing [m]

  // Particles: a tank with water at the bottom, and a drop above it, which falls at 2 m/s.
  auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.8, 0.1}, .size = {.length = 0.8, .height = 0.4}, .spacing = l0});
  for (const auto& x : lattice<2>({{0.35, 0.12}, {0.45, 0.22}}, l0)) {
    if ((x - Vec<2>(0.4, 0.17)).norm() > 0.05) continue;
    const Index i = mps::add_particle(tank.particles, x, mps::Kind::fluid);
    tank.particles[velocity][i] = {0, -2};
  }

  // Interaction: the pressure of an incompressible fluid, gravity and walls.
  const mps::Flow<mps::Recommended> water{
      {.spacing = l0, .density = 1000, .speed_scale = 2.5, .walls = tank.walls}};

  Simulation splash{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  splash.run({.until = 0.15, .output_every = 0.05}, VtkSeries{"splash"}, [](const auto& now) {
    double highest = 0;
    for (const auto& x : now.particles()[position]) highest = std::max(highest, x[1]);
    std::printf("%.2f s: the water reaches up to %.3f m\n", now.time(), highest);
  });
}
