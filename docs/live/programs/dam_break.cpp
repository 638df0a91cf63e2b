// SPDX-License-Identifier: MIT
// A column of water collapses in a closed tank. Writes dam_break.pvd, for ParaView.
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>

#include <cmath>
#include <cstdio>

int main() try {
  using namespace silt;
  constexpr double spacing = 0.028;   // of the particles [m]
  constexpr double width = 0.4;       // of the column [m]
  constexpr double height = 0.8;      // of the column [m]
  constexpr double viscosity = 1e-6;  // kinematic [m²/s]

  // A column is a whole number of particles wide and high.
  const auto whole = [](double size) { return spacing * std::round(size / spacing); };
  const auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {whole(width), whole(height)},
       .size = {.length = 1.6, .height = 1.2},
       .spacing = spacing,
       .lid = true});
  const mps::Flow<mps::Recommended> water{{.spacing = spacing,
                                           .density = 1000,
                                           .viscosity = viscosity,
                                           .speed_scale = std::sqrt(9.81 * height),
                                           .walls = tank.walls}};

  Simulation dam{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  dam.run({.until = 1, .output_every = 0.02}, VtkSeries{"dam_break"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
