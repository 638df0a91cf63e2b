// SPDX-License-Identifier: MIT
// Discs settle in a hopper, then its lid opens. Writes hopper.pvd, for ParaView.
#include <silt/dem.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>

#include <cstdio>

int main() try {
  using namespace silt;
  constexpr double R = 0.0095;             // mean radius of the grains [m]
  constexpr double opening = 0.12;         // [m]
  constexpr double friction_angle = 0.46;  // of grains and walls [rad]
  constexpr double restitution = 0.5;      // coefficient [-]

  dem::Grains<2> grains;
  for (const auto& x : lattice<2>({{-0.28, 0.72}, {0.28, 1.04}}, 2.45 * R)) {
    Random random{.seed = 1, .id = grains.size()};
    dem::add_grain(grains, x, {.radius = R * random.uniform({0.8, 1.2}), .density = 2500});
  }
  const dem::CundallStrack law{.normal_stiffness = 1e6, .tangential_stiffness = 5e5,
                               .restitution = restitution, .friction_angle = friction_angle};
  const dem::Polyline<> left{{{-0.3, 1.2}, {-0.3, 0.7}, {-opening / 2, 0.4}}};
  const dem::Polyline<> right{{{0.3, 1.2}, {0.3, 0.7}, {opening / 2, 0.4}}};
  const dem::Polyline<> lid{{{-opening / 2, 0.4}, {opening / 2, 0.4}}};
  const dem::BoxWall<2> room{{.lower = {-0.8, 0}, .upper = {0.8, 1.2}}};

  Simulation hopper{grains, NeighbourList<2>{},
                    Forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, left, right, lid, room}.with(
                                                       {.steps_per_contact = 20})},
                    Leapfrog{}};
  VtkSeries frames{"hopper"};
  hopper.run({.until = 0.6, .output_every = 0.02}, frames, Progress{});
  hopper.interaction().part<1>().set_wall_present(2, false);
  hopper.run({.until = 2.5, .output_every = 0.02}, frames, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
