// SPDX-License-Identifier: MIT
// A bed of discs on a floor that vibrates. Writes vibrating_floor.pvd, for ParaView.
#include <silt/dem.hpp>
#include <silt/io/progress.hpp>
#include <silt/io/vtk.hpp>

#include <cstdio>
#include <limits>

int main() try {
  using namespace silt;
  constexpr double depth = 0.16;          // of the bed [m]
  constexpr double amplitude = 0.012;     // of the floor [m]
  constexpr double frequency = 9;         // of the floor [Hz]
  constexpr double restitution = 0.6;     // coefficient [-]
  constexpr double friction_angle = 0.3;  // of grains and walls [rad]

  dem::Grains<2> grains;
  for (const auto& x : lattice<2>({{-0.5, 0.02}, {0.5, 0.02 + depth}}, 0.02)) {
    Random random{.seed = 1, .id = grains.size()};
    const double R = random.uniform({0.008, 0.0095});
    const Index i = dem::add_grain(grains, x, {.radius = R, .density = 2500});
    grains[velocity][i] = {0.2 * random.normal(), 0};
  }
  const dem::CundallStrack law{.normal_stiffness = 4e6, .tangential_stiffness = 2e6,
                               .restitution = restitution, .friction_angle = friction_angle};
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const dem::BoxWall<2> sides{{.lower = {-0.5, -infinity}, .upper = {0.5, infinity}}};
  const dem::Moving floor{dem::Plane<2>{},
                          dem::Vibration<2>{.amplitude = {0, amplitude}, .frequency = frequency}};

  Simulation bed{grains, NeighbourList<2>{},
                 Forces{Gravity<2>{{0, -9.81}},
                        dem::Contacts{law, sides, floor}.with({.steps_per_contact = 20})},
                 Leapfrog{}};
  bed.run({.until = 2, .output_every = 0.02}, VtkSeries{"vibrating_floor"}, Progress{});
} catch (const silt::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
