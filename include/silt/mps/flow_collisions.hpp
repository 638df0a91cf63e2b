// SPDX-License-Identifier: MIT
// The collisions of the particles of a flow: the close pairs for which a collision model is
// evaluated, and the sum of the changes at each particle.
#pragma once

#include <silt/core/types.hpp>
#include <silt/mps/collision.hpp>
#include <silt/mps/flow_operators.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>

#include <algorithm>

namespace silt::mps {

/// All collisions of a step, computed from the velocities before them. Refers to its arguments;
/// velocities of ghosts must be up to date.
template <class Scheme, FluidParticles P>
class FlowCollisions {
 public:
  static constexpr int Dim = P::dimension;
  using Real = typename P::Real;
  using Vec = silt::Vec<Dim, Real>;
  using Operators = FlowOperators<Scheme, Dim, Real>;
  using Settings = FlowSettings<Dim, Scheme>;

  /// time_step is Δt [s].
  FlowCollisions(const P& particles, const Operators& operators, const Settings& settings,
                 double time_step)
      : particles_(particles),
        operators_(operators),
        model_(settings.collision),
        spacing_(Real(settings.spacing)),
        time_step_(Real(time_step)),
        reach_(Real(model_.reach() * settings.spacing)),
        // Weights decrease with the distance; the factor is a margin for round-off.
        min_weight_(static_cast<float>(operators.stencil().weight(reach_)) * (1 - 0x1p-16f)) {}

  /// Change of the velocity of a fluid particle [m/s].
  Vec velocity_change(Index i) const {
    const auto u = particles_.with_ghosts(velocity);
    const auto kinds = particles_.with_ghosts(kind);
    Vec change = Vec::Zero();
    Vec by_walls = Vec::Zero();
    operators_.neighbourhood().for_each_closer(
        i, reach_, min_weight_, [&](Index j, const Vec& r_ij, Real r) {
          CollidingPair<Dim, Real> pair{.r_ij = r_ij,
                                        .r = r,
                                        .u_ij = u[j] - u[i],
                                        .wall = kinds[j] != Kind::fluid,
                                        .spacing = spacing_,
                                        .time_step = time_step_};
          if (Scheme::Walls::smooth && pair.wall) {
            const Vec& normal = operators_.normals()[particles_.owner(j)];
            if (kinds[j] == Kind::dummy || !project_onto_normal(pair, normal)) return;
            // Several particles form one wall: only the largest change along each normal is used.
            const Vec by_wall = model_.velocity_change(pair);
            by_walls += std::max(Real(0), normal.dot(by_wall - by_walls)) * normal;
            return;
          }
          change += model_.velocity_change(pair);
        });
    return change + by_walls;
  }

 private:
  // Projects a pair with a wall particle onto the wall's normal. False if the fluid particle is
  // behind the wall, or laterally closer to another wall particle.
  static bool project_onto_normal(CollidingPair<Dim, Real>& pair, const Vec& normal) {
    const Vec along = normal.dot(pair.r_ij) * normal;
    const Real across2 = (pair.r_ij - along).squaredNorm();
    if (across2 > Real(0.2501) * (Dim - 1) * squared(pair.spacing)) return false;
    if (!(normal.dot(pair.r_ij) < 0)) return false;
    pair.r_ij = along;
    pair.r = along.norm();
    pair.u_ij = normal.dot(pair.u_ij) * normal;
    return true;
  }

  const P& particles_;
  const Operators& operators_;
  const typename Scheme::Collision& model_;
  Real spacing_;
  Real time_step_;
  Real reach_;
  float min_weight_;
};

}  // namespace silt::mps
