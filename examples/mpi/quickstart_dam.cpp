// SPDX-License-Identifier: MIT
// quickstart_dam.cpp on several processes: the lines with a number are added or changed. Run it by
// mpirun -np 4; writes dam.pvd, for ParaView, to the current folder.
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mpi.hpp>  // 1
#include <silt/mps.hpp>

#include <cstdio>

int main() try {
  using namespace silt;
  const mpi::World world;  // 2
  constexpr double l0 = 0.02;  // particle spacing [m]

  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = l0});

  // speed_scale is √(g H), the expected speed, which limits the time step from the beginning.
  const mpi::Flow<mps::Recommended> water{  // 4
      {.spacing = l0, .density = 1000, .speed_scale = 2.8, .walls = tank.walls}};

  Simulation dam{mpi::distribute(tank.particles, world),  // 3
                 UniformGrid<2>{}, water, SemiImplicit<>{}};
  dam.run({.until = 1.0, .output_every = 0.02}, VtkSeries{"dam"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
