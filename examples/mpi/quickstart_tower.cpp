// SPDX-License-Identifier: MIT
// quickstart_tower.cpp on several processes: the lines with a number are added or changed. Run it by
// mpirun -np 4, then open tower.pvd in ParaView.
#include <silt/dem.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mpi.hpp>  // 1

#include <cstdio>

int main() try {
  using namespace silt;
  const mpi::World world;  // 2
  constexpr double R = 0.02;  // radius of a grain [m]

  auto grains = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 2 * R),
                                 {.radius = R, .density = 2500});
  dem::add_grain(grains, {0.3 * R, 0.8 + 2 * R}, {.radius = R, .density = 2500});

  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.5,
                               .friction_angle = 0.46};
  const auto floor = dem::Plane<2>{.normal = {0, 1}};

  Simulation tower{mpi::distribute(grains, world),  // 3
                   NeighbourList<2>{},
                   Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, floor}},
                   Leapfrog{GlobalDamping{.alpha = 0.5}}};
  tower.run({.until = 1.5, .output_every = 0.02}, VtkSeries{"tower"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
