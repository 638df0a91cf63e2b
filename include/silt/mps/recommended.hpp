// SPDX-License-Identifier: MIT
// The best set of choices found: docs/theory_mps.md says what each is worth, and against what.
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

namespace silt::mps {

using Recommended =
    Scheme<BalancedSource, KeepApart, WendlandKernel, BothSurfaces<OutermostRow, CountSurface>,
           CorrectedGradient, SmoothWalls, ParticleShifting>;

/// The same where fluid fills all there is: no splash needs keeping apart, which costs energy, and
/// strain that goes on and on needs more shifting.
template <int Dim>
FlowSettings<Dim, Recommended> without_free_surface(FlowSettings<Dim, Recommended> settings) {
  settings.collision.distance = 0.8;
  settings.shifting.strength = 10;
  return settings;
}

}  // namespace silt::mps
