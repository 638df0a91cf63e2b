// SPDX-License-Identifier: MIT
// The recommended scheme; docs/theory_mps.md compares it with other policies.
#pragma once

#include <silt/mps/cases.hpp>
#include <silt/mps/corrected_gradient.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/free_surface.hpp>
#include <silt/mps/keep_apart.hpp>
#include <silt/mps/kernel.hpp>
#include <silt/mps/shifting.hpp>
#include <silt/mps/source.hpp>
#include <silt/mps/walls.hpp>

#include <type_traits>

namespace silt::mps {

using Recommended =
    Scheme<BalancedSource, KeepApart, WendlandKernel, BothSurfaces<OutermostRow, CountSurface>,
           CorrectedGradient, SmoothWalls, ParticleShifting>;

/// Settings for flows without a free surface: without splashes a smaller minimum distance suffices,
/// which dissipates less energy, and persistent strain needs more shifting. Schemes with neither
/// KeepApart nor ParticleShifting are returned unchanged.
template <int Dim, class Scheme>
FlowSettings<Dim, Scheme> without_free_surface(FlowSettings<Dim, Scheme> settings) {
  if constexpr (std::is_same_v<typename Scheme::Collision, KeepApart>) {
    settings.collision.distance = 0.8;
  }
  if constexpr (std::is_same_v<typename Scheme::Shifting, ParticleShifting>) {
    settings.shifting.strength = 10;
  }
  return settings;
}

}  // namespace silt::mps
