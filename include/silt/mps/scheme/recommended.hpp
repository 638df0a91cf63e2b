// SPDX-License-Identifier: MIT
// The recommended schemes; docs/theory_mps.md compares them with other policies.
#pragma once

#include <silt/mps/operator/corrected_gradient.hpp>
#include <silt/mps/operator/kernel.hpp>
#include <silt/mps/operator/laplacian.hpp>
#include <silt/mps/policy/balanced_source.hpp>
#include <silt/mps/policy/free_surface.hpp>
#include <silt/mps/policy/friction.hpp>
#include <silt/mps/policy/keep_apart.hpp>
#include <silt/mps/policy/outer_surface.hpp>
#include <silt/mps/policy/shifting.hpp>
#include <silt/mps/policy/wall_stress.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/wall/image_walls.hpp>
#include <silt/mps/wall/smooth_walls.hpp>

#include <concepts>

namespace silt::mps {

/// Walls are faces. Loads of impacts, and pressures below edges, converge to those of the fluid's
/// momentum; water rests in tanks that fit its lattice, in others it settles. In 3D, a step takes
/// about 1.2 times as long as that of Case10, in 2D 1.6 times.
struct Recommended {
  BalancedSource source{};
  KeepApart collision{.image_distance = 0.7};
  WendlandKernel kernel{};
  OuterSurface<BothConditions> surface{.criterion = {.first = {.beta = 0.9}, .second = {}}};
  CorrectedGradient gradient{};
  ImageWalls walls{};
  ParticleShifting shifting{};
  PairFriction friction{};
  FreeSlip wall_stress{};
  KernelLaplacian laplacian{};
};

/// The same as far as walls of wall and dummy particles allow it. Loads on them are too low, above
/// all those of impacts and below edges, and in 3D water beside vertical edges does not rest.
struct RecommendedForWallParticles : Recommended {
  KeepApart collision{};
  BothConditions surface{.first = {.beta = 0.9}, .second = {}};
  SmoothWalls walls{};
  NoFriction friction{};
};

/// Settings for flows without a free surface: without splashes a smaller minimum distance suffices,
/// which dissipates less energy, above all with walls of faces, and persistent strain needs more
/// shifting. Schemes with neither KeepApart nor ParticleShifting are returned unchanged.
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
