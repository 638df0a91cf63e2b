// expect: (could not convert|cannot convert|no viable conversion|no matching).*(quantity|unit)
// SPDX-License-Identifier: MIT
#include "support/units.hpp"

int main() {
  namespace si = units::si;
  const auto density = 2500.0 * si::kilogrammes_per_cubic_metre;
#ifdef SILT_VALID
  const units::Grain disc{.radius = 0.02 * si::metre, .density = density};
#else
  const units::Grain disc{.radius = 0.02 * si::kilogramme, .density = density};
#endif
  const silt::dem::Grain grain = disc;
  return grain.radius > 0 ? 0 : 1;
}
