// SPDX-License-Identifier: MIT
// What a scheme is: a struct with one member for each policy of a flow. The type of a member is the
// policy, its value are the numbers of the policy:
//
//   struct Mine : mps::Recommended {  // a member that is declared again replaces the inherited one
//     mps::Collision collision{.distance = 0.8, .restitution = 0.2};
//   };
//   mps::Flow<Mine> water{{.spacing = 0.01}};
#pragma once

#include <silt/mps/collision.hpp>
#include <silt/mps/free_surface.hpp>
#include <silt/mps/kernel.hpp>
#include <silt/mps/laplacian.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/shifting.hpp>
#include <silt/mps/source.hpp>
#include <silt/mps/walls.hpp>

#include <concepts>

namespace silt::mps {

template <class Scheme>
using SourceOf = decltype(Scheme::source);
template <class Scheme>
using CollisionOf = decltype(Scheme::collision);
template <class Scheme>
using KernelOf = decltype(Scheme::kernel);
template <class Scheme>
using SurfaceOf = decltype(Scheme::surface);
template <class Scheme>
using GradientOf = decltype(Scheme::gradient);
template <class Scheme>
using WallsOf = decltype(Scheme::walls);
template <class Scheme>
using ShiftingOf = decltype(Scheme::shifting);
template <class Scheme>
using LaplacianOf = decltype(Scheme::laplacian);

/// Names the member of a scheme that is missing or no such policy. Instantiated by FlowSettings.
template <class S>
constexpr bool check_scheme() {
  static_assert(std::default_initializable<S>, "mps: the scheme cannot be constructed by default");
  static_assert(requires { requires PressureSource<SourceOf<S>>; },
                "mps: the scheme has no member `source` that is a pressure source (see "
                "PressureSource in silt/mps/source.hpp)");
  static_assert(requires { requires CollisionModel<CollisionOf<S>>; },
                "mps: the scheme has no member `collision` that is a collision model (see "
                "CollisionModel in silt/mps/collision.hpp)");
  static_assert(requires { requires Kernel<KernelOf<S>>; },
                "mps: the scheme has no member `kernel` that is a kernel: it needs a weight(q) for "
                "float and double (see Kernel in silt/mps/kernel.hpp)");
  static_assert(requires { requires FreeSurface<SurfaceOf<S>>; },
                "mps: the scheme has no member `surface` that is a free-surface criterion (see "
                "FreeSurface in silt/mps/free_surface.hpp)");
  static_assert(requires { requires Gradient<GradientOf<S>, 2> && Gradient<GradientOf<S>, 3>; },
                "mps: the scheme has no member `gradient` that is a gradient (see Gradient in "
                "silt/mps/operators.hpp)");
  static_assert(requires { requires WallModel<WallsOf<S>>; },
                "mps: the scheme has no member `walls` that is a wall model (see WallModel in "
                "silt/mps/walls.hpp)");
  static_assert(requires { requires Shifting<ShiftingOf<S>>; },
                "mps: the scheme has no member `shifting` that is a shifting model (see Shifting "
                "in silt/mps/shifting.hpp)");
  static_assert(requires { requires LaplacianWeights<LaplacianOf<S>>; },
                "mps: the scheme has no member `laplacian` with the weights of a Laplacian (see "
                "LaplacianWeights in silt/mps/laplacian.hpp)");
  return true;
}

}  // namespace silt::mps
