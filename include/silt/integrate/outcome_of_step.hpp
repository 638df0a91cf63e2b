// SPDX-License-Identifier: MIT
// What a step of the leapfrog did to the particles: are the results valid, how far did particles
// move, and how much kinetic energy did they gain?
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/motion.hpp>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>

namespace silt::detail {

/// What a step did to a range of particles, see MotionOf::Outcome.
template <class P>
struct OutcomeOfRange {
  bool is_valid = true;
  typename P::Real squared_displacement = 0;  ///< maximum [m²]
  typename MotionOf<P>::Energies energies{};
};

/// What it did to all ranges; any thread may add one.
template <class P>
class OutcomeOfStep {
  using Real = typename P::Real;

 public:
  /// For n particles.
  explicit OutcomeOfStep(Index n) : energies_(MotionOf<P>::knows_energy ? n : 0, {}) {}

  /// `first` is the first particle of the range.
  void add(Index first, const OutcomeOfRange<P>& outcome) {
    if constexpr (MotionOf<P>::knows_energy) {
      energies_[first / chunk_size].add(first % chunk_size, outcome.energies);
    }
    if (!outcome.is_valid) is_valid_.store(false, std::memory_order_relaxed);
    Real highest = farthest_.load(std::memory_order_relaxed);
    while (outcome.squared_displacement > highest &&
           !farthest_.compare_exchange_weak(highest, outcome.squared_displacement,
                                            std::memory_order_relaxed)) {
    }
  }
  bool is_valid() const { return is_valid_.load(std::memory_order_relaxed); }
  /// [m], rounded up; infinity if a result is not valid
  double max_displacement() const {
    if (!is_valid()) return std::numeric_limits<double>::infinity();
    return std::sqrt(double(farthest_.load(std::memory_order_relaxed))) *
           (1 + 4 * double(std::numeric_limits<Real>::epsilon()));
  }
  /// See FinishedStep. Rounded up by more than the round-off of the sums, which depends on the
  /// order of the ranges.
  double max_energy_gain() const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    if constexpr (!MotionOf<P>::knows_energy) return infinity;
    double before = 0;
    double after = 0;
    for (const EnergiesOfChunk& each : energies_) {
      before += each.sum(&Energies::before) + each.others_before;
      after += each.sum(&Energies::after) + each.others_after;
    }
    if (after == 0) return 0;
    const double gain = 1.1 * after / before;
    return is_finite(gain) ? gain : infinity;
  }

 private:
  using Energies = typename MotionOf<P>::Energies;

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
      add_to(others_before, MotionOf<P>::sum_of(energies.before));
      add_to(others_after, MotionOf<P>::sum_of(energies.after));
    }
    template <class Member>
    double sum(Member energy) const {
      auto all = of_ranges[0].*energy;
      for (Index k = 1; k < of_ranges.size(); ++k) all += of_ranges[k].*energy;
      return MotionOf<P>::sum_of(all);
    }

    std::array<Energies, chunk_size / range_size> of_ranges{};
    double others_before = 0;
    double others_after = 0;
  };

  PerChunk<EnergiesOfChunk> energies_;
  std::atomic<bool> is_valid_ = true;
  std::atomic<Real> farthest_ = 0;
};

}  // namespace silt::detail
