// SPDX-License-Identifier: MIT
// Ctrl-C that ends a run after the step, with everything written and closed.
#pragma once

#include <silt/core/error.hpp>

#include <atomic>

#if !defined(__wasi__)
#include <csignal>
#include <initializer_list>
#endif

namespace silt {

/// Observer that ends the run after the step in which the process gets SIGINT (Ctrl-C) or SIGTERM
/// (as batch systems send it before they kill a job). A second signal has its usual effect and
/// kills the process at once. Signals that the process ignores, as under nohup, stay ignored. Only
/// while one exists are signals caught; the library installs no handler otherwise. Where there are
/// no signals, it ends nothing.
class StopOnSignal {
 public:
  /// Installs the handlers. Throws silt::Error if another StopOnSignal exists.
  StopOnSignal() {
    if (exists_.exchange(true)) {
      fail("StopOnSignal: another one exists already; pass that one to every run");
    }
    received_ = 0;
#if !defined(__wasi__)
    for (auto& each : handled_) each.before = handle(each.number, &StopOnSignal::receive);
#endif
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  /// Puts back the handlers that were there before.
  ~StopOnSignal() {
#if !defined(__wasi__)
    for (const auto& each : handled_) {
      std::signal(each.number, each.before == SIG_ERR ? SIG_DFL : each.before);
    }
#endif
    exists_ = false;
  }

  bool stop_requested() const noexcept { return received_ != 0; }
  /// The number of the signal; 0 if there was none. Programs that it ended exit with 128 + number.
  int signal_number() const noexcept { return received_; }

 private:
#if !defined(__wasi__)
  using Handler = void (*)(int);

  // Sets the handler, unless the signal is ignored, and returns the one before.
  static Handler handle(int number, Handler handler) {
    const Handler before = std::signal(number, handler);
    if (before == SIG_IGN) std::signal(number, SIG_IGN);
    return before;
  }
  static void receive(int number) {
    received_ = number;
    for (const int each : {SIGINT, SIGTERM}) handle(each, SIG_DFL);
  }

  struct Handled {
    int number;
    Handler before = SIG_DFL;
  };
  Handled handled_[2] = {{.number = SIGINT}, {.number = SIGTERM}};
#endif

  static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not take a lock");
  inline static std::atomic<int> received_ = 0;
  inline static std::atomic<bool> exists_ = false;
};

}  // namespace silt
