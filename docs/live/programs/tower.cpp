// SPDX-License-Identifier: MIT
// A tower of discs collapses. Writes tower.pvd, for ParaView.
#include <silt/dem.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>

#include <cstdio>

int main() try {
  using namespace silt;
  constexpr double R = 0.0125;             // radius of a grain [m]
  constexpr double friction_angle = 0.46;  // of grains and walls [rad]
  constexpr double restitution = 0.5;      // coefficient [-]
  constexpr double alpha = 0.5;            // global damping [1/s]

  auto grains = dem::make_grains(lattice<2>({{-0.1, 0}, {0.1, 0.8}}, 2 * R),
                                 {.radius = R, .density = 2500});
  dem::add_grain(grains, {0.3 * R, 0.8 + 2 * R}, {.radius = R, .density = 2500});

  const dem::CundallStrack law{.normal_stiffness = 2e6, .tangential_stiffness = 1e6,
                               .restitution = restitution, .friction_angle = friction_angle};
  const dem::BoxWall<2> room{{.lower = {-0.8, 0}, .upper = {0.8, 1.2}}};

  Simulation tower{grains, NeighbourList<2>{},
                   Forces{Gravity<2>{{0, -9.81}},
                          dem::Contacts{law, room}.with({.steps_per_contact = 20})},
                   Leapfrog{GlobalDamping{.alpha = alpha}}};
  tower.run({.until = 1.5, .output_every = 0.02}, VtkSeries{"tower"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
