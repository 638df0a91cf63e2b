// SPDX-License-Identifier: MIT
// A run: steps of a simulation up to a given time, with outputs and the calls of observers.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/tuples.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>

namespace silt {

/// End of a run, interval of outputs and time step.
struct Run {
  double until = 0;                      ///< run while time < until [s]
  double output_every = 0;               ///< [s]; 0: only at the beginning and at the end
  std::optional<double> time_step = {};  ///< [s]; if not given, the interaction chooses it
  /// true: ends at exactly time() == until, by shortening the last one or two steps; false: ends
  /// after the first step that reaches `until`, up to one step later.
  bool end_exactly = false;

  /// Throws if a member is out of range, or if more than 10¹² outputs are ahead at the time `now`
  /// [s].
  void check(double now) const {
    require_finite("Run: until", until);
    require_not_negative("Run: output_every", output_every);
    if (time_step) require_positive("Run: time_step", *time_step);
    if (output_every > 0) {
      detail::require_feasible("Run: output_every", output_every, "outputs", {now, until},
                               [] { return "increase it"; });
    }
  }
};

namespace detail {

/// What a simulation keeps of its run, also in a checkpoint.
struct RunState {
  bool is_open = false;    ///< within run(), or after one that an observer ended
  double output_time = 0;  ///< of the last output [s]
  std::uint64_t output_step = 0;

  template <class Archive>
  void transfer(Archive& archive) {
    archive("run_is_open", is_open);
    archive("output_time", output_time);
    archive("output_step", output_step);
  }
};

/// One call of Simulation::run.
template <class Sim, class... Observers>
class RunLoop {
 public:
  /// Throws if a member of `run` is out of range. The simulation and the observers must outlive
  /// this object.
  RunLoop(Sim& simulation, const Run& run, Observers&... observers)
      : simulation_(simulation), state_(simulation.run_), run_(run), observers_(observers...) {
    together(simulation.particles(), [&] {
      run.check(simulation.time());
      return Largest{};
    });
    require_same_in_all(simulation.particles(),
                        "Run: until, output_every, time_step or end_exactly",
                        std::array{run.until, run.output_every, run.time_step.value_or(0),
                                   run.end_exactly ? 1.0 : 0.0});
  }

  /// See Simulation::run.
  bool perform() {
    const double almost_until = run_.until * (1 - 1e-12);
    // The checkpoint that was read is of a later run of the same program.
    if (state_.is_open && simulation_.time() - simulation_.last_time_step() >= almost_until) {
      return true;
    }
    if (!state_.is_open || is_output_due()) make_output();
    OpenRun open(state_.is_open);
    while (simulation_.time() < almost_until) {
      if (is_stop_requested()) {
        open.stays_open = true;
        return false;
      }
      // Also for the observers.
      const Team team(simulation_.thread_choice_, simulation_.particles().size());
      for_each_observer([&](auto& each) { call_before_step(each, simulation_); });
      advance(run_.time_step ? *run_.time_step : simulation_.time_step());
      for_each_observer([&](auto& each) { call_after_step(each, simulation_, run_); });
      if (is_output_due()) make_output();
      for_each_observer([&](auto& each) { call_between_steps(each, simulation_); });
    }
    // The loop may end within round-off before `until`.
    if (run_.end_exactly && simulation_.time() < run_.until) simulation_.time_ = run_.until;
    if (state_.output_step != simulation_.steps()) make_output();
    // An observer may have failed in one process.
    together(simulation_.particles(), [] { return Largest{}; });
    return true;
  }

 private:
  // Marks a run as open until it is left, also by an exception.
  struct OpenRun {
    explicit OpenRun(bool& is_open) : is_open_(is_open) { is_open_ = true; }
    OpenRun(const OpenRun&) = delete;
    OpenRun& operator=(const OpenRun&) = delete;
    ~OpenRun() { is_open_ = stays_open; }

    bool stays_open = false;

   private:
    bool& is_open_;
  };

  // A step of dt [s], or less if the end has to be met, or if dt was chosen and is not stable.
  void advance(double dt) {
    require_feasible("Run: time_step", dt, "steps", {simulation_.time(), run_.until}, [&] {
      return run_.time_step
                 ? std::string("increase it")
                 : remedy_for_time_step(simulation_.interaction(), simulation_.particles());
    });
    while (true) {
      const double left = run_.until - simulation_.time();
      const bool is_last = run_.end_exactly && left <= dt * (1 + 1e-9);
      // Never longer than dt, which may be the longest that is stable. No step is shorter than
      // dt/2: the last two steps are made equal instead.
      const double shortened = is_last ? std::min(left, dt) : left < 2 * dt ? left / 2 : dt;
      try {
        simulation_.step(run_.end_exactly ? shortened : dt);
      } catch (const Error& error) {
        if (run_.time_step || !error.stable_time_step()) throw;
        dt = shorter_time_step(dt, error);
        continue;
      }
      if (is_last) simulation_.time_ = run_.until;
      return;
    }
  }

  void make_output() {
    state_.output_time = simulation_.time();
    state_.output_step = simulation_.steps();
    for_each_observer([&](auto& each) { call_at_output(each, simulation_); });
  }
  bool is_output_due() const {
    return outputs_at(simulation_.time()) > outputs_at(state_.output_time);
  }
  Index outputs_at(double time) const {
    return run_.output_every > 0 ? completed_intervals(time / run_.output_every) : 0;
  }

  bool is_stop_requested() {
    if constexpr ((EndsRuns<Observers> || ...)) {
      const auto own = [&] {
        bool ends = false;
        for_each_of(observers_, [&](auto& each) { ends = ends || requests_stop(each); });
        return Largest{.wanted = ends ? 1.0 : 0.0};
      };
      return together(simulation_.particles(), own).wanted > 0;
    } else {
      return false;
    }
  }
  template <class F>
  void for_each_observer(F&& f) {
    call_alone(simulation_.particles(), [&] { for_each_of(observers_, f); });
  }

  Sim& simulation_;
  RunState& state_;  // of the simulation
  const Run run_;  // a copy, which observers cannot change
  std::tuple<Observers&...> observers_;
};

}  // namespace detail

}  // namespace silt
