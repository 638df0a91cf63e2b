// SPDX-License-Identifier: MIT
// Memory of a simulation, and allocations in later steps: memory/<what>/<particles>.
//   bytes         on the heap after some steps, per particle
//   peak          maximum resident memory of the process meanwhile, per particle
//   allocations   in another 100 (dem) or 10 (mps) steps
// held/<what>/<particles>: what of it is held at the peak, by name, per particle.
#include "../tests/support/allocations.hpp"
#include "held_memory.hpp"
#include "program.hpp"
#include "states.hpp"

#include <silt/mps.hpp>

#include <benchmark/benchmark.h>

#include <malloc.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>

namespace {

using namespace bench;

double bytes_on_heap() {
  const auto info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
}

// Resident memory now ("VmRSS") or its maximum since the last reset ("VmHWM") [bytes].
double pages(const std::string& which) {
  std::ifstream status("/proc/self/status");
  std::string word;
  double kilobytes = 0;
  while (status >> word && word != which + ":") {}
  status >> kilobytes;
  return 1024 * kilobytes;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << 5; }

// Creates a simulation with make() and advances it with step().
template <class Make, class Step>
void measure(benchmark::State& state, Make&& make, Step&& step, int warm, int further) {
  for (auto _ : state) {
    malloc_trim(0);
    const double heap_before = bytes_on_heap();
    const double pages_before = pages("VmRSS");
    reset_peak();
    auto simulation = make();
    for (int k = 0; k < warm; ++k) step(simulation);
    const double n = double(simulation.particles().size());
    state.counters["bytes"] = (bytes_on_heap() - heap_before) / n;
    state.counters["peak"] = (pages("VmHWM") - pages_before) / n;
    state.counters["particles"] = n;
    const std::uint64_t before = silt::test::allocations;
    for (int k = 0; k < further; ++k) step(simulation);
    state.counters["allocations"] = double(silt::test::allocations - before);
  }
}

constexpr int grain_steps = 500;

template <Scene scene>
auto grains_in(const State& state) {
  if constexpr (scene == Scene::gas) {
    return in_space(state, cundall_strack());
  } else {
    return on_floor(state, scene, cundall_strack());
  }
}

template <Scene scene>
void dem(benchmark::State& state) {
  const auto n = static_cast<Index>(state.range(0));
  measure(
      state, [n] { return grains_in<scene>(state_of(scene, n)); },
      [](auto& simulation) { simulation.step(time_step); }, grain_steps, 100);
}

template <Scene scene>
void held(benchmark::State& state) {
  const auto n = static_cast<Index>(state.range(0));
  const State initial = state_of(scene, n);
  for (auto _ : state) {
    HeldMemory memory;
    auto simulation = grains_in<scene>(initial);
    for (int k = 0; k < grain_steps; ++k) simulation.step(time_step);
    for (const auto& [name, bytes] : memory.at_peak()) {
      state.counters[name] = bytes / double(n);
    }
  }
}

// The dam breaks of mps_step.cpp.
template <int Dim>
void mps(benchmark::State& state) {
  using namespace silt;
  const double fluid = double(state.range(0));
  const double l0 = 0.4 / std::round(Dim == 2 ? std::sqrt(fluid / 2) : std::cbrt(fluid / 1.6));
  const double radius = Dim == 2 ? 3.1 : 2.1;
  measure(
      state,
      [=] {
        auto tank = mps::make_tank<Dim>({.column = {0.4, 0.8},
                                         .size = {.length = 1.6, .height = 1.2, .depth = 0.32},
                                         .spacing = l0});
        const mps::Flow<mps::Case10, Dim> water{{.spacing = l0,
                                                 .radius = radius,
                                                 .laplacian_radius = radius,
                                                 .speed_scale = std::sqrt(9.81 * 0.8)}};
        return Simulation{std::move(tank), UniformGrid<Dim>{}, water, SemiImplicit<>{}};
      },
      [](auto& simulation) { simulation.step(); }, 20, 10);
}

void add(const char* name, void (*function)(benchmark::State&), std::int64_t n) {
  benchmark::RegisterBenchmark(name, function)->Arg(n)->Iterations(1);
}

}  // namespace

int main(int argc, char** argv) {
  add("memory/dem_bed", dem<Scene::bed>, 32000);
  add("memory/dem_gas", dem<Scene::gas>, 32000);
  add("memory/dem_chute", dem<Scene::chute>, 32000);
  add("held/bed", held<Scene::bed>, 32000);
  add("held/gas", held<Scene::gas>, 32000);
  add("held/chute", held<Scene::chute>, 32000);
  add("memory/mps_2d", mps<2>, 51200);
  add("memory/mps_3d", mps<3>, 102400);
  return bench::run(argc, argv);
}
