// SPDX-License-Identifier: MIT
// The cases by name. The characteristic length of each is 1 m, with 1/spacing particles along it.
#pragma once

#include "falling_block.hpp"
#include "fluid_case.hpp"
#include "oscillating_drop.hpp"
#include "rotating_square.hpp"
#include "standing_wave.hpp"
#include "taylor_green.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace fluid_cases {

inline const std::vector<std::string>& names() {
  static const std::vector<std::string> all{"taylor_green", "standing_wave", "oscillating_drop",
                                            "rotating_square", "falling_block"};
  return all;
}

struct Choice {
  std::string name;      ///< one of names()
  double spacing = 0.02; ///< l0 [m], at most 0.1; 1 m must be a multiple of it
  double swing = 1;      ///< A0/B0 of the drop [-]
};

/// Throws if there is no such case, or the spacing is invalid.
inline FluidCase make(const Choice& choice) {
  require_positive("fluid_cases: spacing", choice.spacing);
  require_positive("fluid_cases: swing", choice.swing);
  const double number = std::round(1 / choice.spacing);
  if (!(std::abs(number * choice.spacing - 1) < 1e-6) || number < 10 || number > 10000) {
    fail("fluid_cases: spacing = " + to_text(choice.spacing) +
         " m must be 1 m divided by an integer from 10 to 10000; use 0.02 or 0.01");
  }
  const int along = static_cast<int>(number);
  if (choice.name == "taylor_green") return taylor_green(along);
  if (choice.name == "standing_wave") return standing_wave(along);
  if (choice.name == "oscillating_drop") return oscillating_drop(along, choice.swing);
  if (choice.name == "rotating_square") return rotating_square(along);
  if (choice.name == "falling_block") return falling_block(along);
  fail("fluid_cases: there is no case " + choice.name);
}

}  // namespace fluid_cases
