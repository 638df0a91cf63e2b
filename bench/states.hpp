// SPDX-License-Identifier: MIT
// Initial states of the scenes. Each is computed once and kept in a file that LAMMPS also reads: a
// tile of 4000 (1250) grains, repeated along the periodic axes, with random velocities added and in
// random order, so that each code has to sort the grains in memory by itself.
#pragma once

#include "scenes.hpp"

#include <silt/dem.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#ifndef SILT_BENCH_STATES
#define SILT_BENCH_STATES "out/bench/states"
#endif

namespace bench {

constexpr Index tile_size(Scene scene) { return scene == Scene::discs ? 1250 : 4000; }

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  double uniform() { return std::ldexp(double(engine_() >> 11), -53); }
  Vec3 in_cube() { return {uniform(), uniform(), uniform()}; }
  /// Each component of standard deviation 1.
  Vec3 normal() {
    Vec3 sum = Vec3::Constant(-6);
    for (int k = 0; k < 12; ++k) sum += in_cube();
    return sum;
  }
  Index below(Index n) { return static_cast<Index>(uniform() * double(n)); }

 private:
  std::mt19937_64 engine_;
};

/// Steps until the mean kinetic energy of a grain is below `energy`, at most `max_steps` times.
template <class Simulation>
void settle(Simulation& bed, double dt, double energy, int max_steps) {
  for (int step = 0; step < max_steps; ++step) {
    bed.step(dt);
    if (step % 500 != 0) continue;
    double sum = 0;
    for (const auto& v : bed.particles()[silt::velocity]) sum += v.squaredNorm() / 2;
    if (sum / double(bed.particles().size()) < energy) return;
  }
}

// Disordered grains fall onto a floor of 14 × 14 (25).
template <int Dim>
State settled_tile(Scene scene) {
  Random random(2011);
  const double side = Dim == 2 ? 25 : 14;
  const double spacing = side / std::floor(side / 1.15);
  State state{.bodies = {}, .lower = {0, 0, 0}, .upper = {side, Dim == 2 ? 1 : side, 4 * side}};
  for (const Vec3& x : silt::lattice<3>(
           {state.lower, {side, Dim == 2 ? spacing : side, 4 * side}}, spacing)) {
    if (state.bodies.size() == tile_size(scene)) break;
    const Vec3 shift = 0.08 * (random.in_cube() - Vec3::Constant(0.5));
    state.bodies.push_back({.x = x + shift, .v = random.normal()});
  }
  auto falling = on_floor<Dim>(state, scene, hooke_history, silt::GlobalDamping{.alpha = 0.2});
  settle(falling, 2 * time_step, 1e-3, 60000);
  state.bodies = bodies_of(falling.particles());
  auto resting = on_floor<Dim>(state, scene, hooke_history, silt::GlobalDamping{.alpha = 3});
  settle(resting, 2 * time_step, 1e-8, 40000);
  state.bodies = bodies_of(resting.snapshot());
  return state;
}

// The settled tile is set in motion, and runs until the flow is developed.
inline State flowing_tile(State state) {
  Random random(26);
  for (Body& body : state.bodies) body.v = 0.5 * random.normal() + Vec3(1 + body.x[2] / 2, 0, 0);
  auto flowing = on_floor(state, Scene::chute, hooke_history);
  for (int step = 0; step < 30000; ++step) flowing.step(time_step);
  state.bodies = bodies_of(flowing.snapshot());
  return state;
}

// 4000 grains placed at random in a cube, without contacts.
inline State gas_tile() {
  Random random(30);
  constexpr Index n = tile_size(Scene::gas);
  const double edge = std::cbrt(double(n) * std::numbers::pi / 6 / 0.3);
  State state{.bodies = {}, .lower = Vec3::Zero(), .upper = Vec3::Constant(edge)};
  while (state.bodies.size() < n) {
    const Vec3 x = edge * random.in_cube();
    const auto is_clear = [&](const Body& other) {
      Vec3 r = x - other.x;
      for (int k = 0; k < 3; ++k) r[k] -= edge * std::round(r[k] / edge);
      return r.squaredNorm() > 1.01;
    };
    if (std::all_of(state.bodies.begin(), state.bodies.end(), is_clear)) {
      state.bodies.push_back({.x = x});
    }
  }
  return state;
}

/// 2^k = `times` copies of the tile, along the periodic axes in turn, in random order. A random
/// velocity with standard deviation `push` is added to every grain.
inline State repeated(State state, Index times, int axes, double push) {
  for (int axis = 0; times > 1; axis = (axis + 1) % axes, times /= 2) {
    const double length = state.upper[axis] - state.lower[axis];
    const Index n = state.bodies.size();
    for (Index i = 0; i < n; ++i) {
      Body copy = state.bodies[i];
      copy.x[axis] += length;
      state.bodies.push_back(copy);
    }
    state.upper[axis] += length;
  }
  Random random(state.bodies.size());
  for (Body& body : state.bodies) body.v += push * random.normal();
  for (Index i = state.bodies.size(); i > 1; --i) {
    std::swap(state.bodies[i - 1], state.bodies[random.below(i)]);
  }
  return state;
}

// --- files ---------------------------------------------------------------------------------------

/// Writes a file for LAMMPS's read_data with atom_style sphere.
inline void write(const State& state, const std::filesystem::path& path) {
  std::filesystem::create_directories(path.parent_path());
  const auto unfinished = path.string() + ".part";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(unfinished.c_str(), "w"),
                                                             std::fclose);
  if (!file) throw std::runtime_error("bench: cannot write " + unfinished);
  std::FILE* const out = file.get();
  std::fprintf(out, "Spheres; one of diameter 1 has the mass 1\n\n%zu atoms\n1 atom types\n\n",
               state.bodies.size());
  for (int k = 0; k < 3; ++k) {
    const char axis = "xyz"[k];
    std::fprintf(out, "%.17g %.17g %clo %chi\n", state.lower[k], state.upper[k], axis, axis);
  }
  std::fprintf(out, "\nAtoms # sphere\n\n");
  Index id = 0;
  for (const auto& [x, v, w, diameter] : state.bodies) {
    std::fprintf(out, "%zu 1 %.17g %.17g %.17g %.17g %.17g\n", ++id, diameter, mass_density, x[0],
                 x[1], x[2]);
  }
  std::fprintf(out, "\nVelocities\n\n");
  id = 0;
  for (const auto& [x, v, w, diameter] : state.bodies) {
    std::fprintf(out, "%zu %.17g %.17g %.17g %.17g %.17g %.17g\n", ++id, v[0], v[1], v[2], w[0],
                 w[1], w[2]);
  }
  std::filesystem::rename(unfinished, path);
}

/// Reads a file of write().
inline State read(const std::filesystem::path& path) {
  std::ifstream file(path);
  State state;
  std::string word;
  std::getline(file, word);
  Index n = 0, id = 0;
  int types = 0;
  file >> n >> word >> types >> word >> word;
  for (int k = 0; k < 3; ++k) file >> state.lower[k] >> state.upper[k] >> word >> word;
  file >> word >> word >> word;
  double density = 0;
  state.bodies.resize(n);
  for (Body& body : state.bodies) {
    file >> id >> types >> body.diameter >> density >> body.x[0] >> body.x[1] >> body.x[2];
  }
  file >> word;
  for (Body& body : state.bodies) {
    file >> id;
    for (Vec3* vector : {&body.v, &body.w}) {
      for (double& component : *vector) file >> component;
    }
  }
  if (!file || n == 0) throw std::runtime_error("bench: cannot read " + path.string());
  return state;
}

inline std::filesystem::path file_of(Scene scene, Index n) {
  return std::filesystem::path(SILT_BENCH_STATES) /
         (name_of(scene) + "_" + std::to_string(n) + ".data");
}

inline State state_of(Scene scene, Index n);

inline State make_state(Scene scene, Index n) {
  if (n == 0) {
    return scene == Scene::gas     ? gas_tile()
           : scene == Scene::chute ? flowing_tile(state_of(Scene::bed, 0))
           : scene == Scene::discs ? settled_tile<2>(scene)
                                   : settled_tile<3>(scene);
  }
  const double push = scene == Scene::gas ? 3 : scene == Scene::chute ? 0.1 : 1e-3;
  return repeated(state_of(scene, 0), n / tile_size(scene), periodic_axes(scene), push);
}

/// The state with n grains in 2^k tiles, or for n = 0 the tile, from its file, which is created if
/// it does not exist.
inline State state_of(Scene scene, Index n) {
  const auto path = file_of(scene, n);
  if (!std::filesystem::exists(path)) write(make_state(scene, n), path);
  return read(path);
}

}  // namespace bench
