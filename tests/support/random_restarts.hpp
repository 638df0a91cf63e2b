// SPDX-License-Identifier: MIT
// Checks that a run that is resumed from a checkpoint, written at a random step with one number of
// threads and read with another, has the same checkpoint at its end as an uninterrupted run. A
// checkpoint has all that is named in any transfer(); what has no name there shows in later steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/simulation.hpp>
#include <silt/core/types.hpp>
#include <silt/io/checkpoint.hpp>

#include "support/check.hpp"
#include "support/checkpoint_bytes.hpp"
#include "support/restart.hpp"
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test {

/// Where a run is stopped, and for how long it is resumed.
struct RandomRestarts {
  Index steps = 60;        ///< of the run
  Index number = 6;        ///< of restarts, at random steps
  Index to_the_end = 6;    ///< restarts that are continued to the end
  Index further = 5;       ///< steps after all other restarts
  std::uint64_t seed = 1;  ///< of the random steps
};

/// A step of the length that the interaction chooses.
struct ChosenStep {
  template <class Sim>
  void operator()(Sim& simulation) const {
    simulation.step();
  }
};
/// Steps of which each has another length than the last one.
struct UnevenStep {
  template <class Sim>
  void operator()(Sim& simulation) const {
    simulation.step((0.75 + 0.05 * double(simulation.steps() % 6)) * simulation.time_step());
  }
};

namespace restart {

/// A step with all calls of the observers of a RunWith that Simulation::run() makes; an output
/// after every fifth.
template <class Run, class Step>
void observed_step(Run& run, const Step& step) {
  auto& simulation = run.simulation;
  std::apply(
      [&](auto&... observers) {
        (silt::detail::call_before_step(observers, simulation), ...);
        step(simulation);
        (silt::detail::call_after_step(observers, simulation, silt::Run{}), ...);
        if (simulation.steps() % 5 == 0) {
          (silt::detail::call_at_output(observers, simulation), ...);
        }
      },
      run.observers);
}

template <class Run>
void read_bytes(const std::string& bytes, Run& run) {
  std::apply(
      [&](auto&... part) { checkpoint::restore({.file = "the checkpoint"}, bytes, run.simulation, part...); },
      run.observers);
}

}  // namespace restart

/// The values of an entry of a checkpoint whose name ends like this, as T; empty if there is none.
template <class T>
std::vector<T> values_of(const std::string& bytes, const std::string& name) {
  for (const Entry& entry : entries_of(bytes)) {
    if (!entry.name.ends_with(name) || entry.size % sizeof(T) != 0) continue;
    std::vector<T> values(entry.size / sizeof(T));
    std::memcpy(values.data(), bytes.data() + entry.values_at, entry.size);
    return values;
  }
  return {};
}

/// make() returns a RunWith (support/restart.hpp) at its beginning, step(simulation) advances it.
/// Checkpoints are read alternately into a new simulation and into one that has run already.
/// Returns the checkpoint at the end of the run.
template <class Make, class Step>
std::string expect_the_same_end_after_restarts(const RandomRestarts& restarts, const Make& make,
                                               const Step& step) {
  constexpr std::array numbers{1, 2, 4};  // of threads
  const std::vector<Index> stops = restart::random_steps(
      {.steps = restarts.steps, .number = restarts.number, .seed = restarts.seed});
  const Index each = std::max<Index>(1, restarts.number / std::max<Index>(1, restarts.to_the_end));
  std::vector<Index> ends;
  std::map<Index, std::string> expected;
  expected[restarts.steps];
  for (Index k = 0; k < stops.size(); ++k) {
    const Index last = stops[k] + restarts.further;
    ends.push_back(k % each == 0 ? restarts.steps : std::min(restarts.steps, last));
    expected[stops[k]];
    expected[ends.back()];
  }

  auto whole = make();
  const auto number_in = [&](Index k) { return numbers[k % numbers.size()]; };
  for (Index k = 0; k <= restarts.steps; ++k) {
    with_threads(number_in(k), [&] {
      if (expected.contains(k)) expected[k] = written(whole);
    });
    if (k == restarts.steps) break;
    with_threads(number_in(k / 8), [&] { restart::observed_step(whole, step); });
  }

  auto used = whole;
  for (Index k = 0; k < stops.size(); ++k) {
    const int number = number_in(stops[k] + 1 + k % 2);
    SCOPED_TRACE("restart at step " + std::to_string(stops[k]) + " with " + std::to_string(number) +
                 " threads, read into a simulation that " + (k % 2 == 0 ? "is new" : "has run"));
    const bool is_same = with_threads(number, [&] {
      if (k % 2 == 0) used = make();
      restart::read_bytes(expected[stops[k]], used);
      const std::string first = first_difference(written(used), expected[stops[k]]);
      EXPECT_EQ(first, "") << "differs already when it has been read";
      while (used.simulation.steps() < ends[k]) restart::observed_step(used, step);
      const std::string last = first_difference(written(used), expected[ends[k]]);
      EXPECT_EQ(last, "") << "differs " << ends[k] - stops[k] << " steps later";
      return first.empty() && last.empty();
    });
    if (!is_same) break;
  }
  return expected[restarts.steps];
}

}  // namespace silt::test
