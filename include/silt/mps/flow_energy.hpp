// SPDX-License-Identifier: MIT
// Where the energy of a flow goes. A step changes the velocity of a particle by parts,
//
//   u^{n+1} − u^n = Δt g + Δt f + Δt ν∇²u + collisions − (Δt/ρ) ∇P,
//
// and with the mean velocity ū = (u^n + u^{n+1})/2 each of them has a work of its own,
//
//   ½ m |u^{n+1}|² − ½ m |u^n|² = Σ_parts m Δu_part·ū,
//
// to round-off, whatever their order in the step. Exactly, pressure does no work in a fluid between
// walls at rest, but for impacts; and gravity does as much as the potential loses. What they do
// beyond that is numerical, and told apart.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <vector>

namespace silt::mps {

/// Of the fluid particles, since the flow's first step [J]; in 2D per metre of depth [J/m]. A work
/// is negative where it takes energy out.
struct FlowEnergy {
  double kinetic = 0;    ///< now
  double potential = 0;  ///< now: −Σ m g·x, of gravity alone, zero at the origin
  double first = 0;      ///< kinetic + potential at the beginning of the first step

  double by_viscosity = 0;
  double by_force = 0;  ///< the body force beside gravity
  double by_collision = 0;
  double by_pressure = 0;  ///< impacts, compressions that the solve left, clipped pressures
  double by_shifting = 0;  ///< of the potential
  double by_stepping = 0;  ///< gravity's work less what the potential lost, as positions move with
                           ///< u^{n+1} instead of ū
  double outside = 0;      ///< by a hand, or by particles that came or left between steps, or
                           ///< around a side that is periodic along gravity

  double total() const { return kinetic + potential; }
  /// What the method changes that the equations do not.
  double numerical() const { return by_pressure + by_shifting + by_stepping; }
  /// total() less all that is told: round-off.
  double imbalance() const {
    return total() - first - (by_viscosity + by_force + by_collision + by_pressure + by_shifting +
                              by_stepping + outside);
  }
};

/// By how much each part of a step changed the velocity of each particle [m/s], and its place [m]
/// beside that; empty where a part did nothing.
template <class Vec>
struct StepChanges {
  std::vector<Vec> predictor;  ///< gravity, force and viscosity
  std::vector<Vec> collision;
  std::vector<Vec> pressure;
  std::vector<Vec> shift;

  void clear() {
    for (auto* part : {&predictor, &collision, &pressure, &shift}) part->clear();
  }
};

/// Keeps a FlowEnergy. Sums are the same bits for any number of threads.
template <int Dim, class Real>
class EnergyAccount {
 public:
  using Vec = silt::Vec<Dim, Real>;
  struct Matter {
    double mass;  ///< of a particle [kg]; in 2D per metre of depth
    Vec gravity;  ///< g [m/s²]
  };

  EnergyAccount() = default;
  explicit EnergyAccount(const Matter& matter) : matter_(matter) {}

  const FlowEnergy& energy() const noexcept { return now_; }

  /// What the particles have now; nothing is told of where it went.
  template <FluidParticles P>
  FlowEnergy of(const P& particles) const {
    const auto u = particles[velocity];
    const auto x = particles[position];
    const auto kinds = particles[kind];
    const Wide g = wide(matter_.gravity);
    const State sum = ordered_sum(particles.size(), State{}, [&](Index i) {
      if (kinds[i] != Kind::fluid) return State{};
      return State{.kinetic = wide(u[i]).squaredNorm() / 2, .potential = -g.dot(wide(x[i]))};
    });
    FlowEnergy energy{.kinetic = matter_.mass * sum.kinetic,
                      .potential = matter_.mass * sum.potential};
    energy.first = energy.total();
    return energy;
  }

  /// Before a step changes a velocity.
  template <FluidParticles P>
  void begin(const P& particles) {
    const FlowEnergy found = of(particles);
    if (has_begun_) {
      now_.outside += found.kinetic - now_.kinetic + (found.potential - now_.potential);
    } else {
      now_.first = found.first;
      has_begun_ = true;
    }
    now_.kinetic = found.kinetic;
    now_.potential = found.potential;
  }

  /// After a step of dt [s] made the changes and moved the particles. `forces` are g and the body
  /// force at each of them [m/s²], or empty where there is none.
  template <FluidParticles P>
  void end(const P& particles, const StepChanges<Vec>& by, const std::vector<Vec>& forces,
           double dt) {
    const auto u = particles[velocity];
    const auto kinds = particles[kind];
    const Vec fall = Real(dt) * matter_.gravity;  // rounded as in the predictor
    const Wide g = wide(matter_.gravity);
    const Works works = ordered_sum(particles.size(), Works{}, [&](Index i) {
      if (kinds[i] != Kind::fluid) return Works{};
      const Wide predicted = at(by.predictor, i);
      const Wide forced = forces.empty() ? wide(fall) : wide(Real(dt) * forces[i]);
      const Wide collided = at(by.collision, i);
      const Wide pressed = at(by.pressure, i);
      const Wide mean = wide(u[i]) - (predicted + collided + pressed) / 2;
      return Works{.gravity = wide(fall).dot(mean),
                   .viscosity = (predicted - forced).dot(mean),
                   .force = (forced - wide(fall)).dot(mean),
                   .collision = collided.dot(mean),
                   .pressure = pressed.dot(mean),
                   .shifting = -g.dot(at(by.shift, i))};
    });
    const FlowEnergy found = of(particles);
    now_.by_viscosity += matter_.mass * works.viscosity;
    now_.by_force += matter_.mass * works.force;
    now_.by_collision += matter_.mass * works.collision;
    now_.by_pressure += matter_.mass * works.pressure;
    now_.by_shifting += matter_.mass * works.shifting;
    now_.by_stepping += matter_.mass * (works.gravity - works.shifting) +
                        (found.potential - now_.potential);
    now_.kinetic = found.kinetic;
    now_.potential = found.potential;
  }

  void save() noexcept {
    saved_ = now_;
    had_begun_ = has_begun_;
  }
  void restore() noexcept {
    now_ = saved_;
    has_begun_ = had_begun_;
  }
  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_begun", has_begun_);
    archive("kinetic", now_.kinetic);
    archive("potential", now_.potential);
    archive("first", now_.first);
    archive("by_viscosity", now_.by_viscosity);
    archive("by_force", now_.by_force);
    archive("by_collision", now_.by_collision);
    archive("by_pressure", now_.by_pressure);
    archive("by_shifting", now_.by_shifting);
    archive("by_stepping", now_.by_stepping);
    archive("outside", now_.outside);
  }

 private:
  using Wide = silt::Vec<Dim>;
  // Per mass of a particle [m²/s²].
  struct Works {
    double gravity = 0, viscosity = 0, force = 0, collision = 0, pressure = 0, shifting = 0;
    Works& operator+=(const Works& more) {
      gravity += more.gravity;
      viscosity += more.viscosity;
      force += more.force;
      collision += more.collision;
      pressure += more.pressure;
      shifting += more.shifting;
      return *this;
    }
  };
  struct State {
    double kinetic = 0, potential = 0;
    State& operator+=(const State& more) {
      kinetic += more.kinetic;
      potential += more.potential;
      return *this;
    }
  };

  static Wide wide(const Vec& v) { return v.template cast<double>(); }
  static Wide at(const std::vector<Vec>& part, Index i) {
    return part.empty() ? Wide(Wide::Zero()) : wide(part[i]);
  }

  Matter matter_{0, Vec::Zero()};
  FlowEnergy now_;
  FlowEnergy saved_;
  bool has_begun_ = false;
  bool had_begun_ = false;
};

}  // namespace silt::mps
