// expect: (static assertion failed|static_assert failed).*these particles do not have this field
// SPDX-License-Identifier: MIT
#include <silt/dem.hpp>

inline constexpr struct temperature_t : silt::scalar_field {
} temperature{};

using namespace silt;

int main() {
  dem::Grains<2> grains;
  [[maybe_unused]] const dem::CundallStrack law{.normal_stiffness = 1e6};
#ifdef SILT_VALID
  grains[velocity];
#else
  grains[temperature];
#endif
}
