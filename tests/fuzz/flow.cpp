// SPDX-License-Identifier: MIT
// Fuzz target: an input is a tank of fluid, the settings of its flow and a sequence of calls, with
// numbers that they may not expect. A call that throws silt::Error changes nothing, and the next
// one follows.
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/image_walls.hpp>

#include "fuzz/target.hpp"
#include "support/checkpoint_bytes.hpp"
#include "support/restart.hpp"

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace {

using namespace silt;
using fuzz::Choices;

constexpr double l0 = 0.02;  // usual spacing [m]

// Others are refused: a column, and with wall particles a tank, of whole spacings.
mps::Tank<2> any_tank(Choices& choices, bool has_wall_particles) {
  mps::Tank<2> tank{
      .column = choices.vector<2>({3 * l0, 3 * l0}),
      .size = {.length = choices.number(4 * l0), .height = choices.number(4 * l0)},
      .spacing = choices.number(l0),
      .dummy_layers = static_cast<int>(std::min<Index>(choices.count(3), 1000)) - 1,
      .lid = choices.flag(),
      .on_escape = choices.flag() ? OnEscape::remove : OnEscape::refuse};
  const auto make_whole = [&](double& length) {
    length = tank.spacing * std::round(length / tank.spacing);
  };
  make_whole(tank.column[0]), make_whole(tank.column[1]);
  if (has_wall_particles) make_whole(tank.size.length), make_whole(tank.size.height);
  return tank;
}

std::vector<Face<2>> any_walls(Choices& choices) {
  const Vec<2> first = choices.vector<2>({0, 4 * l0}), second = choices.vector<2>({0, 0}),
               third = choices.vector<2>({4 * l0, 0}), fourth = choices.vector<2>({4 * l0, 4 * l0});
  return polyline({first, second, third, fourth});
}

// A tank that is not refused, but takes long.
bool is_large(const mps::Tank<2>& tank) {
  const double layers = 2.0 * (1 + tank.dummy_layers);
  const double cells = (std::round(tank.size.length / tank.spacing) + layers) *
                       (std::round(tank.size.height / tank.spacing) + layers);
  return cells > 500 && cells <= 1e9;
}

template <class Scheme>
mps::FlowSettings<2, Scheme> any_settings(Choices& choices) {
  return {.spacing = choices.number(l0),
          .density = choices.number(1000),
          .viscosity = choices.number(1e-6),
          .gravity = choices.vector<2>({0, -9.81}),
          .radius = choices.number(3.1),
          .laplacian_radius = choices.number(3.1),
          .courant = choices.number(0.2),
          .speed_scale = choices.number(0),
          .max_growth = choices.number(1.2),
          .max_time_step = choices.number(1e-3),
          .clip_negative_pressure = choices.byte() < 128};
}

template <class Sim>
void call(Choices& choices, Sim& simulation) {
  auto& particles = simulation.particles();
  switch (choices.below(6)) {
    case 0:
    case 1:
      return simulation.step();
    case 2:
      return simulation.step(choices.number(1e-3));
    case 3: {
      if (particles.empty()) return;
      const Index i = choices.raw<std::uint16_t>() % particles.size();
      const int k = static_cast<int>(choices.below(2));
      if (choices.flag()) {
        particles[velocity][i][k] = choices.number(1);
      } else {
        particles[position][i][k] = choices.number(particles[position][i][k]);
      }
      return;
    }
    case 4:
      return particles.remove(choices.count(0));
    default: {
      const std::string text = test::written(test::RunWith{simulation});
      checkpoint::restore({.file = "file"}, text, simulation);
    }
  }
}

template <class Scheme>
void flow(Choices& choices) {
  constexpr bool has_faces = std::same_as<Scheme, mps::Recommended>;
  const auto tank = any_tank(choices, !has_faces);
  if (is_large(tank)) return;
  const auto made = mps::make_tank<Scheme>(tank);
  auto settings = any_settings<Scheme>(choices);
  if constexpr (has_faces) {
    settings.walls.segments = any_walls(choices);
    settings.walls.let_fluid_fall = tank.lid;
  }
  Simulation simulation{made.particles, UniformGrid<2>{}, mps::Flow<Scheme>(settings), SemiImplicit{}};
  for (int calls = 0; calls < 10; ++calls) {
    const double time = simulation.time();
    if (!fuzz::accepts([&] { call(choices, simulation); })) {
      fuzz::require(simulation.time() == time, "a step that failed changes the time");
      continue;
    }
    if (!(simulation.time() > time)) continue;
    const auto& particles = simulation.particles();
    for (Index i = 0; i < particles.size(); ++i) {
      fuzz::require(is_finite(particles[position][i]) && is_finite(particles[velocity][i]),
                    "a step succeeds with a result that is not finite");
    }
  }
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Choices choices(data, size);
  fuzz::accepts([&] {
    switch (choices.below(4)) {
      case 0:
        return flow<mps::RecommendedForWallParticles>(choices);
      case 2:
        return flow<mps::Recommended>(choices);
      default:
        return flow<mps::Case00>(choices);
    }
  });
  return 0;
}
