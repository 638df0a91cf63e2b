// SPDX-License-Identifier: MIT
// Room for grains in water that was begun without them.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/weights.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <cmath>
#include <cstdint>

namespace silt::coupled {

/// How grains and the fluid around them are seen.
struct Surroundings {
  double spacing = 0;   ///< l0 of the fluid [m]
  double radius = 3.1;  ///< FlowSettings::radius [-]
};

/// Removes as many particles of the fluid as the grains in it displace, evenly, where they are, so
/// that the level stays. Returns their number. What remains comes to rest by
/// Coupled::let_fluid_settle(). Throws if the spacing is not positive, or if there would be no
/// fluid among grains.
template <class Fluid, class Grains>
Index make_room(Fluid& fluid, const Grains& grains, const Surroundings& around) {
  constexpr int Dim = Fluid::dimension;
  using Real = typename Fluid::Real;
  require_positive("make_room: spacing", around.spacing);
  const double particle = std::pow(around.spacing, Dim);
  Weights<Dim, Real> weights;
  weights.find(std::as_const(fluid)[position], grains[position], fluid.box(),
               Real(weights.reach_for(around.radius) * around.spacing));
  const auto R = grains[radius];
  const Real full =
      Real(Weights<Dim, Real>::integral() * std::pow(weights.reach_for(around.radius), Dim));
  Buffer<std::uint8_t> is_removed(fluid.size(), 0);
  double sum = 0.5;
  for (Index i = 0; i < fluid.size(); ++i) {
    weights.for_each_grain(i, [&](Index k, Real weight) {
      // Not of those above the surface.
      if (weights.sum(k) < full / 4) return;
      sum += double(weight) * dem::volume_of<Dim>(double(R[k])) / particle;
    });
    if (sum < 1) continue;
    is_removed[i] = 1;
    sum -= 1;
  }
  if (sum >= 1) {
    fail({"make_room: the grains displace ", sum,
          " more particles than are around them; let them overlap less, or use a smaller spacing"});
  }
  return fluid.remove_if([&](Index i) { return is_removed[i] != 0; });
}

}  // namespace silt::coupled
