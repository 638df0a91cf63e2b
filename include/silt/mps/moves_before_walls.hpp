// SPDX-License-Identifier: MIT
// Moves of fluid particles that end before walls of shapes.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/walls.hpp>

namespace silt::mps {

/// Ends the moves of a time step Δt [s] before walls that hide neighbours; with other walls, moves
/// are as they are.
template <class Walls, class Vec>
class MovesBeforeWalls {
 public:
  using Real = typename Vec::Scalar;

  MovesBeforeWalls(const Walls& walls, Real time_step) : walls_(walls), dt_(time_step) {}

  /// The change [m/s] of the velocity u of particle i with which Δt (u + change) ends before walls.
  Vec change([[maybe_unused]] Index i, [[maybe_unused]] const Vec& u, const Vec& change) const {
    if constexpr (HidesNeighbours<Walls>) {
      const Vec move = dt_ * (u + change);
      return change + (walls_.before_walls(i, move) - move) / dt_;
    } else {
      return change;
    }
  }
  /// The shift [m] of particle i with which Δt u + shift ends before walls.
  Vec shift([[maybe_unused]] Index i, [[maybe_unused]] const Vec& u, const Vec& shift) const {
    if constexpr (HidesNeighbours<Walls>) {
      const Vec move = dt_ * u;
      return walls_.before_walls(i, shift + move) - move;
    } else {
      return shift;
    }
  }

 private:
  const Walls& walls_;
  Real dt_;
};

/// Throws if a particle went through a wall that hides neighbours since the neighbours were found.
template <class Walls, class P>
void check_moves([[maybe_unused]] const Walls& walls, [[maybe_unused]] const P& particles) {
  if constexpr (HidesNeighbours<Walls>) walls.check_moves(particles);
}

}  // namespace silt::mps
