// SPDX-License-Identifier: MIT
// Decides whether the steps of a simulation run with one thread or with all. Threads synchronise
// several times in a step. If another program occupies a core, each synchronisation lasts until the
// operating system schedules the missing thread, which takes milliseconds; if a step is short, the
// synchronisations take longer than the work. Neither is known in advance, so both numbers of
// threads are timed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace silt::detail {

/// Chooses between one thread and all for the next step, from the wall times of previous steps. A
/// simulation begins with one thread. From time to time a trial uses the other number of threads,
/// until the accumulated gain or loss of time exceeds an allowance. All trials together lose at
/// most about 1/40 of the time; while they fail, the pauses between them double. No result depends
/// on the choice.
class ThreadChoice {
 public:
  /// Whether the next step uses all threads.
  bool all() const noexcept { return all_; }

  /// Whether the next step belongs to a trial.
  bool is_trial() const noexcept { return trial_; }

  /// Time [s] after which a step that began with all threads continues with one.
  double limit() const noexcept {
    if (!all_) return std::numeric_limits<double>::infinity();
    return trial_ ? expected() + allowance() - lost_ : 4 * one_.step + allowance();
  }

  /// Adds the wall time of the last step [s].
  void add(double seconds) noexcept {
    if (trial_) {
      add_to_trial(seconds);
    } else {
      add_outside_trial(seconds);
    }
  }

 private:
  // A mean is updated after this time [s]; the time slices of schedulers are a few milliseconds.
  static constexpr double window = 0.01;
  // Time before the first trial, and minimum time after a successful one [s].
  static constexpr double first_pause = 0.02;
  static constexpr double later_pause = 0.1;
  // Steps that take less time than this with one thread never use several [s].
  static constexpr double min_step = 1e-4;
  // A trial fails once it has lost this time [s], or the time of this many steps.
  static constexpr double min_allowance = 0.004;
  static constexpr double steps_of_allowance = 1;
  // Maximum duration of a trial, in allowances.
  static constexpr double max_trial = 20;
  // Pause after a failed trial, in multiples of the time lost. It doubles with every further
  // failure up to a maximum [s], because the work and the load of the machine may change.
  static constexpr double pause_per_loss = 40;
  static constexpr double max_pause = 4;
  static constexpr double first_doubling = 0.5;

  /// Mean time of the steps with one of the two numbers of threads.
  struct Mean {
    double step = 0;  // time of a step [s]; 0: not known
    int windows = 0;  // number of windows averaged

    // Arithmetic mean of the first four windows; each later window has weight 1/4.
    void add(double mean_of_window) noexcept {
      windows = std::min(windows + 1, 4);
      step += (mean_of_window - step) / windows;
    }
  };

  /// Mean time of a step with the number of threads in use apart from trials [s].
  double expected() const noexcept {
    const bool usually_all = trial_ ? !all_ : all_;
    return usually_all ? several_.step : one_.step;
  }
  double allowance() const noexcept {
    return std::max(min_allowance, steps_of_allowance * expected());
  }

  Mean& mean_of(bool all) noexcept { return all ? several_ : one_; }

  void add_outside_trial(double seconds) noexcept {
    elapsed_ += seconds;
    time_ += seconds;
    ++steps_;
    const double other = mean_of(!all_).step;
    if (other > 0) excess_ = std::max(0.0, excess_ + seconds - other);
    if (time_ < window) return;
    mean_of(all_).add(time_ / double(steps_));
    begin_window();
    // By its last trial, the other number would have saved more time than a trial loses.
    const bool is_behind = excess_ > std::max(loss_, min_allowance);
    if (elapsed_ < (is_behind ? pause_per_loss * loss_ : pause_)) return;
    if (!all_ && one_.step < min_step) return;
    all_ = !all_;
    trial_ = true;
    lost_ = 0;
  }

  void add_to_trial(double seconds) noexcept {
    time_ += seconds;
    ++steps_;
    lost_ += seconds - expected();
    if (lost_ < -allowance()) {
      end_trial(true);
    } else if (lost_ > allowance() || time_ > max_trial * allowance()) {
      end_trial(false);
    }
  }

  void end_trial(bool succeeded) noexcept {
    const double usual = expected();
    mean_of(all_) = {.step = time_ / double(steps_), .windows = 1};
    trial_ = false;
    elapsed_ = excess_ = 0;
    begin_window();
    if (succeeded) {
      doubling_ = first_doubling;
      loss_ = 0;
      pause_ = std::max(later_pause, pause_per_loss * usual);
      return;
    }
    all_ = !all_;
    loss_ = std::max(lost_, min_allowance);
    const double min_pause = pause_per_loss * loss_;
    doubling_ = std::min(2 * doubling_, max_pause / min_pause);
    pause_ = std::max(1.0, doubling_) * min_pause;
  }

  void begin_window() noexcept {
    time_ = 0;
    steps_ = 0;
  }

  bool all_ = false;
  bool trial_ = false;
  Mean one_;      // with one thread
  Mean several_;  // with all
  double time_ = 0;         // of this window, or of the trial [s]
  std::uint64_t steps_ = 0;  // within it
  double lost_ = 0;         // by the current trial [s]
  double elapsed_ = 0;      // since the last trial [s]
  double excess_ = 0;       // of time over that with the other number, since the last trial [s]
  double loss_ = 0;         // by the last trial [s]
  double pause_ = first_pause;
  double doubling_ = first_doubling;  // of the pause, by consecutive failures
};

}  // namespace silt::detail
