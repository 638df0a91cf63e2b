// SPDX-License-Identifier: MIT
// Whole steps of MPS: mps_step/<solver>/<dimension>/<spacings> advances a dam break under case 10, the
// column <spacings> wide and twice as high, on all threads that OpenMP gives.
#include <silt/mps.hpp>

#include <benchmark/benchmark.h>

#include "program.hpp"

#include <cmath>
#include <cstdint>
#include <string>

namespace {

using namespace silt;

constexpr double width = 0.4;    // of the column [m]
constexpr int first_steps = 10;  // from rest to a flow, with a pressure to start from

template <class Solver, int Dim>
auto begin_dam_break(int spacings) {
  const double l0 = width / spacings;
  auto tank = mps::make_tank<Dim>({.column = {width, 2 * width},
                                   .size = {.length = 4 * width, .height = 3 * width, .depth = width},
                                   .spacing = l0});
  const mps::Flow<mps::Case10, Dim, double, Solver> water{
      {.spacing = l0, .speed_scale = std::sqrt(9.81 * 2 * width)}};
  Simulation dam{std::move(tank), NeighbourList<Dim>{{.skin_fraction = 0}}, water, SemiImplicit<>{}};
  for (int k = 0; k < first_steps; ++k) dam.step();
  return dam;
}

template <class Solver, int Dim>
void step_dam(benchmark::State& state) {
  auto dam = begin_dam_break<Solver, Dim>(static_cast<int>(state.range(0)));
  double iterations = 0;
  for (auto _ : state) {
    dam.step();
    iterations += dam.interaction().last_solve().iterations;
  }
  const auto fluid = static_cast<std::int64_t>(count(dam.particles(), mps::Kind::fluid));
  const auto steps = double(state.iterations());
  state.SetItemsProcessed(state.iterations() * fluid);
  state.SetComplexityN(fluid);
  state.counters["fluid"] = double(fluid);
  state.counters["iterations"] = iterations / steps;
  state.counters["pressure_ms"] = 1e3 * dam.interaction().seconds_in_pressure() / double(dam.steps());
  state.counters["threads"] = threads();
}

template <class Solver, int Dim>
void add(const std::string& solver, std::int64_t finest) {
  const std::string name = "mps_step/" + solver + "/" + std::to_string(Dim) + "d";
  auto* benchmark = benchmark::RegisterBenchmark(name.c_str(), step_dam<Solver, Dim>);
  for (std::int64_t spacings = finest / 4; spacings <= finest; spacings *= 2) {
    benchmark->Arg(spacings);
  }
  // The flow changes as it goes: the same steps for everyone.
  benchmark->Iterations(20)->Complexity(benchmark::oN)->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  add<mps::PressureSolver<2>, 2>("multigrid", 80);
  add<ConjugateGradient<Jacobi>, 2>("jacobi", 80);
  add<mps::PressureSolver<3>, 3>("multigrid", 20);
  add<ConjugateGradient<Jacobi>, 3>("jacobi", 20);
  return bench::run(argc, argv);
}
