// SPDX-License-Identifier: MIT
// Grains that several processes share; the first prints how many processes there are.
#include <silt/dem.hpp>
#include <silt/mpi.hpp>

#include <cstdio>
#include <utility>

int main() try {
  const silt::mpi::World world;
  auto grains = silt::dem::make_grains(silt::lattice<2>({{0, 0}, {1, 1}}, 0.1),
                                       {.radius = 0.05, .density = 2500});
  const double all = double(grains.size());
  const auto shared = silt::mpi::distribute(std::move(grains), world);
  const bool is_complete = world.sum(double(shared.size())) == all;
  if (world.is_first()) std::printf("%d processes\n", world.size());
  return is_complete ? 0 : 1;
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
