// SPDX-License-Identifier: MIT
// Who has the lock of the interpreter while a simulation advances.
#pragma once

#include <pybind11/pybind11.h>

#ifdef __GLIBCXX__
#include <cxxabi.h>
#endif

#include <atomic>
#include <chrono>
#include <optional>
#include <thread>

namespace silt::python {

namespace py = pybind11;

// A thread that asks for the lock while the interpreter ends is ended by it, whose destructors then
// end the process as an error. At the end of the interpreter, the runs of other threads therefore
// stop for good before they ask for it, and those whose observer was ended so, in that moment.
class AtExit {
 public:
  /// Called by the interpreter, with its lock.
  static void stop_others() {
    const py::gil_scoped_release unlocked;
    thread_ = PyThread_get_thread_ident();
    is_ending_ = true;
    while (unlocked_ > stopped_) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  /// To be called without the lock. Does not return if this thread must stop.
  static void stop_here() {
    if (!is_ending_ || thread_ == PyThread_get_thread_ident()) return;
    ++stopped_;
    stop_for_good();
  }
  [[noreturn]] static void stop_for_good() {
    while (true) std::this_thread::sleep_for(std::chrono::hours(1));
  }
  /// In the only thread of a process that was forked, with its lock.
  static void forget_others() {
    unlocked_ = 0;
    stopped_ = 0;
  }

 private:
  friend class Unlocked;
  friend class LockedAgain;

  inline static std::atomic<bool> is_ending_ = false;
  inline static std::atomic<unsigned long> thread_ = 0;  // that ends the interpreter
  inline static std::atomic<int> unlocked_ = 0;          // threads without the lock
  inline static std::atomic<int> stopped_ = 0;           // of them
};

/// Releases the lock for a step or run.
class Unlocked {
 public:
  Unlocked() {
    ++AtExit::unlocked_;
    release_.emplace();
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;
  ~Unlocked() {
    AtExit::stop_here();
    release_.reset();
    --AtExit::unlocked_;
  }

 private:
  std::optional<py::gil_scoped_release> release_;
};

/// Takes the lock within a step or run.
class LockedAgain {
 public:
  LockedAgain() {
    AtExit::stop_here();
    acquire_.emplace();
    --AtExit::unlocked_;
  }
  LockedAgain(const LockedAgain&) = delete;
  LockedAgain& operator=(const LockedAgain&) = delete;
  ~LockedAgain() {
    ++AtExit::unlocked_;
    acquire_.reset();
  }

 private:
  std::optional<py::gil_scoped_acquire> acquire_;
};

/// f() with the lock, within a step or run, or where this thread has it. What is alive in f when
/// the interpreter may end this thread, as in any call of Python, must need no lock to be
/// destroyed: references are raw ones there.
template <class F>
auto with_lock(F&& f) {
  if (PyGILState_Check() != 0) return f();
  const LockedAgain locked;
#ifdef __GLIBCXX__
  try {
    return f();
  } catch (const abi::__forced_unwind&) {
    AtExit::stop_for_good();  // before the destructor of `locked`
  }
#else
  return f();
#endif
}

}  // namespace silt::python
