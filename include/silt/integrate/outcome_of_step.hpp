// SPDX-License-Identifier: MIT
// What a step of the leapfrog did to the particles: are the results valid, how far did particles
// move, and how much kinetic energy did they gain?
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

namespace silt::detail {

/// What a step did to a range of particles, see MotionInRows::Outcome.
struct OutcomeOfRange {
  bool is_valid = true;
  double squared_displacement = 0;  ///< maximum [m²]
  double energy_before = 0;         ///< twice that of all [J]
  double energy_after = 0;
};

/// What it did to all ranges; any thread may add one.
template <class P>
class OutcomeOfStep {
  using Real = typename P::Real;

 public:
  /// For n particles.
  explicit OutcomeOfStep(Index n) : energies_(knows_energy ? n : 0, {}) {}

  /// `first` is the first particle of the range.
  void add(Index first, const OutcomeOfRange& outcome) {
    if constexpr (knows_energy) {
      energies_[first / chunk_size].add(first % chunk_size,
                                        {outcome.energy_before, outcome.energy_after});
    }
    if (!outcome.is_valid) is_valid_.store(false, std::memory_order_relaxed);
    double highest = farthest_.load(std::memory_order_relaxed);
    while (outcome.squared_displacement > highest &&
           !farthest_.compare_exchange_weak(highest, outcome.squared_displacement,
                                            std::memory_order_relaxed)) {
    }
  }
  bool is_valid() const { return is_valid_.load(std::memory_order_relaxed); }
  /// [m], rounded up; infinity if a result is not valid
  double max_displacement() const {
    if (!is_valid()) return std::numeric_limits<double>::infinity();
    return std::sqrt(farthest_.load(std::memory_order_relaxed)) *
           (1 + 4 * double(std::numeric_limits<Real>::epsilon()));
  }
  /// See FinishedStep. Rounded up by more than the round-off of the sums, which depends on the
  /// order of the ranges.
  double max_energy_gain() const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if constexpr (!knows_energy) return infinity;
    double before = 0;
    double after = 0;
    for (const EnergiesOfChunk& each : energies_) {
      for (const Energies& of_range : each.of_ranges) {
        before += of_range.before;
        after += of_range.after;
      }
      before += each.others.before;
      after += each.others.after;
    }
    if (after == 0) return 0;
    const double gain = 1.1 * after / before;
    return is_finite(gain) ? gain : infinity;
  }

 private:
  static constexpr bool knows_energy = in_rows_of_four<P>();
  struct Energies {
    double before = 0;
    double after = 0;
  };

  // Most ranges begin at a multiple of range_size. No two have the same first particle, so that
  // such a range has a place of its own, and its thread need not wait for others.
  struct EnergiesOfChunk {
    // `first` is the first particle of the range, within the chunk.
    void add(Index first, const Energies& energies) {
      if (first % range_size == 0) {
        of_ranges[first / range_size] = energies;
        return;
      }
      const auto add_to = [](double& sum, double part) {
        std::atomic_ref<double>(sum).fetch_add(part, std::memory_order_relaxed);
      };
      add_to(others.before, energies.before);
      add_to(others.after, energies.after);
    }

    std::array<Energies, chunk_size / range_size> of_ranges{};
    Energies others;
  };

  PerChunk<EnergiesOfChunk> energies_;
  std::atomic<bool> is_valid_ = true;
  std::atomic<double> farthest_ = 0;
};

}  // namespace silt::detail
