// SPDX-License-Identifier: MIT
// What a scheme is: a struct with one member for each policy of a flow. The type of a member is the
// policy, its value has the parameters of the policy:
//
//   struct Mine : mps::Recommended {  // a member that is declared again replaces the inherited one
//     mps::Collision collision{.distance = 0.8, .restitution = 0.2};
//   };
//   mps::Flow<Mine> water{{.spacing = 0.01}};
//
// The members, and the concepts that they model:
//   source       PressureSource         walls        WallModel
//   collision    CollisionModel         shifting     Shifting
//   kernel       Kernel                 friction     Friction
//   surface      FreeSurface            wall_stress  WallStress
//   gradient     Gradient               laplacian    LaplacianWeights
// Schemes of Silt: Case00 to Case10, Recommended and RecommendedForWallParticles.
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
#include <silt/mps/wall/walls.hpp>

#include <concepts>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

namespace silt::mps {

/// Type of the policy `source` of a scheme.
template <class Scheme>
using SourceOf = std::remove_cv_t<decltype(Scheme::source)>;
/// n* of moved particles already includes what has gone towards walls.
template <class Scheme>
inline constexpr bool counts_flow_to_walls = SourceOf<Scheme>::needs_moved_particles;
/// Type of the policy `collision` of a scheme.
template <class Scheme>
using CollisionOf = std::remove_cv_t<decltype(Scheme::collision)>;
/// Type of the policy `kernel` of a scheme.
template <class Scheme>
using KernelOf = std::remove_cv_t<decltype(Scheme::kernel)>;
/// Type of the policy `surface` of a scheme.
template <class Scheme>
using SurfaceOf = std::remove_cv_t<decltype(Scheme::surface)>;
/// Type of the policy `gradient` of a scheme.
template <class Scheme>
using GradientOf = std::remove_cv_t<decltype(Scheme::gradient)>;
/// Type of the policy `walls` of a scheme.
template <class Scheme>
using WallsOf = std::remove_cv_t<decltype(Scheme::walls)>;
/// Type of the policy `shifting` of a scheme.
template <class Scheme>
using ShiftingOf = std::remove_cv_t<decltype(Scheme::shifting)>;
/// Type of the policy `friction` of a scheme.
template <class Scheme>
using FrictionOf = std::remove_cv_t<decltype(Scheme::friction)>;
/// Type of the policy `wall_stress` of a scheme.
template <class Scheme>
using WallStressOf = std::remove_cv_t<decltype(Scheme::wall_stress)>;
/// Type of the policy `laplacian` of a scheme.
template <class Scheme>
using LaplacianOf = std::remove_cv_t<decltype(Scheme::laplacian)>;
/// Whether a scheme is one InMixture, or derived from one: see silt/mps/scheme/mixture.hpp.
template <class Scheme>
inline constexpr bool is_in_mixture = requires { requires Scheme::is_in_mixture; };

namespace detail {

// Initialises any base class or member of an aggregate.
struct AnyElement {
  template <class T>
  operator T() const;
};

// Number of base classes and members of an aggregate.
template <class S, std::size_t most = 16>
constexpr std::size_t count_elements() {
  constexpr auto has_most = []<std::size_t... k>(std::index_sequence<k...>) {
    return requires { S{(static_cast<void>(k), AnyElement{})...}; };
  };
  if constexpr (most == 0 || has_most(std::make_index_sequence<most>{})) {
    return most;
  } else {
    return count_elements<S, most - 1>();
  }
}

template <class S, class Pointer>
inline constexpr bool is_member_of = false;
template <class S, class Member>
inline constexpr bool is_member_of<S, Member S::*> = true;

template <class S>
constexpr auto policies_of() {
  return std::tuple(&S::source, &S::collision, &S::kernel, &S::surface, &S::gradient, &S::walls,
                    &S::shifting, &S::friction, &S::wall_stress, &S::laplacian);
}

// Whether a member has another name than the policies: it would have no effect. A scheme that
// declares all policies itself has no misspelt one, and may have further members.
template <class S>
constexpr bool has_unknown_member() {
  if constexpr (std::is_aggregate_v<S>) {
    // A pointer to an inherited member is one of the base.
    const auto count = []<class... Pointer>(Pointer...) {
      return (std::size_t(is_member_of<S, Pointer>) + ...);
    };
    constexpr std::size_t own = std::apply(count, policies_of<S>());
    constexpr std::size_t all = std::tuple_size_v<decltype(policies_of<S>())>;
    return own < all && count_elements<S>() > own + 1;
  } else {
    return false;
  }
}

}  // namespace detail

/// Names the member of a scheme that is missing or no such policy. Instantiated by FlowSettings.
template <class S>
constexpr bool check_scheme() {
  static_assert(std::default_initializable<S>, "mps: the scheme cannot be constructed by default");
  static_assert(requires { requires PressureSource<SourceOf<S>>; },
                "mps: the scheme has no member `source` that is a pressure source (see "
                "PressureSource in silt/mps/policy/source.hpp)");
  static_assert(requires { requires CollisionModel<CollisionOf<S>>; },
                "mps: the scheme has no member `collision` that is a collision model (see "
                "CollisionModel in silt/mps/policy/collision.hpp)");
  static_assert(requires { requires Kernel<KernelOf<S>>; },
                "mps: the scheme has no member `kernel` that is a kernel: it needs a weight(q) for "
                "float and double (see Kernel in silt/mps/operator/kernel.hpp)");
  static_assert(requires { requires FreeSurface<SurfaceOf<S>>; },
                "mps: the scheme has no member `surface` that is a free-surface criterion (see "
                "FreeSurface in silt/mps/policy/free_surface.hpp)");
  static_assert(requires { requires Gradient<GradientOf<S>, 2> && Gradient<GradientOf<S>, 3>; },
                "mps: the scheme has no member `gradient` that is a gradient (see Gradient in "
                "silt/mps/operator/operators.hpp)");
  static_assert(requires { requires WallModel<WallsOf<S>>; },
                "mps: the scheme has no member `walls` that is a wall model (see WallModel in "
                "silt/mps/wall/walls.hpp)");
  static_assert(requires { requires Shifting<ShiftingOf<S>>; },
                "mps: the scheme has no member `shifting` that is a shifting model (see Shifting "
                "in silt/mps/policy/shifting.hpp)");
  static_assert(requires { requires Friction<FrictionOf<S>>; },
                "mps: the scheme has no member `friction` that is a friction (see Friction in "
                "silt/mps/policy/friction.hpp)");
  static_assert(requires { requires WallStress<WallStressOf<S>>; },
                "mps: the scheme has no member `wall_stress` that is a viscous stress of walls (see "
                "WallStress in silt/mps/policy/wall_stress.hpp)");
  static_assert(requires { requires LaplacianWeights<LaplacianOf<S>>; },
                "mps: the scheme has no member `laplacian` with the weights of a Laplacian (see "
                "LaplacianWeights in silt/mps/operator/laplacian.hpp)");
  static_assert(!std::is_final_v<SourceOf<S>> &&
                    !std::is_final_v<typename WallsOf<S>::template InFlow<2, double>>,
                "mps: a final source or wall model; declare it without final, so that its optional "
                "members can be found");
  static_assert(!detail::has_unknown_member<S>(),
                "mps: the scheme has a member that is none of source, collision, kernel, surface, "
                "gradient, walls, shifting, friction, wall_stress and laplacian: check its name");
  return true;
}

}  // namespace silt::mps
