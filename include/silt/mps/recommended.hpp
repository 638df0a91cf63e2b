// SPDX-License-Identifier: MIT
// The best set of choices found: docs/theory_mps.md says what each is worth, and against what.
#pragma once

#include <silt/mps/cases.hpp>
#include <silt/mps/corrected_gradient.hpp>
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

}  // namespace silt::mps
