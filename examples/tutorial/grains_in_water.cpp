// SPDX-License-Identifier: MIT
// Grains fall into water.
#include <silt/coupled.hpp>
#include <silt/dem/wall/box_wall.hpp>
#include <silt/io/vtk.hpp>

#include <cstdio>

int main() {
  using namespace silt;
  constexpr double l0 = 0.02, d = 0.012;  // spacing of the water, diameter of the grains [m]
  const Box<3> tank{{0, 0, 0}, {0.48, 0.08, 0.6}};

  // One simulation is of grains. The last force on them is that of the water.
  coupled::GrainsInFluid<3> grains{tank};
  for (const auto& x : lattice<3>({{0.16, 0, 0.2}, {0.32, 0.08, 0.4}}, 0.0133)) {
    dem::add_grain(grains, x, {.radius = d / 2, .density = 2500});
  }
  const dem::CundallStrack law{
      .normal_stiffness = 2e3, .tangential_stiffness = 1e3, .friction_angle = 0.5};
  const Forces forces{Gravity<3>{{0, 0, -9.81}}, dem::Contacts{law, dem::BoxWall<3>{tank}},
                      coupled::FluidForces{coupled::DiFelice{}}};

  // The other is of water, between the same walls.
  mps::FluidInMixture<3> fluid{tank};
  for (const auto& x : lattice<3>({{0, 0, 0}, {0.48, 0.08, 0.16}}, l0)) {
    mps::add_particle(fluid, x, mps::Kind::fluid);
  }
  const mps::ImageWalls walls{.triangles = faces_of(tank, Sides<3>::open())};
  const mps::Flow<mps::InMixture<>, 3> water{{.spacing = l0, .speed_scale = 2, .walls = walls}};

  coupled::Coupled both{Simulation{grains, NeighbourList<3>{}, forces, Leapfrog{}},
                        Simulation{fluid, UniformGrid<3>{}, water, SemiImplicit<>{}}};
  both.run({.until = 0.6, .output_every = 0.2}, VtkSeries{"rain"}, [&](const auto& now) {
    double of_grains = 0, of_water = 0;  // sums of heights [m]
    for (const auto& x : now.grains().particles()[position]) of_grains += x[2];
    for (const auto& x : now.fluid().particles()[position]) of_water += x[2];
    std::printf("%.1f s: mean height of the grains %.3f m, of the water %.3f m\n", now.time(),
                of_grains / double(grains.size()), of_water / double(fluid.size()));
  });
}
