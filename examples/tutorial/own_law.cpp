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
    using Real = typename Contact::Real;
    const Real spring = Real(stiffness) * c.overlap + Real(dashpot) * c.approach_speed();
    const Real pressed = std::max(Real(0), spring);
    const typename Contact::Vec drag = -Real(dashpot) * c.tangential_velocity();
    const Real share = std::min(Real(1), Real(friction) * pressed / (drag.norm() + Real(1e-30)));
    return (pressed - Real(pull)) * c.normal + share * drag;
  }
};

int main() {
  using namespace silt;

  // A little closer than 2 R, so that neighbours touch and stick from the beginning.
  auto grains =
      dem::make_grains(lattice<2>({{0, 0}, {0.2, 0.6}}, 0.0197), {.radius = 0.01, .density = 2500});
  const Index ball = dem::add_grain(grains, {-0.1, 0.35}, {.radius = 0.06, .density = 2500});
  grains[velocity][ball] = {2, 0};

  const WetContact law{.stiffness = 1e6, .dashpot = 150, .friction = 0.5, .pull = 300};
  const Forces forces{Gravity<2>{{0, -9.81}}, dem::Contacts{law, dem::Plane<2>{}}};

  Simulation fall{grains, NeighbourList<2>{}, forces, Leapfrog{}};
  fall.run({.until = 0.45, .output_every = 0.15, .time_step = 3e-5}, VtkSeries{"wet"},
           [](const auto& now) {
             double highest = 0;
             for (const auto& x : now.particles()[position]) highest = std::max(highest, x[1]);
             std::printf("%.2f s: the highest grain is at %.2f m\n", now.time(), highest);
           });
}
