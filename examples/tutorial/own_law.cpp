// SPDX-License-Identifier: MIT
// A ball hits a tower of wet grains, which stick to each other.
#include <silt/dem.hpp>
#include <silt/io/vtk.hpp>

#include <algorithm>
#include <cstdio>

struct WetContact {
  double stiffness = 0;  ///< k [N/m]
  double dashpot = 0;    ///< c [N s/m], along the normal and across it
  double friction = 0;   ///< µ [-]
  double pull = 0;       ///< of the water between two grains [N]

  template <class Contact>
  typename Contact::Vec force(const Contact& c) const {
    const double pressed = std::max(0.0, stiffness * c.overlap + dashpot * c.approach_speed());
    const typename Contact::Vec drag = -dashpot * c.tangential_velocity();
    const double share = std::min(1.0, friction * pressed / (drag.norm() + 1e-30));
    return (pressed - pull) * c.normal + share * drag;
  }
};

int main() {
  using namespace silt;

  auto grains = dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.6}}, 0.02),
                                 {.radius = 0.01, .density = 2500});
  const Index ball = dem::add_grain(grains, {-0.1, 0.35}, {.radius = 0.06, .density = 2500});
  grains[velocity][ball] = {2, 0};

  const WetContact law{.stiffness = 1e6, .dashpot = 150, .friction = 0.5, .pull = 60};
  const Forces forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, dem::Plane<2>{}}};

  Simulation fall{grains, NeighbourList<2>{}, forces, Leapfrog{}};
  fall.run({.until = 0.6, .output_every = 0.1, .time_step = 3e-5}, VtkSeries{"wet"},
           [](const auto& now) {
             double highest = 0;
             for (const auto& x : now.particles()[position]) highest = std::max(highest, x[1]);
             std::printf("%.1f s: the highest grain is at %.2f m\n", now.time(), highest);
           });
}
