// SPDX-License-Identifier: MIT
// Where the time of a flow goes.
#pragma once

#include <chrono>

namespace silt::mps {

/// Wall time [s] of parts of a flow's steps so far.
struct FlowSeconds {
  double neighbours = 0;  ///< finding who is near whom
  double assembly = 0;    ///< of the pressure equation, source and divergence with it
  double solve = 0;
  double pressure = 0;  ///< all of the projection: assembly, solve, and the pressure's gradient
};

/// Adds its life to a sum of seconds.
class Timed {
 public:
  explicit Timed(double& seconds) : seconds_(seconds) {}
  Timed(const Timed&) = delete;
  Timed& operator=(const Timed&) = delete;
  ~Timed() { seconds_ += std::chrono::duration<double>(Clock::now() - begin_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  double& seconds_;
  Clock::time_point begin_ = Clock::now();
};

}  // namespace silt::mps
