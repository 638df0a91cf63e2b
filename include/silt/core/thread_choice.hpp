// SPDX-License-Identifier: MIT
// Whether the steps of a simulation are faster with one thread or with all. Threads meet several
// times in a step. Where another program occupies a core, each meeting lasts until the operating
// system runs the thread that is missing, which takes milliseconds; where a step is short, the
// meetings outweigh the work. Neither can be known beforehand, so both numbers are timed.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace silt::detail {

/// Chooses between one thread and all for the next step, from the wall times of those before. A
/// simulation begins with one thread. In a trial, steps use the other number until the time that
/// they gained or lost exceeds an allowance. Trials together lose at most about a fortieth of the
/// time; while they fail, the pauses between them double. No result depends on the choice.
class ThreadChoice {
 public:
  /// Whether the next step uses all threads.
  bool all() const noexcept { return all_; }

  /// Whether the next step belongs to a trial.
  bool is_trial() const noexcept { return trial_; }

  /// Time [s] after which the next step, if it began with all threads, goes on with one.
  double limit() const noexcept {
    if (!all_) return std::numeric_limits<double>::infinity();
    return trial_ ? expected() + allowance() - lost_ : 4 * one_.step + allowance();
  }

  /// Wall time of the step that has been done [s].
  void add(double seconds) noexcept {
    if (trial_) {
      add_to_trial(seconds);
    } else {
      add_to_usual(seconds);
    }
  }

 private:
  // A mean is renewed after this time [s]: the scheduler's slices are a few milliseconds.
  static constexpr double window = 0.01;
  // Time before the first trial, and before the next after one that succeeded [s].
  static constexpr double first_pause = 0.02;
  static constexpr double later_pause = 0.1;
  // One that takes less with one thread has too little work for several [s].
  static constexpr double shortest_step = 1e-4;
  // A trial may lose this much [s], or as many steps, before it has failed.
  static constexpr double least_allowance = 0.004;
  static constexpr double steps_of_allowance = 1;
  // A trial that has neither gained nor lost its allowance ends after so many allowances.
  static constexpr double longest_trial = 20;
  // Pause after a failed trial, in multiples of what it lost. It doubles with every further
  // failure, but not beyond the longest [s]: work may change, and so may the load of the machine.
  static constexpr double pause_per_loss = 40;
  static constexpr double longest_pause = 4;
  static constexpr double first_doubling = 0.5;

  /// Steps with one of the two numbers of threads.
  struct Mean {
    double step = 0;  // time of a step [s], 0: not known
    int windows = 0;  // that it is the mean of

    // The first four windows count alike, later ones a quarter.
    void add(double mean_of_window) noexcept {
      windows = std::min(windows + 1, 4);
      step += (mean_of_window - step) / windows;
    }
  };

  /// Of a step with the number of threads in use before the trial [s].
  double expected() const noexcept {
    const bool usually_all = trial_ ? !all_ : all_;
    return usually_all ? several_.step : one_.step;
  }
  double allowance() const noexcept {
    return std::max(least_allowance, steps_of_allowance * expected());
  }

  Mean& mean_of(bool all) noexcept { return all ? several_ : one_; }

  void add_to_usual(double seconds) noexcept {
    elapsed_ += seconds;
    time_ += seconds;
    ++steps_;
    const double other = mean_of(!all_).step;
    if (other > 0) excess_ = std::max(0.0, excess_ + seconds - other);
    if (time_ < window) return;
    mean_of(all_).add(time_ / double(steps_));
    begin_window();
    // The other number would have saved more than trying it costs, going by its last trial.
    const bool is_behind = excess_ > std::max(loss_, least_allowance);
    if (elapsed_ < (is_behind ? pause_per_loss * loss_ : pause_)) return;
    if (!all_ && one_.step < shortest_step) return;
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
    } else if (lost_ > allowance() || time_ > longest_trial * allowance()) {
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
    loss_ = std::max(lost_, least_allowance);
    const double least_pause = pause_per_loss * loss_;
    doubling_ = std::min(2 * doubling_, longest_pause / least_pause);
    pause_ = std::max(1.0, doubling_) * least_pause;
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
  double lost_ = 0;         // by the trial so far [s]
  double elapsed_ = 0;      // since the last trial [s]
  double excess_ = 0;       // over steps with the other number since the last trial [s]
  double loss_ = 0;         // by the last trial [s]
  double pause_ = first_pause;
  double doubling_ = first_doubling;  // of the pause, by failures in a row
};

}  // namespace silt::detail
