// SPDX-License-Identifier: MIT
// A run of several processes, of which the last one kills itself, for killed.sh. With an argument, one
// process that reads the checkpoint of that run.
#include <silt/dem.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/checkpoints.hpp>
#include <silt/mpi.hpp>

#include <csignal>
#include <cstdio>
#include <utility>

using namespace silt;

template <class P>
auto tower_of(P grains) {
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.5,
                               .friction_angle = 0.46};
  return Simulation{std::move(grains), NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}},
                           dem::Contacts{law, dem::Plane<2>{.normal = {0, 1}}}},
                    Leapfrog{}};
}

int main(int argc, char**) try {
  const mpi::World world;
  constexpr const char* file = "killed.silt";
  const auto grains = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 0.04),
                                       {.radius = 0.02, .density = 2500});
  if (argc > 1) {
    auto tower = tower_of(grains);
    read_checkpoint(file, tower);
    tower.step();
    std::printf("continued from step %d\n", int(tower.steps()) - 1);
    return 0;
  }
  auto tower = tower_of(mpi::distribute(grains, world));
  Checkpoints checkpoints(file, {.every = 1e-3});
  const auto kill_last = [&world](const auto& simulation) {
    if (simulation.steps() > 500 && world.rank() + 1 == world.size()) std::raise(SIGKILL);
  };
  tower.run({.until = 10, .output_every = 1e-3}, checkpoints, kill_last);
  return 0;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
