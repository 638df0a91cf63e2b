// SPDX-License-Identifier: MIT
// A column of water collapses: the whole program. Open dam.pvd with ParaView.
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>
#include <silt/mps.hpp>

int main() {
  using namespace silt;
  constexpr double l0 = 0.02;  // particle spacing [m]
  auto tank = mps::make_tank<2>(
      {.column = {0.4, 0.8}, .size = {.length = 1.6, .height = 1.2}, .spacing = l0});
  mps::Flow<mps::Case10> water{{.spacing = l0, .viscosity = 1e-6, .speed_scale = 2.8}};
  Simulation dam{tank, NeighbourList<2>{}, water, SemiImplicit<>{}};
  dam.run({.until = 1.0, .output_every = 0.02}, VtkSeries{"dam"}, Progress{});
}
