// SPDX-License-Identifier: MIT
// One line that says how far a run is, rewritten in place. Only a terminal sees it: logs and pipes
// stay clean.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace silt {

/// Observer that shows step, time, time step, percentage and the time left, five times a second.
class Progress {
 public:
  /// Writes to the given stream, which must outlive it, if that is a terminal.
  explicit Progress(std::FILE* stream = stderr) : stream_(stream), shown_(is_terminal(stream)) {}
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Ends a line left open by a run that threw.
  ~Progress() { end_line(); }

  template <class Sim>
  void operator()(const Sim& simulation) {
    if (begun_) return;
    begun_ = true;
    wall_begin_ = Clock::now();
    time_begin_ = simulation.time();
  }

  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run& run) {
    if (!shown_) return;
    constexpr std::chrono::milliseconds between{200};
    const bool done = simulation.time() >= run.until * (1 - 1e-12);
    const auto now = Clock::now();
    if (!done && now - wall_shown_ < between) return;
    wall_shown_ = now;

    const double wall = std::chrono::duration<double>(now - wall_begin_).count();
    const double share = done ? 1
                              : std::clamp((simulation.time() - time_begin_) /
                                               (run.until - time_begin_), 1e-12, 1.0);
    std::fprintf(stream_, "\rstep %llu  t = %.4g s  dt = %.2e s  %5.1f %%  %s %.0f s \x1b[K",
                 static_cast<unsigned long long>(simulation.steps()), simulation.time(),
                 simulation.last_time_step(), 100 * share, done ? "took" : "left",
                 done ? wall : wall * (1 - share) / share);
    std::fflush(stream_);
    open_ = true;
    if (done) end_line();
  }

 private:
  using Clock = std::chrono::steady_clock;

  static bool is_terminal(std::FILE* stream) {
#if __has_include(<unistd.h>)
    return isatty(fileno(stream)) != 0;
#else
    return stream == nullptr;
#endif
  }

  void end_line() {
    if (open_) std::fputs("\n", stream_);
    open_ = false;
  }

  std::FILE* stream_;
  bool shown_;
  bool begun_ = false;
  bool open_ = false;
  Clock::time_point wall_begin_{};
  Clock::time_point wall_shown_{};
  double time_begin_ = 0;
};

}  // namespace silt
