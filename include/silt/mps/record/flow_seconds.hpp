// SPDX-License-Identifier: MIT
// Wall-clock timing of a flow.
#pragma once

#include <chrono>

namespace silt::mps {

/// Accumulated wall-clock time of a flow's steps, by stage [s].
struct FlowSeconds {
  double neighbours = 0;  ///< updating the neighbour lists
  double assembly = 0;    ///< of the pressure equation, including source and divergence
  double solve = 0;       ///< of the pressure equation
  double pressure = 0;  ///< the whole projection: assembly, solve and pressure gradient
};

/// Adds the time from its construction to its destruction to `seconds`.
class ScopedTimer {
 public:
  /// `seconds` is a sum of times [s].
  explicit ScopedTimer(double& seconds) : seconds_(seconds) {}
  ScopedTimer(const ScopedTimer&) = delete;
  ScopedTimer& operator=(const ScopedTimer&) = delete;
  ~ScopedTimer() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point begin_ = Clock::now();
};

/// Calls f, and adds the time that it takes to `seconds` [s].
template <class F>
void timed(double& seconds, F&& f) {
  const ScopedTimer timer(seconds);
  f();
}

}  // namespace silt::mps
