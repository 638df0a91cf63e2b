// SPDX-License-Identifier: MIT
// Observers that act at regular time intervals.
#pragma once

#include <silt/core/types.hpp>

namespace silt::dem {

/// Decides in which steps an observer acts.
struct Schedule {
  Index number = 0;  ///< times it was due so far

  struct Clock {
    double since = 0;  ///< time since the beginning [s]
    double every = 0;  ///< interval [s]; 0: every step
  };
  /// True once per interval, the first time at the beginning.
  bool is_due(const Clock& clock) {
    if (!(clock.every > 0)) return true;
    const Index due = 1 + completed_intervals(clock.since / clock.every);
    if (due <= number) return false;
    number = due;
    return true;
  }
};

}  // namespace silt::dem
