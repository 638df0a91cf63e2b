// SPDX-License-Identifier: MIT
// Ends a run on Ctrl-C after the current step, with all output written.
#pragma once

#include <silt/core/error.hpp>

#include <atomic>

#if !defined(__wasi__)
#include <csignal>
#include <initializer_list>
#endif

namespace silt {

/// Observer that ends the run after the step in which the process receives SIGINT (Ctrl-C) or
/// SIGTERM (sent by batch systems before they kill a job). A second signal has its default effect
/// and kills the process immediately. Signals that the process ignores, as under nohup, remain
/// ignored. Signals are caught only while an object of this class exists; the library installs no
/// handler otherwise. On platforms without signals it has no effect.
class StopOnSignal {
 public:
  /// Installs the handlers. Throws silt::Error if another StopOnSignal exists.
  StopOnSignal() {
    if (exists_.exchange(true)) {
      fail("StopOnSignal: another StopOnSignal exists; use that one for every run");
    }
    received_ = 0;
#if !defined(__wasi__)
    for (auto& each : handled_) each.previous = handle(each.number, &StopOnSignal::receive);
#endif
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;
  /// Restores the previous handlers.
  ~StopOnSignal() {
#if !defined(__wasi__)
    for (const auto& each : handled_) {
      std::signal(each.number, each.previous == SIG_ERR ? SIG_DFL : each.previous);
    }
#endif
    exists_ = false;
  }

  bool stop_requested() const noexcept { return received_ != 0; }
  /// The number of the received signal, 0 if none. By convention, a program ended by a signal exits
  /// with 128 + this number.
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
    Handler previous = SIG_DFL;
  };
  Handled handled_[2] = {{.number = SIGINT}, {.number = SIGTERM}};
#endif

  static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not take a lock");
  inline static std::atomic<int> received_ = 0;
  inline static std::atomic<bool> exists_ = false;
};

}  // namespace silt
