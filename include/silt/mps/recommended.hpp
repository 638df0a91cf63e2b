// SPDX-License-Identifier: MIT
// The recommended scheme; docs/theory_mps.md compares it with other policies.
#pragma once

#include <silt/mps/balanced_source.hpp>
#include <silt/mps/corrected_gradient.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/free_surface.hpp>
#include <silt/mps/friction.hpp>
#include <silt/mps/image_walls.hpp>
#include <silt/mps/keep_apart.hpp>
#include <silt/mps/kernel.hpp>
#include <silt/mps/laplacian.hpp>
#include <silt/mps/outer_surface.hpp>
#include <silt/mps/scheme.hpp>
#include <silt/mps/shifting.hpp>
#include <silt/mps/smooth_walls.hpp>
#include <silt/mps/wall_stress.hpp>

#include <concepts>

namespace silt::mps {

struct Recommended {
  BalancedSource source{};
  KeepApart collision{};
  WendlandKernel kernel{};
  BothConditions surface{.first = {.beta = 0.9}, .second = {}};
  CorrectedGradient gradient{};
  SmoothWalls walls{};
  ParticleShifting shifting{};
  NoFriction friction{};
  FreeSlip wall_stress{};
  KernelLaplacian laplacian{};
};

/// The same for walls of faces, with the pressures of impacts and below edges right, and water that
/// rests in any tank. In 3D, a step takes about twice as long.
struct RecommendedForFaces : Recommended {
  KeepApart collision{.image_distance = 0.7};
  OuterSurface<BothConditions> surface{.criterion = {.first = {.beta = 0.9}, .second = {}}};
  ImageWalls walls{};
  PairFriction friction{};
};

/// Settings for flows without a free surface: without splashes a smaller minimum distance suffices,
/// which dissipates less energy, above all with walls of faces, and persistent strain needs more
/// shifting. Schemes with neither
/// KeepApart nor ParticleShifting are returned unchanged.
template <int Dim, class Scheme>
FlowSettings<Dim, Scheme> without_free_surface(FlowSettings<Dim, Scheme> settings) {
  if constexpr (std::derived_from<CollisionOf<Scheme>, KeepApart>) {
    settings.collision.distance = std::derived_from<WallsOf<Scheme>, ImageWalls> ? 0.5 : 0.8;
  }
  if constexpr (std::derived_from<ShiftingOf<Scheme>, ParticleShifting>) {
    settings.shifting.strength = 10;
  }
  return settings;
}

}  // namespace silt::mps
