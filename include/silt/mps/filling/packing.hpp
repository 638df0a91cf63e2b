// SPDX-License-Identifier: MIT
// Moves the particles of a pool to where the recommended scheme leaves them at rest.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/filling/rest_equations.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/recommended.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace silt::mps::detail {

/// Particles of a pool that are moved apart, and then to a solution of RestEquations. There are
/// more unknowns than equations: each of Newton's steps is the shortest one.
template <int Dim>
class Packing {
 public:
  using Vec = silt::Vec<Dim>;

  /// The level is infinite if there is no surface.
  Packing(const FlowSettings<Dim, Recommended>& settings, double level,
          const std::vector<Vec>& points)
      : spacing_(settings.spacing), equations_(settings, level, points) {}

  /// Of the particles [m].
  auto positions() const { return equations_.positions(); }
  /// The largest of the residuals of the equations, over n0 and in spacings [-].
  double deviation() const { return deviation_; }
  /// Where it is [m].
  const Vec& place_of_deviation() const { return place_of_deviation_; }

  /// Moves the particles.
  void pack() {
    spread_out();
    come_to_rest();
  }

 private:
  // Numbers of iterations; in space, each takes ten times as long.
  static constexpr int spreading_rounds = 10, moves_per_round = 5;
  static constexpr int even_steps = Dim == 2 ? 30 : 15, most_steps = Dim == 2 ? 100 : 50;
  static constexpr int even_iterations = 20, most_iterations = 60;
  static constexpr int patience = Dim == 2 ? 8 : 3;
  static constexpr double tolerance = Dim == 2 ? 1e-7 : 1e-4;
  // Spacings: closer to walls, particles would collide with their images; on the surface, those
  // that are closer to it have too little pressure to be held below a wall that leans over them.
  static constexpr double clearance = 0.42, wished_clearance = 0.46, wished_depth = 0.3;

  // Moves particles apart: away from where they are crowded.
  void spread_out() {
    constexpr double strength = 0.3, most = 0.1;  // spacings
    moves_.resize(equations_.size());
    for (int round = 0; round < spreading_rounds; ++round) {
      find_neighbours();
      for (int k = 0; k < moves_per_round; ++k) {
        for_each(equations_.size(),
                 [&](Index i) { moves_[i] = strength * spacing_ * equations_.crowding(i); });
        move(most * spacing_);
      }
    }
  }

  // Newton's steps. In the first ones, particles move apart, too, as far as the equations allow.
  // Images appear and vanish where several edges of walls meet, so that a solution may not exist
  // where it is looked for: particles that get no nearer to one are displaced. The best state is
  // kept.
  void come_to_rest() {
    deviation_ = std::numeric_limits<double>::infinity();
    Buffer<Vec> best;
    int last_success = even_steps;
    for (int k = 0; k <= most_steps; ++k) {
      find_neighbours();
      equations_.linearise();
      const auto& residuals = equations_.residuals();
      const double largest_residual =
          largest(equations_.size(), 0.0, [&](Index i) { return std::abs(residuals[i]); });
      const bool is_even = k < even_steps;
      if (!is_even) {
        equations_.keep_active();
        if (largest_residual < deviation_) {
          if (largest_residual < deviation_ / 2) last_success = k;
          deviation_ = largest_residual;
          best.assign(begin_.begin(), begin_.end());
          const Index worst = first_where(equations_.size(), [&](Index i) {
            return std::abs(residuals[i]) == largest_residual;
          });
          if (worst != no_index) place_of_deviation_ = begin_[worst];
        }
        if (deviation_ < tolerance || k == most_steps) break;
      }
      const bool is_stuck = k - last_success > patience;
      if (is_stuck) last_success = k;
      wish(is_even);
      if (is_stuck) displace(0.1 * largest_residual, Index(k));
      equations_.slopes().find_moves(residuals, wishes_,
                                     is_even ? even_iterations : most_iterations, moves_);
      move(0.1 * spacing_);
    }
    std::copy(best.begin(), best.end(), equations_.positions().begin());
  }

  // Where particles should move, if the equations allow it.
  void wish(bool apart) {
    constexpr double strength = 0.2, part = 0.5;
    wishes_.resize(equations_.size());
    for_each(equations_.size(), [&](Index i) {
      wishes_[i] = apart ? Vec(strength * spacing_ * equations_.crowding(i)) : Vec(Vec::Zero());
      equations_.walls().for_each_wall(i, [&](const Vec& normal, double height) {
        wishes_[i] += part * std::max(0.0, wished_clearance * spacing_ - height) * normal;
      });
      if (!equations_.is_on_surface(i)) return;
      wishes_[i][Dim - 1] -= part * std::max(0.0, wished_depth * spacing_ - equations_.depth(i));
    });
  }
  // Particles with a larger residual than `least`.
  void displace(double least, Index round) {
    // Multiples of irrational numbers are as good as random ones.
    constexpr double irrational[] = {0.6180339887, 0.7548776662, 0.8191725134};
    constexpr double most = 0.05;  // spacings
    for_each(equations_.size(), [&](Index i) {
      if (!(std::abs(equations_.residuals()[i]) > least)) return;
      for (int axis = 0; axis < Dim; ++axis) {
        const double any = double(i + 1 + round) * irrational[axis];
        wishes_[i][axis] += most * spacing_ * (2 * (any - std::floor(any)) - 1);
      }
    });
  }

  void find_neighbours() {
    equations_.find_neighbours();
    begin_.assign(equations_.positions().begin(), equations_.positions().end());
  }
  // Moves particles by moves_, but by at most `most` [m], and not into walls.
  void move(double most) {
    const auto x = equations_.positions();
    for_each(equations_.size(), [&](Index i) {
      const double length = moves_[i].norm();
      const Vec part = length > most ? Vec(most / length * moves_[i]) : moves_[i];
      const Vec whole = x[i] + part - begin_[i];
      x[i] = begin_[i] + equations_.walls().before_walls(i, whole, clearance);
    });
  }

  double spacing_;  // [m]
  RestEquations<Dim> equations_;
  Buffer<Vec> begin_;  // where the neighbours were found
  Buffer<Vec> moves_, wishes_;
  double deviation_ = 0;
  Vec place_of_deviation_ = Vec::Zero();
};

}  // namespace silt::mps::detail
