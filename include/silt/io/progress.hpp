// SPDX-License-Identifier: MIT
// A progress line: updated in place on a terminal, repeated at growing intervals in a file or pipe,
// such as the log of a batch job.
#pragma once

#include <silt/core/processes.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <utility>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace silt {

/// Observer that shows step, time, time step, percentage and estimated remaining time. A terminal
/// is updated five times per second. To a file or pipe, a line is written after 3 s of wall-clock
/// time, then whenever the elapsed time has doubled, but at least every 5 minutes; and at the end.
class Progress {
 public:
  /// Wall-clock time since an arbitrary origin [s].
  using Clock = std::function<double()>;

  /// Writes to the given stream, which must outlive it.
  explicit Progress(std::FILE* stream = stderr, Clock clock = &Progress::seconds)
      : stream_(stream), is_terminal_(is_terminal(stream)), clock_(std::move(clock)) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Shows the progress of a run that threw or was stopped.
  [[gnu::cold]] ~Progress() { show_last(); }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (!is_first_of(simulation)) return;
    if (!begun_) begin(simulation.time(), simulation.time());
  }

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run& run) {
    if (!is_first_of(simulation)) return;
    // A resumed run has no output at its beginning; its percentage counts from time 0.
    if (!begun_) begin(0, simulation.time() - simulation.last_time_step());
    last_ = {.step = static_cast<std::uint64_t>(simulation.steps()),
             .time = simulation.time(),
             .time_step = simulation.last_time_step(),
             .fraction = std::clamp((simulation.time() - run_begin_) / (run.until - run_begin_),
                                    0.0, 1.0)};
    is_ended_ = false;
    const double elapsed = clock_() - wall_begin_;
    if (simulation.time() >= run.until * (1 - 1e-12)) {
      last_.fraction = 1;
      show_last();
    } else if (elapsed >= wall_next_) {
      show("left", elapsed * (run.until - simulation.time()) / (simulation.time() - time_begin_));
      wall_next_ = elapsed + (is_terminal_ ? 0.2 : std::clamp(elapsed, 3.0, 300.0));
    }
  }

 private:
  // Of several processes, one shows the progress.
  template <class Sim>
  static bool is_first_of(const Sim& simulation) {
    if constexpr (requires { simulation.particles(); }) {
      return process_of(simulation.particles()).rank == 0;
    } else {
      return true;
    }
  }

  struct State {
    std::uint64_t step = 0;
    double time = 0;       // [s]
    double time_step = 0;  // [s]
    double fraction = 0;   // of the run that is done
  };

  static double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }

  static bool is_terminal([[maybe_unused]] std::FILE* stream) {
#if __has_include(<unistd.h>)
    return isatty(fileno(stream)) != 0;
#else
    return false;
#endif
  }

  [[gnu::cold]] void begin(double run_begin, double time) {
    begun_ = true;
    run_begin_ = run_begin;
    wall_begin_ = clock_();
    wall_next_ = is_terminal_ ? 0 : 3;
    time_begin_ = time;
  }

  [[gnu::cold]] void show(const char* what, double wall) {
    std::fprintf(stream_, "%sstep %llu  t = %.4g s  dt = %.2e s  %5.1f %%  %s %.0f s%s",
                 is_terminal_ ? "\r" : "", static_cast<unsigned long long>(last_.step), last_.time,
                 last_.time_step, 100 * last_.fraction, what, wall,
                 is_terminal_ ? " \x1b[K" : "\n");
    std::fflush(stream_);
  }

  [[gnu::cold]] void show_last() {
    if (is_ended_) return;
    is_ended_ = true;
    show("took", clock_() - wall_begin_);
    if (is_terminal_) std::fputs("\n", stream_);
    std::fflush(stream_);
  }

  std::FILE* stream_;
  bool is_terminal_;
  Clock clock_;
  bool begun_ = false;
  bool is_ended_ = true;  // the last step has been shown
  double wall_begin_ = 0;
  double wall_next_ = 0;   // wall-clock time of the next line, since wall_begin_
  double run_begin_ = 0;   // [s]
  double time_begin_ = 0;  // time at the first call [s]
  State last_;
};

}  // namespace silt
