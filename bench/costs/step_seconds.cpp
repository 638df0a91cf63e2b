// SPDX-License-Identifier: MIT
// One case of bench/promise_costs.py: step_seconds CASE prints the seconds of a step. With
// SILT_BENCH_UNWATCHED defined, what a step did is not checked.
#include "../states.hpp"

#include <silt/mps.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string_view>

namespace {

using namespace bench;

#ifdef SILT_BENCH_UNWATCHED
template <class Interaction>
struct Unwatched : Interaction {
  template <class P>
  using For = Unwatched;
  void check_step(const auto&, const silt::FinishedStep&) const {}
};
#else
template <class Interaction>
using Unwatched = Interaction;
#endif

template <class Made, class Step>
double seconds_of_step(Made made, Step&& step, int steps) {
  auto [particles, interaction] = made.state();
  silt::Simulation simulation{particles, made.search(),
                              Unwatched<decltype(interaction)>{interaction}, made.integrator()};
  for (int k = 0; k < 50; ++k) step(simulation);
  const auto began = std::chrono::steady_clock::now();
  for (int k = 0; k < steps; ++k) step(simulation);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - began;
  return seconds.count() / steps;
}

double seconds_of_dam() {
  using namespace silt;
  constexpr double width = 0.4, l0 = width / 80;
  auto tank = mps::make_tank<2>(
      {.column = {width, 2 * width}, .size = {.length = 1.6, .height = 1.2}, .spacing = l0});
  mps::Flow<mps::Case10, 2> water{{.spacing = l0,
                                   .radius = 3.1,
                                   .laplacian_radius = 3.1,
                                   .speed_scale = std::sqrt(9.81 * 2 * width)}};
  return seconds_of_step(Simulation{std::move(tank), UniformGrid<2>{}, water, SemiImplicit<>{}},
                         [](auto& dam) { dam.step(); }, 60);
}

double seconds_of(std::string_view name) {
  const auto step = [](auto& simulation) { simulation.step(time_step); };
  if (name == "bed") {
    const State state = state_of(Scene::bed, 32000);
    return seconds_of_step(on_floor(state, Scene::bed, cundall_strack()), step, 300);
  }
  if (name == "gas") {
    return seconds_of_step(in_space(state_of(Scene::gas, 32000), cundall_strack()), step, 600);
  }
  if (name == "dam") return seconds_of_dam();
  throw std::runtime_error("step_seconds: no case " + std::string(name));
}

}  // namespace

int main(int argc, char** argv) try {
  std::printf("%.6g\n", seconds_of(argc == 2 ? argv[1] : ""));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
