// SPDX-License-Identifier: MIT
// The eleven cases of [HwangLeePark2010] Table 1, from the original MPS (00) to PNU-MPS (10).
#pragma once

#include <silt/mps/collision.hpp>
#include <silt/mps/free_surface.hpp>
#include <silt/mps/kernel.hpp>
#include <silt/mps/laplacian.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/shifting.hpp>
#include <silt/mps/source.hpp>
#include <silt/mps/walls.hpp>

#include <ratio>

namespace silt::mps {

/// One policy for each column of Table 1, and three that the paper does not vary.
template <class SourceType, class CollisionType, class KernelType, class SurfaceType,
          class GradientType, class WallsType = GrainyWalls, class ShiftingType = NoShifting,
          class LaplacianType = KernelLaplacian>
struct Scheme {
  static_assert(PressureSource<SourceType>,
                "mps::Scheme: the first argument is not a pressure source (see PressureSource in "
                "silt/mps/source.hpp)");
  static_assert(CollisionModel<CollisionType>,
                "mps::Scheme: the second argument is not a collision model (see CollisionModel in "
                "silt/mps/collision.hpp)");
  static_assert(Kernel<KernelType>,
                "mps::Scheme: the third argument is not a kernel: it needs a static weight(q) for "
                "float and double (see Kernel in silt/mps/kernel.hpp)");
  static_assert(FreeSurface<SurfaceType>,
                "mps::Scheme: the fourth argument is not a free-surface criterion (see FreeSurface "
                "in silt/mps/free_surface.hpp)");
  static_assert(Gradient<GradientType, 2>,
                "mps::Scheme: the fifth argument is not a gradient (see Gradient in "
                "silt/mps/operators.hpp)");
  static_assert(WallModel<WallsType>,
                "mps::Scheme: the sixth argument is not a wall model (see WallModel in "
                "silt/mps/walls.hpp)");
  static_assert(Shifting<ShiftingType>,
                "mps::Scheme: the seventh argument is not a shifting model (see Shifting in "
                "silt/mps/shifting.hpp)");
  static_assert(LaplacianWeights<LaplacianType>,
                "mps::Scheme: the eighth argument does not provide Laplacian weights (see "
                "LaplacianWeights in silt/mps/laplacian.hpp)");

  using Source = SourceType;
  using Collision = CollisionType;
  using Kernel = KernelType;
  using Surface = SurfaceType;
  using Gradient = GradientType;
  using Walls = WallsType;
  using Shifting = ShiftingType;
  using Laplacian = LaplacianType;
};

using ShorterCollision = Collision<std::ratio<4, 5>, std::ratio<1, 5>>;  // (0.8, 0.2)
using PlasticCollision = Collision<std::ratio<1>, std::ratio<0>>;        // (1.0, 0.0)
using HigherRestitution = Collision<std::ratio<1>, std::ratio<2, 5>>;    // (1.0, 0.4)
using BothConditions = BothSurfaces<DensitySurface, CountSurface>;       // (13) and (17)

// clang-format off
//                    source            (a, b)             kernel          surface         gradient
using Case00 = Scheme<DensitySource,    OriginalCollision, InverseKernel,  DensitySurface, MinimumGradient>;
using Case01 = Scheme<DivergenceSource, OriginalCollision, InverseKernel,  DensitySurface, MinimumGradient>;
using Case02 = Scheme<DivergenceSource, OriginalCollision, GaussianKernel, DensitySurface, MinimumGradient>;
using Case03 = Scheme<DivergenceSource, OriginalCollision, CubicKernel,    DensitySurface, MinimumGradient>;
using Case04 = Scheme<DivergenceSource, ShorterCollision,  CubicKernel,    DensitySurface, MinimumGradient>;
using Case05 = Scheme<DivergenceSource, AdoptedCollision,  CubicKernel,    DensitySurface, MinimumGradient>;
using Case06 = Scheme<DivergenceSource, PlasticCollision,  CubicKernel,    DensitySurface, MinimumGradient>;
using Case07 = Scheme<DivergenceSource, HigherRestitution, CubicKernel,    DensitySurface, MinimumGradient>;
using Case08 = Scheme<DivergenceSource, AdoptedCollision,  CubicKernel,    CountSurface,   MinimumGradient>;
using Case09 = Scheme<DivergenceSource, AdoptedCollision,  CubicKernel,    BothConditions, MinimumGradient>;
using Case10 = Scheme<DivergenceSource, AdoptedCollision,  CubicKernel,    BothConditions, ConservingGradient>;
// clang-format on

}  // namespace silt::mps
