// SPDX-License-Identifier: MIT
// Whole MPS steps: mps_step/<dimension>/<fluid particles> advances a dam break with case 10 and the
// pressure solved to 1e-6, on all OpenMP threads, mps_step/recommended/<dimension> the same with
// mps::Recommended. The column of water is 0.4 m wide and 0.8 m high, the tank 1.6 m long and 1.2 m
// high, for case 10 with one layer of wall particles and four of dummy particles.
//
//   2d/3200    spacing 10 mm      2d/51200   2.5 mm      radii of 3.1 spacings
//   3d/102400  spacing 10 mm: the tank of 2d/3200, 32 spacings deep, with wall and dummy particles
//              also at the front and the back (380 500 particles in all); radii of 2.1 spacings, as
//              usual in 3D
//
// The time of a step has four parts: search_ms (cells and neighbour lists), assembly_ms (of the
// pressure equation, with the divergence), solve_ms (with its setup), and operators_ms, the rest.
#include <silt/measure/timed.hpp>
#include <silt/mps.hpp>

#include <benchmark/benchmark.h>

#include "program.hpp"

#include <cmath>
#include <cstdint>
#include <string>

namespace {

using namespace silt;

constexpr double width = 0.4;    // of the column [m]
constexpr int first_steps = 40;  // from rest to a flow, with an initial guess of the pressure

template <class Scheme, int Dim>
auto begin_dam_break(std::int64_t fluid) {
  // Twice as high as wide and, in 3D, 4/5 as deep.
  const double per_width = Dim == 2 ? std::sqrt(double(fluid) / 2) : std::cbrt(double(fluid) / 1.6);
  const double l0 = width / std::round(per_width);
  const double radius = Dim == 2 ? 3.1 : 2.1;
  auto tank = mps::make_tank<Scheme, Dim>(
      {.column = {width, 2 * width},
       .size = {.length = 1.6, .height = 1.2, .depth = 0.8 * width},
       .spacing = l0});
  const mps::Flow<Scheme, Dim> water{{.spacing = l0,
                                      .radius = radius,
                                      .laplacian_radius = radius,
                                      .speed_scale = std::sqrt(9.81 * 2 * width),
                                      .walls = tank.walls}};
  Simulation dam{std::move(tank.particles), TimedSearch{UniformGrid<Dim>{}}, water, SemiImplicit<>{}};
  for (int k = 0; k < first_steps; ++k) dam.step();
  return dam;
}

template <class Scheme, int Dim>
void step(benchmark::State& state) {
  auto dam = begin_dam_break<Scheme, Dim>(state.range(0));
  const auto& flow = dam.interaction();
  const mps::FlowSeconds before = flow.seconds();
  const double update_before = dam.search().seconds();
  const double time_before = dam.time();
  double iterations = 0;
  Stopwatch watch;
  for (auto _ : state) {
    const auto span = watch.start();
    dam.step();
    iterations += flow.last_solve().iterations;
  }
  const mps::FlowSeconds& after = flow.seconds();
  const double search =
      dam.search().seconds() - update_before + after.neighbours - before.neighbours;
  const double assembly = after.assembly - before.assembly;
  const double solve = after.solve - before.solve;
  const auto steps = double(state.iterations());
  state.SetItemsProcessed(state.iterations() * state.range(0));
  state.SetComplexityN(state.range(0));
  state.counters["search_ms"] = 1e3 * search / steps;
  state.counters["operators_ms"] = 1e3 * (watch.seconds() - search - assembly - solve) / steps;
  state.counters["assembly_ms"] = 1e3 * assembly / steps;
  state.counters["solve_ms"] = 1e3 * solve / steps;
  state.counters["iterations"] = iterations / steps;
  state.counters["unknowns"] = double(flow.last_solve().unknowns);
  state.counters["wall_s_per_s"] = watch.seconds() / (dam.time() - time_before);
  state.counters["threads"] = threads();
}

template <class Scheme, int Dim>
void add(const std::string& of_scheme, std::int64_t fluid, std::int64_t steps) {
  const std::string name = "mps_step/" + of_scheme + std::to_string(Dim) + "d";
  // The flow changes with time, so the number of steps is fixed.
  benchmark::RegisterBenchmark(name.c_str(), step<Scheme, Dim>)
      ->Arg(fluid)->Iterations(steps)->Unit(benchmark::kMillisecond)->UseRealTime();
}

}  // namespace

int main(int argc, char** argv) {
  add<mps::Case10, 2>("", 3200, 200);
  add<mps::Case10, 2>("", 12800, 100);
  add<mps::Case10, 2>("", 51200, 40);
  add<mps::Case10, 2>("", 204800, 10);
  add<mps::Case10, 3>("", 12800, 40);
  add<mps::Case10, 3>("", 102400, 10);
  add<mps::Recommended, 2>("recommended/", 3200, 200);
  add<mps::Recommended, 2>("recommended/", 12800, 100);
  add<mps::Recommended, 2>("recommended/", 51200, 40);
  add<mps::Recommended, 3>("recommended/", 12800, 40);
  add<mps::Recommended, 3>("recommended/", 102400, 10);
  return bench::run(argc, argv);
}
