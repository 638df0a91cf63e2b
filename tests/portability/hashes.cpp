// SPDX-License-Identifier: MIT
// Small runs of both methods: prints, for each, a hash of every bit of the positions and velocities
// at its end, which may depend on neither the processor nor the compiler. It needs no files, so that
// it runs as WebAssembly, too. The spheres and the water have more than one chunk of particles, so
// that several threads share them.
#include <silt/dem.hpp>
#include <silt/mps.hpp>

#include "hash.hpp"

#include <cstddef>
#include <cstdio>
#include <cstdlib>

#ifdef __wasm__
// What Debian's libraries for wasm32 lack: destructors of thread_local objects, which nothing here
// needs, and exceptions, which end the program.
extern "C" {
int __cxa_thread_atexit(void (*)(void*), void*, void*) { return 0; }
void* __cxa_allocate_exception(std::size_t) { std::abort(); }
void __cxa_throw(void*, void*, void*) { std::abort(); }
}
#endif

namespace {

using namespace silt;

template <class Simulation>
void run(const char* name, Simulation simulation, int steps) {
  for (int step = 0; step < steps; ++step) simulation.step();
  std::printf("%s %016llx\n", name,
              static_cast<unsigned long long>(portability::hash_of(simulation)));
}

// Discs in a square pattern that one disc falls on, beside a paddle that turns.
void tower() {
  constexpr double R = 0.02;  // [m]
  auto discs = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 2 * R),
                                {.radius = R, .density = 2500});
  const Index top = dem::add_grain(discs, {0.3 * R, 0.8 + R}, {.radius = R, .density = 2500});
  discs[velocity][top] = {0, -5};
  const dem::CundallStrack law{.normal_stiffness = 1e6,
                               .tangential_stiffness = 5e5,
                               .restitution = 0.5,
                               .friction_angle = 0.46};
  const dem::Moving paddle{dem::Segment<double>{{0.12, 0.05}, {0.3, 0.05}},
                           dem::Rotation<2>{.about = {0.3, 0.05}, .spin = -5}};
  run("tower", Simulation{discs, NeighbourList<2>{},
                          Forces{Gravity<2>{{0, -9.81}},
                                 dem::Contacts{law, dem::Plane<2>{.normal = {0, 1}}, paddle}},
                          Leapfrog{GlobalDamping{.alpha = 0.5}}}, 600);
}

// Spheres of several sizes that slide and roll down a slope.
void slope() {
  const dem::Elastic glass{.young_modulus = 1e7, .poisson_ratio = 0.25};
  const dem::Law law{dem::Hertz{.elastic = glass, .restitution = 0.6},
                     dem::Mindlin{.elastic = glass, .friction_angle = 0.3}};
  dem::Grains<3> spheres;
  for (const auto& x : lattice<3>({{0, 0, 0}, {0.24, 0.24, 0.16}}, 0.02)) {
    const double share = double(spheres.size() % 7) / 6;
    const Index i = dem::add_grain(spheres, x, {.radius = 0.008 + 0.002 * share, .density = 2500});
    spheres[velocity][i] = {0.3 * share, 0.1, -0.5 * share};
  }
  run("slope", Simulation{spheres, UniformGrid<3>{},
                          Forces{Gravity<3>{{4, 1, -9}},
                                 dem::Contacts{law, dem::Plane<3>{.normal = {0, 0, 1}}}},
                          Leapfrog{}}, 400);
}

void dam() {
  constexpr double l0 = 0.012;  // [m]
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {0.3, 0.6}, .size = {.length = 0.9, .height = 0.9}, .spacing = l0});
  const mps::Flow<mps::Recommended> water{{.spacing = l0, .speed_scale = 2.4, .walls = tank.walls}};
  run("dam", Simulation{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}}, 200);
}

void dam_in_space() {
  constexpr double l0 = 0.05;  // [m]
  auto tank = mps::make_tank<mps::Recommended, 3>(
      {.column = {0.3, 0.4}, .size = {.length = 0.7, .height = 0.6, .depth = 0.3}, .spacing = l0});
  for (const auto& face : faces_of(Box<3>{.lower = {0.4, 0.1, 0}, .upper = {0.5, 0.2, 0.3}})) {
    tank.walls.triangles.push_back(face);
  }
  const mps::Flow<mps::Recommended, 3> water{
      {.spacing = l0, .speed_scale = 2, .walls = tank.walls}};
#ifdef EIGEN_VECTORIZE
  const char* const name = "dam_in_space";
#else
  // Eigen then sums the products of vectors in 3D in another order.
  const char* const name = "dam_in_space_without_vector_instructions";
#endif
  run(name, Simulation{tank.particles, UniformGrid<3>{}, water, SemiImplicit<>{}}, 100);
}

}  // namespace

int main() try {
  tower();
  slope();
  dam();
  dam_in_space();
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
