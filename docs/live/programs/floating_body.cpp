// SPDX-License-Identifier: MIT
// A box floats in a tank, and rights itself or turns over. Writes floating_body.pvd, for ParaView.
#include <silt/core/rotation.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>
#include <silt/mps/setup/remove_inside.hpp>
#include <silt/mps/wall/moving_walls.hpp>

#include <cmath>
#include <cstdio>

int main() try {
  using namespace silt;
  constexpr double spacing = 0.025;      // of the particles [m]
  constexpr double width = 0.3;          // of the box [m]
  constexpr double height = 0.2;         // of the box [m]
  constexpr double density_ratio = 0.5;  // of the box, to the water [-]
  constexpr double turn = 0.5;           // of the box at first [rad]

  auto tank = mps::make_tank<mps::Recommended, 2>(
      {.column = {spacing * std::round(1.6 / spacing), spacing * std::round(0.5 / spacing)},
       .size = {.length = spacing * std::round(1.6 / spacing), .height = 1.2},
       .spacing = spacing,
       .lid = true});
  const Vec<2> centre{0.8, 0.5 + height * (0.5 - density_ratio)};
  auto box = faces_of(Box<2>{{-width / 2, -height / 2}, {width / 2, height / 2}});
  for (auto& face : box) {
    for (auto& corner : face.corners) corner = centre + rotation_by(turn) * corner;
  }
  mps::remove_inside(tank.particles, box, spacing);
  tank.walls.moving_2d =
      mps::MovingWalls<2>{.bodies = {{.faces = box, .density = 1000 * density_ratio}}};
  const mps::Flow<mps::Recommended> water{{.spacing = spacing,
                                           .density = 1000,
                                           .viscosity = 1e-6,
                                           .speed_scale = std::sqrt(9.81 * 0.5),
                                           .walls = tank.walls}};

  Simulation floats{tank.particles, UniformGrid<2>{}, water, SemiImplicit<>{}};
  floats.run({.until = 2, .output_every = 0.02}, VtkSeries{"floating_body"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
