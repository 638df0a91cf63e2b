// expect: (static assertion failed|static_assert failed).*there are two of a kind
// SPDX-License-Identifier: MIT
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/walton_braun.hpp>

using namespace silt;

int main() {
  const dem::LinearSpringDashpot spring{.normal_stiffness = 1};
#ifdef SILT_VALID
  [[maybe_unused]] const dem::Law law{spring};
#else
  [[maybe_unused]] const dem::Law law{spring, dem::WaltonBraun{.loading_stiffness = 1}};
#endif
}
