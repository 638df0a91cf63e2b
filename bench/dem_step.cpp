// SPDX-License-Identifier: MIT
// Whole DEM steps: dem_step/<scene>/<grains>, with the scenes of scenes.hpp and Silt's own law, on
// all OpenMP threads. The bed has a larger size than the others, for the scaling exponent. And
// steps of a lattice at rest: dem_step/lattice without further grains, dem_step/rain with one more
// in each.
#include "program.hpp"
#include "states.hpp"
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <numbers>
#include <string>

namespace {

using namespace bench;

// A flow changes with time, so the number of steps is fixed.
std::int64_t steps_of(std::int64_t grains) {
  return grains <= 4000 ? 2000 : grains <= 32000 ? 300 : grains <= 256000 ? 40 : 10;
}

template <Scene scene>
auto warm_simulation(Index n) {
  auto simulation = [n] {
    if constexpr (scene == Scene::gas) {
      return in_space(state_of(scene, n), cundall_strack());
    } else if constexpr (scene == Scene::discs) {
      return on_floor<2>(state_of(scene, n), scene, cundall_strack());
    } else {
      return on_floor(state_of(scene, n), scene, cundall_strack());
    }
  }();
  for (int step = 0; step < 200; ++step) simulation.step(time_step);
  return simulation;
}

template <Scene scene>
void step(benchmark::State& state) {
  // Called by Google Benchmark for every repetition; all start from the same state.
  static std::map<std::int64_t, decltype(warm_simulation<scene>(0))> warm;
  const std::int64_t n = state.range(0);
  if (!warm.contains(n)) {
    warm.clear();
    warm.emplace(n, warm_simulation<scene>(static_cast<Index>(n)));
  }
  auto simulation = warm.at(n);
  simulation.step(time_step);  // allocates memory, because this is a copy
  const auto rebuilds = simulation.search().rebuilds();
  for (auto _ : state) simulation.step(time_step);

  const auto& contacts = contacts_of(simulation.interaction());
  Index pairs = 0;
  contacts.for_each_contact(simulation.particles(), [&](Index, Index j, const auto&, const auto&) {
    pairs += static_cast<Index>(j != silt::no_index);
  });
  state.SetItemsProcessed(state.iterations() * n);
  state.SetComplexityN(n);
  state.counters["contacts"] = 2 * double(pairs) / double(n);
  state.counters["rebuilds"] = double(simulation.search().rebuilds() - rebuilds);
  state.counters["threads"] = silt::threads();
}

// `grains` is a cube number. An inflow above the lattice, if there is one, adds a grain in each
// step.
template <bool rains>
void step_of_lattice(benchmark::State& state) {
  using namespace silt;
  const double edge = 1.02 * std::cbrt(double(state.range(0)));
  auto grains = dem::make_grains(lattice<3>({{0, 0, 0}, {edge, edge, edge}}, 1.02),
                                 {.radius = 0.5, .density = 6 / std::numbers::pi});
  Simulation simulation{grains, NeighbourList<3>{},
                        dem::Contacts{cundall_strack(), dem::Plane<3>{}}, Leapfrog{}};
  for (int step = 0; step < 20; ++step) simulation.step(time_step);
  dem::Inflow inflow{Box<3>{.lower = {0, 0, 1.1 * edge}, .upper = {edge, edge, 3 * edge}},
                     dem::Blend<dem::EqualSizes>{.sizes = {0.5}, .density = 6 / std::numbers::pi},
                     {.number = 1000000, .rate = 1 / time_step, .from = simulation.time()}};
  const auto rebuilds = simulation.search().rebuilds();
  for (auto _ : state) {
    if (rains) inflow.before_step(simulation);
    simulation.step(time_step);
  }
  state.counters["added"] = double(inflow.number());
  state.counters["rebuilds"] = double(simulation.search().rebuilds() - rebuilds);
  state.counters["threads"] = threads();
}

void add_lattice(const char* name, void (*run)(benchmark::State&)) {
  benchmark::RegisterBenchmark(name, run)
      ->Arg(97336)
      ->Iterations(200)
      ->Repetitions(3)
      ->Unit(benchmark::kMicrosecond)
      ->UseRealTime();
}

template <Scene scene>
void add(std::initializer_list<std::int64_t> sizes) {
  const std::string name = "dem_step/" + name_of(scene);
  for (const std::int64_t n : sizes) {
    benchmark::RegisterBenchmark(name.c_str(), step<scene>)
        ->Arg(n)->Iterations(steps_of(n))->Repetitions(3)
        ->Unit(benchmark::kMicrosecond)->UseRealTime();
  }
}

}  // namespace

int main(int argc, char** argv) {
  add<Scene::bed>({4000, 32000, 256000, 1024000});
  add<Scene::gas>({4000, 32000, 256000});
  add<Scene::chute>({4000, 32000, 256000});
  add<Scene::discs>({20000});
  add_lattice("dem_step/lattice", step_of_lattice<false>);
  add_lattice("dem_step/rain", step_of_lattice<true>);
  return bench::run(argc, argv);
}
