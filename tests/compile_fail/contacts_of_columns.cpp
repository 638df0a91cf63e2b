// expect: (static assertion failed|static_assert failed).*these particles are not stored as dem::Grains
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

using namespace silt;

using GrainsInColumns = Particles<2, double, velocity_t, spin_t, force_t, torque_t, mass_t,
                                  inertia_t, radius_t, dem::material_t>;

int main() {
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
#ifdef SILT_VALID
  Simulation sim{dem::Grains<2>{}, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
#else
  Simulation sim{GrainsInColumns{}, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
#endif
}
