// expect: (static assertion failed|static_assert failed).*the law has neither force
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

struct LawWithoutForce {
  double stiffness = 1;
};

using namespace silt;

int main() {
  dem::Grains<2> grains;
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
#ifdef SILT_VALID
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law}, Leapfrog{}};
#else
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{LawWithoutForce{}}, Leapfrog{}};
#endif
}
