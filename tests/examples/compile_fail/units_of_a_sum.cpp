// expect: (no match for|invalid operands).*Length
// SPDX-License-Identifier: MIT
#include "support/units.hpp"

int main() {
  namespace si = units::si;
  const units::Length width = 0.2 * si::metre;
#ifdef SILT_VALID
  const units::Length longer = width + 0.1 * si::metre;
#else
  const units::Length longer = width + 0.1 * si::second;
#endif
  return units::number(longer) > 0 ? 0 : 1;
}
