// SPDX-License-Identifier: MIT
// Grains that go during a run.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/region.hpp>

#include <utility>

namespace silt::dem {

/// Observer that removes, before a step, the grains whose centres are in a region, and counts them.
/// A Box with one finite side is a region, too.
template <class R>
class Outflow {
 public:
  /// Throws if the region is none.
  explicit Outflow(R region) : region_(std::move(region)) { region_.check(); }

  Index number() const noexcept { return number_; }  ///< removed so far
  double mass() const noexcept { return mass_; }     ///< of those [kg]

  template <class Sim>
  void before_step(Sim& simulation) {
    auto& grains = simulation.particles();
    const auto is_in = [&](Index i) { return region_.clearance(grains[position][i]) >= 0; };
    if (first_where(grains.size(), is_in) == nowhere) return;
    for (Index i = 0; i < grains.size(); ++i) {
      if (is_in(i)) mass_ += double(grains[silt::mass][i]);
    }
    number_ += grains.remove_if(is_in);
  }

  /// All that it goes on from after a restart.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number_);
    archive("mass", mass_);
  }

 private:
  R region_;
  Index number_ = 0;
  double mass_ = 0;
};

}  // namespace silt::dem
