// SPDX-License-Identifier: MIT
// Checks that a run that is resumed from a checkpoint at any step has the same bits as an
// uninterrupted one.
#pragma once

#include "support/check.hpp"

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/random.hpp>
#include <silt/io/archive.hpp>
#include <silt/io/checkpoint.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <string>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

namespace silt::test {

/// A simulation with its observers that have state.
template <class Sim, class... Observers>
struct RunWith {
  explicit RunWith(Sim sim, Observers... with)
      : simulation(std::move(sim)), observers(std::move(with)...) {}

  Sim simulation;
  std::tuple<Observers...> observers;
};

/// Where a run is stopped and resumed.
struct Restarts {
  Index steps = 100;        ///< of the run
  Index number = 20;        ///< of restarts, at random steps
  Index further = 20;       ///< steps after most restarts
  Index to_the_end = 2;     ///< restarts that are continued to the end
  std::uint64_t seed = 13;  ///< of the random steps
};

namespace restart {

/// One step, optionally after a step that fails.
template <class Run>
void step(Run& run, bool fails_first = false) {
  std::apply(
      [&](auto&... observer) {
        [[maybe_unused]] const auto before = [&](auto& each) {
          if constexpr (requires { each.before_step(run.simulation); }) {
            each.before_step(run.simulation);
          }
        };
        (before(observer), ...);
        if (fails_first) {
          EXPECT_THROW(run.simulation.step(1e3), Error);
        }
        run.simulation.step();
        [[maybe_unused]] const auto after = [&](auto& each) {
          if constexpr (requires { each.after_step(run.simulation); }) {
            each.after_step(run.simulation);
          }
        };
        (after(observer), ...);
      },
      run.observers);
}

/// Hash of all fields and of `numbers`.
template <class Run>
std::uint64_t hash(const Run& run, std::vector<double> numbers = {}) {
  Bytes bytes;
  const auto& particles = run.simulation.particles();
  append(bytes, particles.ids());
  particles.for_each_field([&](auto values, auto) { append(bytes, values); });
  numbers.insert(numbers.end(), {run.simulation.time(), run.simulation.last_time_step(),
                                 double(run.simulation.steps())});
  append(bytes, std::span<const double>(numbers));
  return checkpoint::checksum({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

template <class Run>
void write(const std::filesystem::path& path, const Run& run) {
  std::apply([&](const auto&... part) { write_checkpoint(path, run.simulation, part...); },
             run.observers);
}
template <class Run>
void read(const std::filesystem::path& path, Run& run) {
  std::apply([&](auto&... part) { read_checkpoint(path, run.simulation, part...); },
             run.observers);
}

/// Different random steps, ascending.
inline std::vector<Index> random_steps(const Restarts& restarts) {
  std::vector<Index> steps(restarts.steps);
  std::iota(steps.begin(), steps.end(), Index(0));
  Random random{.seed = restarts.seed};
  for (Index k = 0; k < restarts.number; ++k) {
    const double left = double(steps.size() - k);
    std::swap(steps[k], steps[k + static_cast<Index>(random.uniform() * left)]);
  }
  steps.resize(restarts.number);
  std::ranges::sort(steps);
  return steps;
}

}  // namespace restart

/// make() returns a run at its beginning, measured(run) further numbers that must be the same.
/// Checkpoints are written and read with different numbers of threads, alternately into a new
/// simulation and into one that has run already; some runs then attempt a step that fails.
template <class Make, class Measured>
void expect_the_same_bits_after_restarts(const std::filesystem::path& folder,
                                         const Restarts& restarts, const Make& make,
                                         const Measured& measured) {
  using restart::hash;
  std::filesystem::create_directories(folder);
  const std::vector<Index> stops = restart::random_steps(restarts);
  const auto file = [&](Index stop) { return folder / std::to_string(stop); };

  std::vector<std::uint64_t> hashes;  // after each step
  std::vector<std::uint64_t> stopped;
  auto whole = make();
  for (Index step = 0; step <= restarts.steps; ++step) {
    if (std::ranges::binary_search(stops, step)) {
      with_threads(1 + static_cast<int>(step % 2), [&] { restart::write(file(step), whole); });
      stopped.push_back(hash(whole));
    }
    hashes.push_back(hash(whole, measured(whole)));
    if (step < restarts.steps) {
      with_threads(1 + static_cast<int>(step % 3), [&] { restart::step(whole); });
    }
  }

  auto used = whole;
  Index number = 0;
  for (const Index stop : stops) {
    SCOPED_TRACE("restart at step " + std::to_string(stop) + ", seed " +
                 std::to_string(restarts.seed));
    const bool to_the_end = number % std::max<Index>(1, stops.size() / restarts.to_the_end) == 0;
    const bool is_new = number % 2 == 0;
    const Index last =
        to_the_end ? restarts.steps : std::min(restarts.steps, stop + restarts.further);
    if (is_new) used = make();
    bool is_same = true;
    with_threads(2 - static_cast<int>(stop % 2), [&] {
      restart::read(file(stop), used);
      EXPECT_EQ(hash(used), stopped[number]);
      // Neither a failed step nor a snapshot changes the following steps.
      const bool fails_first = number % 3 == 0;
      if (number % 3 == 1) {
        EXPECT_EQ(used.simulation.snapshot().size(), used.simulation.particles().size());
      }
      // Results of the last step are not in the checkpoint; compare from the next step on.
      for (Index step = stop + 1; step <= last && is_same; ++step) {
        restart::step(used, fails_first && step == stop + 1);
        is_same = hash(used, measured(used)) == hashes[step];
        EXPECT_TRUE(is_same) << "differs " << step - stop
                             << " steps later; read into a simulation that "
                             << (is_new ? "was new" : "had run");
      }
    });
    ++number;
  }
  std::filesystem::remove_all(folder);
}

}  // namespace silt::test
