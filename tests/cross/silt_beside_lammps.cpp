// SPDX-License-Identifier: MIT
// Silt's part of the cross-check with LAMMPS; called by lammps.py.
//   silt_beside_lammps make SCENE FILE                    writes the common initial state
//   silt_beside_lammps run SCENE FILE LAW TIME_STEP STEPS EVERY FRAMES
//                                                         runs it; a frame every EVERY steps
// LAW is "kn kt gamma_n gamma_t xmu", or "E 0 nu gamma" of jkr.
// Scenes: clump, an oblique impact of two rigid bodies of three spheres; jkr, a head-on impact of two equal sticky spheres; pair, an oblique impact of two unequal
// spheres with spin; collapse, a block of 500 equal spheres that collapses on a floor. Units as in
// bench/scenes.hpp.
#include "../../bench/states.hpp"

#include <silt/dem.hpp>
#include <silt/dem/clump/clump_leapfrog.hpp>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace bench;

State pair() {
  State state{.bodies = {}, .lower = Vec3::Constant(-2), .upper = Vec3::Constant(2)};
  state.bodies.push_back({.x = {-0.5, 0, 0}, .v = {1, 0.25, 0}, .w = {0, 0.5, -1.5}});
  state.bodies.push_back(
      {.x = {0.4, 0.3, 0.2}, .v = {-1, -1, 0.5}, .w = {2, 0, 1}, .diameter = 0.6});
  return state;
}

State sticky_pair() {
  State state{.bodies = {}, .lower = Vec3::Constant(-2), .upper = Vec3::Constant(2)};
  const Vec3 axis(0.6, 0.64, 0.48);
  state.bodies.push_back({.x = -0.505 * axis, .v = axis});
  state.bodies.push_back({.x = 0.505 * axis, .v = -axis});
  return state;
}

// Bent lines of three spheres that overlap, with a spin about three axes.
State two_clumps() {
  State state{.bodies = {}, .lower = Vec3::Constant(-6), .upper = Vec3::Constant(6)};
  const std::array<Vec3, 3> shape{Vec3(-0.6, 0, 0), Vec3(0, 0.1, 0), Vec3(0.5, -0.2, 0.3)};
  const std::array<double, 3> diameters{1, 0.9, 0.8};
  const auto add = [&](const Vec3& at, const Vec3& v, const Vec3& w) {
    for (std::size_t s = 0; s < 3; ++s) {
      state.bodies.push_back({.x = at + shape[s],
                              .v = v + silt::cross(w, shape[s]),
                              .w = w,
                              .diameter = diameters[s]});
    }
  };
  add(Vec3(-1.3, 0, 0), Vec3(1, 0.2, 0), Vec3(1, 0.7, -0.4));
  add(Vec3(1.3, 0.4, 0.1), Vec3(-1, 0, 0.1), Vec3(-0.5, 1, 0.8));
  return state;
}

double mass_of(const Body& sphere) { return sphere.diameter * sphere.diameter * sphere.diameter; }

// Those of LAMMPS's fix rigid: the sums over the spheres, also of what they have in common.
silt::dem::ClumpShape<3> shape_of(std::span<const Body> spheres) {
  using namespace silt;
  MassProperties<3> sum;
  std::vector<Ball<3>> balls;
  for (const Body& each : spheres) {
    const double m = mass_of(each);
    balls.push_back({each.x, each.diameter / 2});
    sum.mass += m;
    sum.centre += m * each.x;
  }
  sum.centre /= sum.mass;
  for (const Body& each : spheres) {
    const Vec3 r = each.x - sum.centre;
    sum.inertia += mass_of(each) * ((r.squaredNorm() + 0.1 * each.diameter * each.diameter) *
                                        Inertia<3>::Identity() -
                                    r * r.transpose());
  }
  return {balls, sum};
}

// 10 × 5 × 10 spheres without contacts, so that the first steps of the two codes are equal. The
// gaps are small, because round-off errors grow too fast for comparisons if spheres fly.
State block() {
  constexpr double spacing = 1.001;
  constexpr double jitter = 5e-4;
  Random random(500);
  State state{.bodies = {}, .lower = Vec3(-30, -30, 0), .upper = Vec3(30, 30, 30)};
  const Vec3 size = spacing * Vec3(10, 5, 10);
  for (const Vec3& x : silt::lattice<3>({{0, 0, 0}, size}, spacing)) {
    state.bodies.push_back({.x = x + jitter * (random.in_cube() - Vec3::Constant(0.5))});
  }
  return state;
}

// In the format of LAMMPS's dumps, so that both are read by the same function.
template <class Simulation>
void write_frame(std::FILE* out, const Simulation& simulation) {
  const auto bodies = bodies_of(simulation.snapshot());
  std::fprintf(out, "ITEM: TIMESTEP\n%llu\nITEM: NUMBER OF ATOMS\n%zu\nITEM: ATOMS\n",
               static_cast<unsigned long long>(simulation.steps()), bodies.size());
  Index id = 0;
  for (const auto& [x, v, w, diameter] : bodies) {
    std::fprintf(out, "%zu %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", ++id,
                 diameter, x[0], x[1], x[2], v[0], v[1], v[2], w[0], w[1], w[2]);
  }
}

HookeHistory law_of(const char* text) {
  HookeHistory law;
  if (std::sscanf(text, "%lf %lf %lf %lf %lf", &law.kn, &law.kt, &law.gamma_n, &law.gamma_t,
                  &law.xmu) != 5) {
    throw std::runtime_error(std::string("no law: ") + text);
  }
  return law;
}

silt::dem::Law<silt::dem::Jkr> jkr_of(const char* text) {
  silt::dem::Jkr law;
  if (std::sscanf(text, "%lf 0 %lf %lf", &law.elastic.young_modulus, &law.elastic.poisson_ratio,
                  &law.surface_energy) != 3) {
    throw std::runtime_error(std::string("no law: ") + text);
  }
  return {law};
}

struct Frames {
  double time_step;
  int steps;
  int every;
  const char* path;
};

template <class Simulation>
void run(Simulation simulation, const Frames& frames) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(frames.path, "w"),
                                                             std::fclose);
  if (!file) throw std::runtime_error(std::string("cannot write ") + frames.path);
  write_frame(file.get(), simulation);
  for (int step = 1; step <= frames.steps; ++step) {
    simulation.step(frames.time_step);
    if (step % frames.every == 0) write_frame(file.get(), simulation);
  }
}

void run(std::string_view scene, const State& state, const char* law_text, const Frames& frames) {
  using namespace silt;
  const auto grains = grains_of<3>(state, 0);
  if (scene == "jkr") {
    run(Simulation{grains, NeighbourList<3>{}, dem::Contacts{jkr_of(law_text)}, Leapfrog{}},
        frames);
    return;
  }
  const HookeHistory law = law_of(law_text);
  const auto settings = settings_for<HookeHistory>();
  if (scene == "clump") {
    dem::ClumpGrains<3> spheres;
    dem::Clumps<3> clumps;
    for (const auto some : {std::span(state.bodies).first(3), std::span(state.bodies).last(3)}) {
      const dem::ClumpShape<3> shape = shape_of(some);
      const Vec3& centre = shape.mass_properties().centre;
      clumps.add(spheres, shape,
                 {.position = centre,
                  .velocity = some[0].v + cross(some[0].w, Vec3(centre - some[0].x)),
                  .spin = some[0].w});
    }
    run(Simulation{spheres, NeighbourList<3>{}, dem::Contacts{law}.with(settings),
                   dem::ClumpLeapfrog{clumps}},
        frames);
    return;
  }
  if (scene == "pair") {
    run(Simulation{grains, NeighbourList<3>{}, dem::Contacts{law}.with(settings),
                   Leapfrog{}},
        frames);
  } else {
    run(Simulation{grains, NeighbourList<3>{},
                   Forces{Gravity<3>{{0, 0, -1}},
                          dem::Contacts{law, dem::Plane<3>{}}.with(settings)},
                   Leapfrog{}},
        frames);
  }
}

}  // namespace

int main(int argc, char** argv) try {
  const std::string_view what = argc > 2 ? argv[1] : "";
  const std::string_view scene = argc > 2 ? argv[2] : "";
  const std::map<std::string_view, State (*)()> states{
      {"clump", two_clumps}, {"collapse", block}, {"jkr", sticky_pair}, {"pair", pair}};
  const bool known = states.contains(scene);
  if (what == "make" && known && argc == 4) {
    write(states.at(scene)(), argv[3]);
    return 0;
  }
  if (what == "run" && known && argc == 9) {
    run(scene, read(argv[3]), argv[4],
        {.time_step = std::atof(argv[5]),
         .steps = std::atoi(argv[6]),
         .every = std::atoi(argv[7]),
         .path = argv[8]});
    return 0;
  }
  std::fprintf(stderr, "usage: see the beginning of silt_beside_lammps.cpp\n");
  return 2;
} catch (const std::exception& error) {
  std::fprintf(stderr, "silt_beside_lammps: %s\n", error.what());
  return 1;
}
