// SPDX-License-Identifier: MIT
// Checkpoints of a run at regular intervals.
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
#include <silt/core/processes.hpp>
#include <silt/io/checkpoint.hpp>
#include <silt/io/file.hpp>

#include <chrono>
#include <filesystem>
#include <limits>
#include <tuple>
#include <utility>

namespace silt {

/// Observer that writes a checkpoint of the simulation and of further parts of the run, such as a
/// VtkSeries or an inflow, to one file. It writes between two steps, so that the checkpoint covers
/// all output up to that time. The interval is in wall-clock time: it limits how much work can be
/// lost and has no effect on the results.
template <class... Parts>
class Checkpoints {
 public:
  struct Settings {
    /// Wall-clock time between two checkpoints [s]; 0: after every step; infinite: only by write().
    double every = std::numeric_limits<double>::infinity();
  };

  /// The parts must outlive this object. Throws silt::Error if the path is empty or the interval
  /// is negative.
  Checkpoints(std::filesystem::path path, const Settings& settings, Parts&... parts)
      : path_(std::move(path)), every_(settings.every), parts_(parts...) {
    if (path_.empty()) fail("Checkpoints: the path is \"\"; name a file");
    if (!(every_ >= 0)) require_not_negative("Checkpoints: every", every_);
  }

  /// Whether the file exists. Throws silt::Error if that cannot be determined.
  bool exist() const { return file::exists("Checkpoints", path_); }

  /// Writes a checkpoint now, see write_checkpoint().
  template <class Sim>
  void write(const Sim& simulation) {
    std::apply([&](auto&... parts) { write_checkpoint(path_, simulation, parts...); }, parts_);
    written_ = Clock::now();
  }
  /// Restores the simulation and all parts, see read_checkpoint().
  template <class Sim>
  void read(Sim& simulation) {
    std::apply([&](auto&... parts) { read_checkpoint(path_, simulation, parts...); }, parts_);
  }

  template <class Sim>
  void between_steps(const Sim& simulation) {
    if (is_due(simulation)) write(simulation);
  }

 private:
  using Clock = std::chrono::steady_clock;

  // By the clock of the first process.
  template <class Sim>
  bool is_due(const Sim& simulation) const {
    if (!is_finite(every_)) return false;
    const auto is_asked = [&] {
      const std::chrono::duration<double> elapsed = Clock::now() - written_;
      const bool is_first = process_of(simulation.particles()).rank == 0;
      return Largest{.wanted = is_first && elapsed.count() >= every_ ? 1.0 : 0.0};
    };
    return detail::together(simulation.particles(), is_asked).wanted > 0;
  }

  std::filesystem::path path_;
  double every_;
  std::tuple<Parts&...> parts_;
  Clock::time_point written_ = Clock::now();
};

template <class... Parts>
Checkpoints(std::filesystem::path, typename Checkpoints<Parts...>::Settings, Parts&...)
    -> Checkpoints<Parts...>;

}  // namespace silt
