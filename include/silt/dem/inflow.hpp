// SPDX-License-Identifier: MIT
// Grains that come during a run: rain at a rate, or as many as find room, up to a number.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/random.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/schedule.hpp>
#include <silt/dem/packing.hpp>
#include <silt/dem/region.hpp>
#include <silt/dem/size_distribution.hpp>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace silt::dem {

/// Observer that puts new grains into a region before a step, where they touch none. The k-th grain
/// has the random numbers of the stream (seed, k): they depend on nothing that happens in the run.
/// One that finds no room waits, and those behind it with it, so that the sizes stay those of the
/// blend.
template <class R, SizeDistribution Sizes>
class Inflow {
 public:
  using Bounds = BoundsOf<R>;
  using Vec = decltype(Bounds::lower);
  using Real = typename Vec::Scalar;

  struct Settings {
    Index number = 0;                 ///< of grains in all
    std::optional<double> rate = {};  ///< grains per second, the first at once; none: all that fit
    double from = 0;                  ///< when the first comes [s]
    Vec velocity = Vec::Zero();       ///< that grains come with [m/s]
    double every = 0;                 ///< time between two looks for room [s]; 0: every step
    Index tries = 100;                ///< places tried for a grain at one look
    std::uint64_t seed = 0;
  };

  /// Throws if the region, the blend or a setting is out of range.
  Inflow(R region, Blend<Sizes> blend, const Settings& settings)
      : region_(std::move(region)), blend_(std::move(blend)), settings_(settings) {
    region_.check();
    blend_.check();
    if (settings_.rate) require_positive("Inflow: rate", *settings_.rate);
    require_finite("Inflow: from", settings_.from);
    require_finite("Inflow: velocity", settings_.velocity);
    require_not_negative("Inflow: every", settings_.every);
  }

  /// Grains that have come so far.
  Index number() const noexcept { return came_; }
  bool is_done() const noexcept { return came_ == settings_.number; }

  template <class Sim>
  void before_step(Sim& simulation) {
    const double since = simulation.time() - settings_.from;
    if (since < 0 || came_ >= due(since)) return;
    if (!looks_.is_due({.since = since, .every = settings_.every})) return;
    let_in(simulation.particles(), due(since));
  }

  /// All that it goes on from after a restart.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("came", came_);
    archive("tried", tried_);
    archive("looks", looks_.number);
  }

 private:
  Index due(double since) const {
    if (!settings_.rate) return settings_.number;
    const double coming = std::min(*settings_.rate * since, double(settings_.number));
    return std::min(settings_.number, 1 + completed_intervals(coming));
  }

  template <class P>
  void let_in(P& grains, Index most) {
    Placement<R, P::dimension, Real> placement(grains, region_, blend_.sizes.largest());
    while (came_ < most) {
      Random random{.seed = settings_.seed, .id = came_};
      const Grain grain = blend_.draw(random);
      random.counter += tried_;
      const auto drawn = random.counter;
      const auto ball = placement.find(random, Real(grain.radius), settings_.tries);
      tried_ += random.counter - drawn;
      if (!ball) return;
      const Index i = add_grain(grains, ball->centre, grain);
      grains[velocity][i] = settings_.velocity;
      ++came_;
      tried_ = 0;
    }
  }

  R region_;
  Blend<Sizes> blend_;
  Settings settings_;
  Index came_ = 0;
  std::uint64_t tried_ = 0;  // random numbers used up to find room for the one that waits
  Schedule looks_;
};

template <class R, class Sizes>
Inflow(R, Blend<Sizes>, typename Inflow<R, Sizes>::Settings) -> Inflow<R, Sizes>;

}  // namespace silt::dem
