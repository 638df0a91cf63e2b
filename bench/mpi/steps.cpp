// SPDX-License-Identifier: MIT
// Time and traffic of the steps of a simulation on several processes:
//
//   mpirun -np 2 bench_mpi_steps SCENE KIND STEPS
//
// SCENE is bed (grains in 3D), dam_2d or dam_3d; KIND is shared, or, for one process, serial. Prints a
// line of JSON. bench/mpi.py runs it with processes and threads in turn.
#include <silt/dem.hpp>
#include <silt/mpi.hpp>
#include <silt/mps.hpp>

#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>

namespace {
using namespace silt;

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return double(time.tv_sec) + 1e-6 * double(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

template <class Sim>
void measure(Sim& simulation, const mpi::World& world, int steps) {
  for (int k = 0; k < 10; ++k) simulation.step();  // finds the halo, and settles
  const auto traffic = world.traffic();
  const double processor = processor_seconds();
  const auto begin = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) simulation.step();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - begin;
  const double used = world.sum(processor_seconds() - processor);
  const double waited = world.sum(world.traffic().seconds - traffic.seconds) / world.size();
  const double halo = world.sum(double(simulation.particles().local() - simulation.particles().size()));
  const double all = world.sum(double(simulation.particles().size()));
  if (!world.is_first()) return;
  const auto now = world.traffic();
  const auto per_step = [&](std::uint64_t before, std::uint64_t after) {
    return double(after - before) / steps;
  };
  std::printf("{\"particles\": %.0f, \"halo\": %.0f, \"ms\": %.4f, \"processor_ms\": %.4f, "
              "\"waiting_ms\": %.4f, \"messages\": %.2f, \"kB\": %.2f, \"reductions\": %.2f}\n",
              all, halo, 1e3 * wall.count() / steps, 1e3 * used / steps, 1e3 * waited / steps,
              per_step(traffic.messages, now.messages),
              per_step(traffic.bytes, now.bytes) / 1024,
              per_step(traffic.reductions, now.reductions));
}

// Layers of spheres that rest on each other, and on a floor.
dem::Grains<3> bed() {
  constexpr double R = 0.01;
  return dem::make_grains(lattice<3>({{0, 0, 0}, {1.28, 1.28, 0.48}}, 2 * R),
                          {.radius = R, .density = 2500});
}
template <class P>
void run_bed(P grains, const mpi::World& world, int steps) {
  const dem::CundallStrack law{.normal_stiffness = 1e5,
                               .tangential_stiffness = 5e4,
                               .restitution = 0.5,
                               .friction_angle = 0.46};
  Simulation simulation{std::move(grains), NeighbourList<3>{},
                        Forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{law, dem::Plane<3>{}}},
                        Leapfrog{GlobalDamping{.alpha = 0.5}}};
  measure(simulation, world, steps);
}

template <class Flow, int Dim, class P>
void run_dam(P particles, const mps::FlowSettings<Dim, mps::Recommended>& settings,
             const mpi::World& world, int steps) {
  Simulation simulation{std::move(particles), UniformGrid<Dim>{}, Flow{settings}, SemiImplicit<>{}};
  measure(simulation, world, steps);
}
template <int Dim>
void run_dam(bool is_shared, double spacing, const mpi::World& world, int steps) {
  auto tank = [&] {
    if constexpr (Dim == 2) {
      return mps::make_tank<mps::Recommended, 2>(
          {.column = {0.4, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = spacing});
    } else {
      return mps::make_tank<mps::Recommended, 3>(
          {.column = {0.4, 0.4},
           .size = {.length = 0.8, .height = 0.6, .depth = 0.4},
           .spacing = spacing});
    }
  }();
  const mps::FlowSettings<Dim, mps::Recommended> settings{
      .spacing = spacing, .density = 1000, .speed_scale = 2.8, .walls = tank.walls};
  if (is_shared) {
    run_dam<mpi::Flow<mps::Recommended, Dim>>(mpi::distribute(tank.particles, world), settings,
                                              world, steps);
  } else {
    run_dam<mps::Flow<mps::Recommended, Dim>>(tank.particles, settings, world, steps);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const mpi::World world;
  if (argc != 4) fail("usage: bench_mpi_steps bed|dam_2d|dam_3d serial|shared STEPS");
  const std::string scene = argv[1];
  const bool is_shared = std::string(argv[2]) == "shared";
  const int steps = std::atoi(argv[3]);
  if (scene == "bed" && is_shared) {
    run_bed(mpi::distribute(bed(), world), world, steps);
  } else if (scene == "bed") {
    run_bed(bed(), world, steps);
  } else if (scene == "dam_2d") {
    run_dam<2>(is_shared, 0.0018, world, steps);
  } else {
    run_dam<3>(is_shared, 0.0087, world, steps);
  }
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
