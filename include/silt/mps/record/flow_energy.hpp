// SPDX-License-Identifier: MIT
// Energy balance of a flow. A step changes the velocity of a particle by several terms,
//
//   u^{n+1} − u^n = Δt g + Δt f + Δt ν∇²u + friction + collisions − (Δt/ρ) ∇P,
//
// and with the mean velocity ū = (u^n + u^{n+1})/2 the work of each term is defined:
//
//   ½ m |u^{n+1}|² − ½ m |u^n|² = Σ_k m Δu_k·ū,
//
// to round-off, in any order of the terms. In the exact solution, pressure does no work on a fluid
// between fixed walls, except in impacts, and the work of gravity is the decrease of the potential
// energy. Any difference is numerical, and is listed separately.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/step_changes.hpp>


namespace silt::mps {

/// Energy of the fluid particles and work since the first step of the flow, all in [J]; in 2D per
/// metre of depth [J/m]. Work is negative if it removes energy.
struct FlowEnergy {
  double kinetic = 0;    ///< current
  double potential = 0;  ///< current: −Σ m g·x, of gravity only, zero at the origin
  double initial = 0;    ///< kinetic + potential at the beginning of the first step

  double by_viscosity = 0;
  double by_force = 0;  ///< the body force in addition to gravity
  double by_friction = 0;   ///< of pairs of particles, see Friction
  double by_collision = 0;
  double by_walls = 0;  ///< pressure on walls without particles that move
  double by_pressure =
      0;  ///< the rest: impacts, remaining compression, clipping of negative pressures
  double by_shifting = 0;  ///< change of the potential energy
  double by_integration = 0;  ///< work of gravity minus the decrease of the potential energy, as
                              ///< positions move with u^{n+1} instead of ū
  double added = 0;  ///< between steps: by changes of the particles, added or removed particles, or
                     ///< crossing a periodic boundary along gravity

  /// kinetic + potential [J].
  double total() const { return kinetic + potential; }
  /// Energy change that the exact solution does not have [J].
  double numerical() const { return by_pressure + by_shifting + by_integration; }
  /// total() minus the sum of initial and all other terms: round-off [J].
  double imbalance() const {
    return total() - initial -
           (by_viscosity + by_force + by_friction + by_collision + by_walls + by_pressure +
            by_shifting + by_integration + added);
  }
};

/// Updates a FlowEnergy. Sums are bitwise identical for any number of threads.
template <int Dim, class Real>
class EnergyAccount {
 public:
  using Vec = silt::Vec<Dim, Real>;
  /// What all particles of a flow have in common.
  struct Properties {
    double mass;  ///< of a particle [kg]; in 2D per metre of depth
    Vec gravity;  ///< g [m/s²]
  };

  EnergyAccount() = default;
  /// The account begins with the first step.
  explicit EnergyAccount(const Properties& properties) : properties_(properties) {}

  const FlowEnergy& energy() const noexcept { return energy_; }
  double mass() const noexcept { return properties_.mass; }  ///< of a particle [kg]

  /// Current kinetic and potential energy of the particles, of all processes; no work.
  template <FluidParticles P>
  FlowEnergy of(const P& particles) const {
    const auto u = particles[velocity];
    const auto x = particles[position];
    const auto kinds = particles[kind];
    const Wide g = wide(properties_.gravity);
    // Divided by the mass of a particle.
    const silt::Vec<2> sums = silt::detail::sum_of_all(
        particles,
        ordered_sum(particles.size(), zero_of<silt::Vec<2>>(), [&](Index i) {
          if (kinds[i] != Kind::fluid) return zero_of<silt::Vec<2>>();
          return silt::Vec<2>(wide(u[i]).squaredNorm() / 2, -g.dot(wide(x[i])));
        }));
    FlowEnergy energy{.kinetic = properties_.mass * sums[0],
                      .potential = properties_.mass * sums[1]};
    energy.initial = energy.total();
    return energy;
  }

  /// To be called before a step changes any velocity.
  template <FluidParticles P>
  void begin(const P& particles) {
    const FlowEnergy found = of(particles);
    if (has_begun_) {
      energy_.added += found.kinetic - energy_.kinetic + (found.potential - energy_.potential);
    } else {
      energy_.initial = found.initial;
      has_begun_ = true;
    }
    energy_.kinetic = found.kinetic;
    energy_.potential = found.potential;
  }

  /// To be called after a step of dt [s] made `changes` and moved the particles. `forces` are
  /// gravity plus body force of each particle [m/s²]; empty if there is no body force. `of_walls`
  /// is the work of the pressure on walls that move [J].
  template <FluidParticles P>
  void end(const P& particles, const StepChanges<Vec>& changes, const Buffer<Vec>& forces,
           double of_walls, double dt) {
    const auto u = particles[velocity];
    const auto kinds = particles[kind];
    const Vec gravity_change = Real(dt) * properties_.gravity;  // rounded as in the predictor
    const Wide g = wide(properties_.gravity);
    const auto work_on = [&](Index i) -> Work {
      if (kinds[i] != Kind::fluid) return Work::Zero();
      const Wide predicted = change_of(changes.predictor, i);
      const Wide forced = wide(forces.empty() ? gravity_change : Vec(Real(dt) * forces[i]));
      const Wide rubbed = change_of(changes.friction, i);
      const Wide collided = change_of(changes.collision, i);
      const Wide pressed = change_of(changes.pressure, i);
      const Wide mean = wide(u[i]) - (predicted + rubbed + collided + pressed) / 2;
      Work work;
      work[by_gravity] = wide(gravity_change).dot(mean);
      work[by_viscosity] = (predicted - forced).dot(mean);
      work[by_force] = (forced - wide(gravity_change)).dot(mean);
      work[by_friction] = rubbed.dot(mean);
      work[by_collision] = collided.dot(mean);
      work[by_pressure] = pressed.dot(mean);
      work[by_shifting] = -g.dot(change_of(changes.shift, i));
      return work;
    };
    const Work work = silt::detail::sum_of_all(
        particles, ordered_sum(particles.size(), zero_of<Work>(), work_on));
    const FlowEnergy found = of(particles);
    energy_.by_viscosity += properties_.mass * work[by_viscosity];
    energy_.by_force += properties_.mass * work[by_force];
    energy_.by_friction += properties_.mass * work[by_friction];
    energy_.by_collision += properties_.mass * work[by_collision];
    energy_.by_walls += of_walls;
    energy_.by_pressure += properties_.mass * work[by_pressure] - of_walls;
    energy_.by_shifting += properties_.mass * work[by_shifting];
    energy_.by_integration += properties_.mass * (work[by_gravity] - work[by_shifting]) +
                              (found.potential - energy_.potential);
    energy_.kinetic = found.kinetic;
    energy_.potential = found.potential;
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_begun", has_begun_);
    archive("kinetic", energy_.kinetic);
    archive("potential", energy_.potential);
    archive("initial", energy_.initial);
    archive("by_viscosity", energy_.by_viscosity);
    archive("by_force", energy_.by_force);
    archive("by_friction", energy_.by_friction);
    archive("by_collision", energy_.by_collision);
    archive("by_walls", energy_.by_walls);
    archive("by_pressure", energy_.by_pressure);
    archive("by_shifting", energy_.by_shifting);
    archive("by_integration", energy_.by_integration);
    archive("added", energy_.added);
  }

 private:
  using Wide = silt::Vec<Dim>;
  // Work on the particles, divided by the mass of one [m²/s²], by term.
  enum Term {
    by_gravity, by_viscosity, by_force, by_friction, by_collision, by_pressure, by_shifting, terms
  };
  using Work = silt::Vec<terms>;

  static Wide wide(const Vec& v) { return v.template cast<double>(); }
  static Wide change_of(const Buffer<Vec>& changes, Index i) {
    return changes.empty() ? Wide(Wide::Zero()) : wide(changes[i]);
  }

  Properties properties_{0, Vec::Zero()};
  FlowEnergy energy_;
  bool has_begun_ = false;
};

}  // namespace silt::mps
