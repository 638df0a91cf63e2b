// SPDX-License-Identifier: MIT
// Looking at a simulation from time to time.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem {

/// How many looks there were.
struct Schedule {
  Index number = 0;

  /// Whether one more is due.
  struct Clock {
    double since = 0;  ///< the beginning [s]
    double every = 0;  ///< time between two looks [s]; 0: always
  };
  bool is_due(const Clock& clock) {
    if (!(clock.every > 0)) return true;
    const Index due = 1 + completed_intervals(clock.since / clock.every);
    if (due <= number) return false;
    number = due;
    return true;
  }
};

}  // namespace silt::dem
