// SPDX-License-Identifier: MIT
// The eleven cases of [HwangLeePark2010] Table 1, from the original MPS (00) to PNU-MPS (10). Each
// changes one policy of another, as in the paper.
#pragma once

#include <silt/mps/operator/kernel.hpp>
#include <silt/mps/operator/laplacian.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/policy/collision.hpp>
#include <silt/mps/policy/free_surface.hpp>
#include <silt/mps/policy/friction.hpp>
#include <silt/mps/policy/shifting.hpp>
#include <silt/mps/policy/source.hpp>
#include <silt/mps/policy/wall_stress.hpp>
#include <silt/mps/wall/grainy_walls.hpp>

namespace silt::mps {

/// Case 00 of [HwangLeePark2010], the original MPS: source (9), kernel (3a), free surface (13),
/// gradient (4), and collisions below 0.5 l0 with the restitution 0.2.
struct Case00 {
  DensitySource source{};
  Collision collision{.distance = 0.5, .restitution = 0.2};
  InverseKernel kernel{};
  DensitySurface surface{};
  MinimumGradient gradient{};
  // The paper does not vary these.
  GrainyWalls walls{};
  NoShifting shifting{};
  NoFriction friction{};
  FreeSlip wall_stress{};
  KernelLaplacian laplacian{};
};

/// Case00 with source (16).
struct Case01 : Case00 {
  DivergenceSource source{};
};
/// Case01 with kernel (3b).
struct Case02 : Case01 {
  GaussianKernel kernel{};
};
/// Case01 with kernel (3c).
struct Case03 : Case01 {
  CubicKernel kernel{};
};
/// Case03 with collisions below 0.8 l0 and the restitution 0.2.
struct Case04 : Case03 {
  Collision collision{.distance = 0.8, .restitution = 0.2};
};
/// Case03 with collisions below l0 and the restitution 0.2.
struct Case05 : Case03 {
  Collision collision{.distance = 1.0, .restitution = 0.2};
};
/// Case03 with collisions below l0 and the restitution 0.
struct Case06 : Case03 {
  Collision collision{.distance = 1.0, .restitution = 0.0};
};
/// Case03 with collisions below l0 and the restitution 0.4.
struct Case07 : Case03 {
  Collision collision{.distance = 1.0, .restitution = 0.4};
};
/// Case05 with free surface (17).
struct Case08 : Case05 {
  CountSurface surface{};
};
/// Case05 with a free `surface` on which both (13) and (17) hold.
struct Case09 : Case05 {
  BothConditions surface{};
};
/// PNU-MPS: Case09 with gradient (18).
struct Case10 : Case09 {
  ConservingGradient gradient{};
};

}  // namespace silt::mps
