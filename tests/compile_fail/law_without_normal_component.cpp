// expect: (static assertion failed|static_assert failed).*no component has a normal_force
// SPDX-License-Identifier: MIT
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>

using namespace silt;

int main() {
  const dem::LinearFriction friction{.tangential_stiffness = 1, .friction_angle = 0.3};
#ifdef SILT_VALID
  [[maybe_unused]] const dem::Law law{dem::LinearSpringDashpot{.normal_stiffness = 1}, friction};
#else
  [[maybe_unused]] const dem::Law law{friction};
#endif
}
