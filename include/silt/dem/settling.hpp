// SPDX-License-Identifier: MIT
// Running until grains have come to rest.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <optional>
#include <string>

namespace silt::dem {

struct Settling {
  double speed = 0;       ///< rms speed of the grains below which they are at rest [m/s], above 0
  double check_every = 0;  ///< time between two looks [s], above 0
  double at_most = 0;     ///< the longest that it may take [s], above 0
  std::optional<double> time_step = {};  ///< as of Run [s]
};

/// √(Σ m v² / Σ m) [m/s]; 0 without grains.
template <class P>
double rms_speed(const P& grains) {
  if (grains.size() == 0) return 0;
  const auto m = grains[mass];
  const double all = ordered_sum(grains.size(), 0.0, [&](Index i) { return double(m[i]); });
  return std::sqrt(2 * kinetic_energy(grains) / all);
}

/// Runs the simulation, with these observers, until the grains are at rest at a look; the first one
/// comes after check_every. Returns how long that took [s]; ends early if an observer ends the run.
/// Throws silt::Error if they are not at rest by at_most.
template <class Sim, class... Observers>
double settle(Sim& simulation, const Settling& settling, Observers&&... observers) {
  require_positive("Settling: speed", settling.speed);
  require_positive("Settling: check_every", settling.check_every);
  require_positive("Settling: at_most", settling.at_most);
  const double began = simulation.time();
  double speed = 0;
  while (simulation.time() - began < settling.at_most) {
    const bool went_on = simulation.run({.until = simulation.time() + settling.check_every,
                                         .output_every = 0,
                                         .time_step = settling.time_step},
                                        observers...);
    if (!went_on) return simulation.time() - began;
    speed = rms_speed(simulation.particles());
    if (speed < settling.speed) return simulation.time() - began;
  }
  fail("dem::settle: after " + to_text(settling.at_most) + " s the rms speed is still " +
       to_text(speed) + " m/s, above speed = " + to_text(settling.speed) +
       " m/s; allow more time or a higher speed, or add damping");
}

}  // namespace silt::dem
