// expect: (static assertion failed|static_assert failed).*a wall lacks nearest
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

struct WallWithoutNearest {
  std::uint32_t material = 0;
  void check() const {}
};

using namespace silt;

int main() {
  dem::Grains<2> grains;
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
#ifdef SILT_VALID
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law, dem::Plane<2>{}}, Leapfrog{}};
#else
  Simulation sim{grains, UniformGrid<2>{}, dem::Contacts{law, WallWithoutNearest{}}, Leapfrog{}};
#endif
}
