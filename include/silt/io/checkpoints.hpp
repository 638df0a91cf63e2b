// SPDX-License-Identifier: MIT
// Checkpoints of a run, written now and then.
//
//   VtkSeries frames{"tower"};
//   Checkpoints checkpoints{"tower.silt", {.every = 600}, frames};
//   if (checkpoints.exist()) checkpoints.read(tower);
//   StopOnSignal stop;
//   if (!tower.run({.until = 10, .output_every = 0.1}, frames, checkpoints, stop)) {
//     checkpoints.write(tower);
//   }
#pragma once

#include <silt/core/error.hpp>
#include <silt/io/checkpoint.hpp>

#include <chrono>
#include <filesystem>
#include <limits>
#include <tuple>
#include <utility>

namespace silt {

/// Observer that writes a checkpoint of the simulation and of further parts of the run, such as a
/// VtkSeries or an inflow, to one file, between two steps, so that it holds all that was written up
/// to there. The interval is one of wall-clock time: it limits how much work is lost, and has no
/// effect on the results.
template <class... Parts>
class Checkpoints {
 public:
  struct Settings {
    /// Wall-clock time between two of them [s]; 0: after every step. Without one, only write()
    /// writes.
    double every = std::numeric_limits<double>::infinity();
  };

  /// The parts must outlive it. Throws silt::Error if the interval is negative.
  Checkpoints(std::filesystem::path path, const Settings& settings, Parts&... parts)
      : path_(std::move(path)), every_(settings.every), parts_(parts...) {
    if (!(every_ >= 0)) require_not_negative("Checkpoints: every", every_);
  }

  /// Whether the file is there.
  bool exist() const { return std::filesystem::exists(path_); }

  /// As write_checkpoint().
  template <class Sim>
  void write(const Sim& simulation) {
    std::apply([&](auto&... parts) { write_checkpoint(path_, simulation, parts...); }, parts_);
    written_ = Clock::now();
  }
  /// As read_checkpoint(): all parts go on from there.
  template <class Sim>
  void read(Sim& simulation) {
    std::apply([&](auto&... parts) { read_checkpoint(path_, simulation, parts...); }, parts_);
  }

  template <class Sim>
  void between_steps(const Sim& simulation) {
    if (std::chrono::duration<double>(Clock::now() - written_).count() >= every_) write(simulation);
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::filesystem::path path_;
  double every_;
  std::tuple<Parts&...> parts_;
  Clock::time_point written_ = Clock::now();
};

template <class... Parts>
Checkpoints(std::filesystem::path, typename Checkpoints<Parts...>::Settings, Parts&...)
    -> Checkpoints<Parts...>;

}  // namespace silt
