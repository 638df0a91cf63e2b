// SPDX-License-Identifier: MIT
// The work of forces on grains in a fluid. A force F that acts for a time Δt on a grain, of which
// the velocity changes from v to v' by all forces, does the work Δt F·(v + v')/2: together, they
// change ½ m v² to round-off.
#pragma once

#include <silt/core/types.hpp>

namespace silt::coupled {

/// On all grains, in a step of the flow; in 2D per metre of depth.
struct WorkOnGrains {
  double by_pressure = 0;  ///< −V ∇P [J]
  double by_exchange = 0;  ///< drag, added mass and lift [J]
  double by_others = 0;    ///< contacts, walls, gravity and the like [J]
  /// Σ m Δt v: of it, the work of gravity is g times [kg m].
  Vec<3> moved_mass = zero_of<Vec<3>>();

  /// Adds to it, of a grain: its mass times Δt [kg s], and its mean velocity [m/s].
  template <class V>
  void add_motion(double mass_time, const V& velocity) {
    for (int k = 0; k < V::RowsAtCompileTime; ++k) moved_mass[k] += mass_time * double(velocity[k]);
  }
  WorkOnGrains& operator+=(const WorkOnGrains& other) {
    by_pressure += other.by_pressure;
    by_exchange += other.by_exchange;
    by_others += other.by_others;
    moved_mass += other.moved_mass;
    return *this;
  }
};

}  // namespace silt::coupled
