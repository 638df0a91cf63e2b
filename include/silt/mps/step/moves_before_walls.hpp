// SPDX-License-Identifier: MIT
// Moves of fluid particles that end before walls of shapes.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/step/advection.hpp>
#include <silt/mps/view/particle_view.hpp>
#include <silt/mps/wall/walls.hpp>

namespace silt::mps {

/// Ends the moves of a step, with the present velocities of the particles, before walls that hide
/// neighbours; with other walls, moves are as they are. Refers to its arguments.
template <class Scheme, FluidParticles P>
class MovesBeforeWalls {
 public:
  using Real = typename P::Real;
  using Vec = typename P::Vec;

  /// For the particles of this step; see Advection.
  MovesBeforeWalls(const StepView<Scheme, P>& step, const Advection<Vec>& advection)
      : step_(step), advection_(advection) {}

  /// The change [m/s] of the velocity of particle i with which its move ends before walls.
  Vec change([[maybe_unused]] Index i, const Vec& change) const {
    if constexpr (hides_neighbours) {
      const Vec move = dt_ * (advection_.rest(u_, i) + change);
      return change + (step_.operators.walls().before_walls(i, move) - move) / dt_;
    } else {
      return change;
    }
  }
  /// The shift [m] of particle i with which that and its move end before walls.
  Vec shift([[maybe_unused]] Index i, const Vec& shift) const {
    if constexpr (hides_neighbours) {
      const Vec move = dt_ * advection_.rest(u_, i);
      return step_.operators.walls().before_walls(i, shift + move) - move;
    } else {
      return shift;
    }
  }

 private:
  static constexpr bool hides_neighbours =
      HidesNeighbours<typename WallsOf<Scheme>::template InFlow<P::dimension, Real>>;

  const StepView<Scheme, P>& step_;
  const Advection<Vec>& advection_;
  decltype(step_.particles[velocity]) u_ = step_.particles[velocity];
  Real dt_ = Real(step_.time_step);
};

}  // namespace silt::mps
