// expect: (static assertion failed|static_assert failed).*is not a neighbour search for these
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

using namespace silt;

int main() {
  dem::Grains<2> grains;
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
#ifdef SILT_VALID
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
#else
  Simulation sim{grains, UniformGrid<3>{}, dem::Contacts{law}, Leapfrog{}};
#endif
}
