// SPDX-License-Identifier: MIT
// A piston makes waves, which run up a beach. Writes wave_maker.pvd, for ParaView.
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <cmath>
#include <cstdio>
#include <numbers>

int main() try {
  using namespace silt;
  constexpr double spacing = 0.02;   // of the particles [m]
  constexpr double depth = 0.24;     // of the water [m]
  constexpr double stroke = 0.08;    // whole way of the piston [m]
  constexpr double frequency = 1.1;  // of the piston [Hz]

  auto tank = mps::make_empty_tank<mps::Recommended, 2>(
      {.size = {.length = 2, .height = 0.6}, .spacing = spacing, .lid = true});
  const Vec<2> foot{1.2, 0}, top{2, 0.6};  // of the beach
  const double slope = (top[1] - foot[1]) / (top[0] - foot[0]);
  tank.walls.segments.push_back({{foot, top}});
  // The piston begins at rest, at the foremost place of its way.
  const double foremost = spacing * std::round(0.2 / spacing), X = foremost - stroke / 2;
  const Vibration<2> harmonic{
      .amplitude = {stroke / 2, 0}, .frequency = frequency, .phase = std::numbers::pi / 2};
  tank.walls.moving_2d =
      mps::MovingWalls<2>{.faces = {{.faces = polyline({{X, 0.6}, {X, 0}}), .motion = harmonic}}};

  const double whole_depth = spacing * std::round(depth / spacing);
  for (const auto& x : lattice<2>({{foremost, 0}, {2, whole_depth}}, spacing)) {
    // Half a spacing from the beach.
    const double above = x[1] - slope * (x[0] - foot[0]);
    if (above < 0.45 * spacing * std::hypot(1.0, slope)) continue;
    mps::add_particle(tank.particles, x, mps::Kind::fluid);
  }
  const mps::Flow<mps::Recommended> water{{.spacing = spacing,
                                           .density = 1000,
                                           .viscosity = 1e-6,
                                           .speed_scale = std::sqrt(9.81 * depth),
                                           .walls = tank.walls}};

  Simulation waves{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  waves.run({.until = 3, .output_every = 0.02}, VtkSeries{"wave_maker"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
