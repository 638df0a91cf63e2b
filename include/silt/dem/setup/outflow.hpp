// SPDX-License-Identifier: MIT
// Removes grains during a run.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/setup/region.hpp>
#include <silt/dem/setup/schedule.hpp>

#include <utility>

namespace silt::dem {

/// Observer that removes, before a step, the grains whose centres are in a region, and counts them.
/// The region may be unbounded, e.g. a Box with a single finite side.
template <class R>
class Outflow {
 public:
  struct Settings {
    double every = 0;  ///< time between two checks [s]; 0: every step
  };

  /// Throws if the region is invalid or the time is negative.
  explicit Outflow(R region) : Outflow(std::move(region), {}) {}
  Outflow(R region, Settings settings) : region_(std::move(region)), settings_(settings) {
    region_.check();
    require_not_negative("Outflow: every", settings_.every);
  }

  Index number() const noexcept { return number_; }  ///< removed so far
  double mass() const noexcept { return mass_; }     ///< of the removed grains [kg]

  template <class Sim>
  void before_step(Sim& simulation) {
    if (!schedule_.is_due({.since = simulation.time(), .every = settings_.every})) return;
    auto& grains = simulation.particles();
    const auto is_in = [&](Index i) { return region_.clearance(grains[position][i]) >= 0; };
    if (first_where(grains.size(), is_in) == no_index) return;
    for (Index i = 0; i < grains.size(); ++i) {
      if (is_in(i)) mass_ += double(grains[silt::mass][i]);
    }
    number_ += grains.remove_if(is_in);
  }

  /// State for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number_);
    archive("mass", mass_);
    archive("checks", schedule_.number);
  }

 private:
  R region_;
  Settings settings_;
  Schedule schedule_;
  Index number_ = 0;
  double mass_ = 0;
};

template <class R>
Outflow(R, typename Outflow<R>::Settings) -> Outflow<R>;

}  // namespace silt::dem
