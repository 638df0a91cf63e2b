// SPDX-License-Identifier: MIT
// What a model of the walls of a flow provides. Each model keeps its own state, in its own file.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/operator/kernel.hpp>
#include <silt/mps/operator/neighbourhood.hpp>
#include <silt/mps/operator/operators.hpp>
#include <silt/mps/policy/any_particle_view.hpp>
#include <silt/mps/policy/collision.hpp>

#include <concepts>
#include <type_traits>

namespace silt::mps {

namespace detail {

/// What a model of walls may use of FlowOperators and ClosePairs, to check it when it is compiled;
/// of NeighbourView, it is AnyNeighbourView.
template <int Dim>
struct AnyOperators {
  const Stencil<Dim, double, CubicKernel>& stencil() const;
  const Stencil<Dim, double, CubicKernel>& laplacian_stencil() const;
  double reach() const;
  const Neighbourhood<Dim, double>& neighbourhood() const;
  const Neighbourhood<Dim, double>& laplacian_neighbourhood() const;
};
template <int Dim>
struct AnyClosePairs {
  static constexpr int dimension = Dim;
  using Real = double;
  using Vec = silt::Vec<Dim>;

  Index index() const;
  Vec position() const;
  Index owner(Index j) const;
  Kind kind(Index j) const;
  template <class F>
  void for_each(F&& f) const;
  template <class F>
  void for_each_image(F&& f) const;
};

}  // namespace detail

/// The walls of a flow in Dim dimensions:
///
///   find(particles, operators)               after the neighbours have been found
///   divergence(at, u)                        ⟨∇·u⟩_i of the velocities u, from a NeighbourView
///   is_dry(at)                               a particle that counts as free surface, whatever the
///                                            criterion says
///   has_pressure(kind, on_surface)           whether a particle has a pressure
///   velocity_change(pairs, collision)        of a fluid particle, by its collisions, see
///   ClosePairs
template <class W, int Dim>
concept WallsInFlow =
    requires(W walls, const W found, const Fluid<Dim> particles,
             const detail::AnyOperators<Dim> operators, const detail::AnyNeighbourView<Dim> at,
             const detail::AnyClosePairs<Dim> pairs) {
      walls.find(particles, operators);
      { found.divergence(at, at.velocities()) } -> std::convertible_to<double>;
      { found.is_dry(at) } -> std::same_as<bool>;
      { found.has_pressure(Kind::fluid, true) } -> std::same_as<bool>;
      { found.velocity_change(pairs, Collision{}) } -> std::convertible_to<Vec<Dim>>;
    };

/// W::InFlow<Dim, Real> are the walls of a flow, constructed from a W. What they keep is neither
/// restored after a throw nor saved in a checkpoint: find() has to set all of it. If they have
/// check_start(particles, operators, gravity), the first step calls it after find(), to throw if they
/// do not hold the fluid.
template <class W>
concept WallModel = std::constructible_from<typename W::template InFlow<2, double>, const W&> &&
                    std::constructible_from<typename W::template InFlow<3, double>, const W&> &&
                    WallsInFlow<typename W::template InFlow<2, double>, 2> &&
                    WallsInFlow<typename W::template InFlow<3, double>, 3>;

namespace detail {

struct HasForEachImage {
  int for_each_image;
};
template <class W>
struct BothForEachImage : W, HasForEachImage {};
struct HasVisibleShare {
  int visible_share;
};
template <class W>
struct BothVisibleShare : W, HasVisibleShare {};
struct HasContinueFlow {
  int continue_flow;
};
template <class W>
struct BothContinueFlow : W, HasContinueFlow {};

}  // namespace detail

/// Walls that mirror the fluid: for_each_image(i, stencil, f) calls f(image) for every image within
/// the stencil around particle i. Images enter every sum over neighbours. An image has the members
/// of a Neighbour, with is_image = true and the index of the mirrored particle, which may be i, and
///
///   rise(g)           its pressure above that of the particle [Pa] if the pressure has the
///   gradient
///                     g [Pa/m]; of walls that move rise(g, density) instead, in fluid of this
///                     density [kg/m³] that moves with them
///   mirrored(u)       the mirrored velocity [m/s], with which particles collide
///   continues_flow()  whether velocity(u) is that of the flow continued beyond the wall, instead
///                     of the mirrored one
///   rise_along(u)     ∫u·dx [m²/s] in the continued flow, if there is one, from the particle to
///                     its image: ρ/Δt times this is the rise of P that stops the flow at the wall
template <class W>
concept AddsImages =
    !std::is_final_v<W> && !requires { &detail::BothForEachImage<W>::for_each_image; };

/// The pressure of an image above that of its particle [Pa], in fluid of this density [kg/m³] and
/// weight per volume [Pa/m] that is at rest, or moves with the walls.
template <class Image, class Vec, class Real>
Real rise_at_rest(const Image& image, const Vec& weight, Real density) {
  if constexpr (requires { image.rise(weight, density); }) {
    return image.rise(weight, density);
  } else {
    return image.rise(weight);
  }
}

/// Walls with images that also have continue_flow(particles, operators), called before the pressure
/// equation is assembled, except with sources that need moved particles: images may then continue
/// the flow of the velocities u* until the pressure has changed them.
template <class W>
concept ContinuesFlow = AddsImages<W> && !requires { &detail::BothContinueFlow<W>::continue_flow; };

/// Walls that may move: begin_step(time, time_step, spacing) is called first in a step,
/// longest_step(time, distance) limits the time step, max_speed() is that of a wall in the step
/// [m/s]. save(), restore() and transfer(archive) as in an interaction.
template <class W>
concept MovesWalls = requires(W walls, const W found, double t) {
  walls.begin_step(t, t, t);
  { found.longest_step(t, t) } -> std::same_as<double>;
  { found.max_speed() } -> std::same_as<double>;
  { found.move() } -> std::same_as<bool>;
  walls.save();
  walls.restore();
};

/// Wall models with all_have_pressure = true: has_pressure() of theirs is always true, and is not
/// looked up for every neighbour.
template <class W>
concept AllHavePressure = requires { requires bool(W::all_have_pressure); };

/// Walls that hide particles from each other: locate(particles, search, operators) is called before
/// the neighbours are found, and j is a neighbour of i, with its weight times visible_share(i, j),
/// if this is positive; sees_all(i) tells whether it is 1 for all of them. before_walls(i, move) is
/// the part of a move [m] that does not go into a wall; check_moves(particles) throws if one has gone
/// through a wall.
template <class W>
concept HidesNeighbours =
    !std::is_final_v<W> && !requires { &detail::BothVisibleShare<W>::visible_share; };

}  // namespace silt::mps
