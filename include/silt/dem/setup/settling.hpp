// SPDX-License-Identifier: MIT
// Runs a simulation until the grains are at rest.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace silt::dem {

/// When settle() regards grains as at rest.
struct Settling {
  double speed = 0;        ///< at rest below this rms speed [m/s], above 0
  double check_every = 0;  ///< time between two checks [s], above 0 and at most max_time
  double max_time = 0;     ///< limit of the settling time [s], above 0
  std::optional<double> time_step = {};  ///< see Run [s]
};

/// √(Σ m v² / Σ m) [m/s]; 0 without grains.
template <class P>
double rms_speed(const P& grains) {
  if (grains.size() == 0) return 0;
  const auto m = grains[mass];
  const double all = ordered_sum(grains.size(), 0.0, [&](Index i) { return double(m[i]); });
  return std::sqrt(2 * kinetic_energy(grains) / all);
}

/// Runs the simulation with these observers until a check finds the grains at rest; the first check
/// is after check_every, the last one after max_time. Returns the time it took [s]; returns early
/// if an observer ends the run. Throws silt::Error if the grains are not at rest after max_time, if
/// a check follows another without a step, or, before a step is made, if more than 10¹² steps are
/// ahead.
template <class Sim, class... Observers>
double settle(Sim& simulation, const Settling& settling, Observers&&... observers) {
  static_assert(silt::detail::are_of_one_process<std::remove_cvref_t<decltype(simulation.particles())>>,
                "dem::settle: particles that processes share cannot be settled yet; let them settle "
                "in one process, and write a checkpoint");
  require_positive("Settling: speed", settling.speed);
  require_positive("Settling: check_every", settling.check_every);
  require_positive("Settling: max_time", settling.max_time);
  if (settling.check_every > settling.max_time) {
    fail({"Settling: check_every = ", settling.check_every, " s is longer than max_time = ",
          settling.max_time, " s; check more often, or increase max_time"});
  }
  if (settling.time_step) require_positive("Settling: time_step", *settling.time_step);
  const double began = simulation.time(), end = began + settling.max_time;
  double speed = 0;
  do {
    // Without grains no step is known: an observer may add them. The runs below see only the steps
    // until the next check.
    if (settling.time_step || !simulation.particles().empty()) {
      silt::detail::require_feasible(
          "Settling: time_step", settling.time_step ? *settling.time_step : simulation.time_step(),
          "steps", {simulation.time(), end},
          [] { return "lower max_time, or give a longer time_step"; });
    }
    const auto steps = simulation.steps();
    const double next = std::min(simulation.time() + settling.check_every, end);
    const bool completed = simulation.run(
        {.until = next, .output_every = 0, .time_step = settling.time_step}, observers...);
    if (!completed) return simulation.time() - began;
    if (simulation.steps() == steps) {
      fail({"Settling: check_every = ", settling.check_every,
            " s is too short for a step at t = ", simulation.time(), " s; increase it"});
    }
    speed = rms_speed(simulation.particles());
    if (speed < settling.speed) return simulation.time() - began;
  } while (simulation.time() < end * (1 - 1e-12));  // as a run ends
  fail({"dem::settle: after ", settling.max_time, " s the rms speed is still ", speed,
        " m/s, above speed = ", settling.speed,
        " m/s; increase max_time or speed, or add damping"});
}

}  // namespace silt::dem
