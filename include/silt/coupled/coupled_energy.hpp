// SPDX-License-Identifier: MIT
// Energy balance of grains and the fluid around them. The work of each force is defined with mean
// velocities, see WorkOnGrains and FlowEnergy, so that all of it is the change of the energies to
// round-off. What the exchange takes from both is the loss of drag.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/work_on_grains.hpp>
#include <silt/mps/record/flow_energy.hpp>

namespace silt::coupled {

/// Energy of grains, without that of their spins and springs, and work on them, all in [J]; in 2D per
/// metre of depth. Velocities are those at half steps. A damping of Leapfrog is not accounted for.
struct GrainEnergy {
  double kinetic = 0;    ///< of translation, current
  double potential = 0;  ///< current: −Σ m g·x, zero at the origin
  double initial = 0;    ///< kinetic + potential at the beginning of the first step

  double by_pressure = 0;     ///< −V ∇P of the fluid
  double by_exchange = 0;     ///< drag, added mass and lift
  double by_contacts = 0;     ///< contacts, walls, and all further forces but gravity
  double by_integration = 0;  ///< work of gravity minus the decrease of the potential energy
  double added = 0;  ///< between steps, with removed grains, and by the first step, which shifts
                     ///< velocities by half of it

  /// kinetic + potential [J].
  double total() const { return kinetic + potential; }
  /// total() minus the sum of initial and all other terms: round-off [J].
  double imbalance() const {
    return total() - initial - (by_pressure + by_exchange + by_contacts + by_integration + added);
  }
};

/// Energy of both, and work since the first step, all in [J]; in 2D per metre of depth.
struct CoupledEnergy {
  GrainEnergy grains;
  mps::FlowEnergy fluid;            ///< with the exchange in by_exchange_on_fluid only
  double by_exchange_on_fluid = 0;  ///< drag, added mass and lift

  double total() const { return grains.total() + fluid.total(); }  ///< kinetic + potential [J]
  /// Of both, by drag [J]; with an added mass, what the motion of the fluid between the grains has
  /// stored is included.
  double lost_by_exchange() const { return -(grains.by_exchange + by_exchange_on_fluid); }
  /// total() minus all other terms: round-off [J].
  double imbalance() const { return grains.imbalance() + fluid.imbalance() - by_exchange_on_fluid; }
};

/// Updates the GrainEnergy, and sums the work on the fluid. Sums are bitwise identical for any number
/// of threads.
class GrainEnergyAccount {
 public:
  /// Current energies of grains.
  template <class P>
  static GrainEnergy of(const P& grains, const typename P::Vec& gravity) {
    GrainEnergy found{.kinetic = kinetic_energy(grains),
                      .potential = potential_energy(grains, gravity)};
    found.initial = found.total();
    return found;
  }

  /// Of both: of_flow as the flow has it, and the current energies of the fluid.
  CoupledEnergy energy(mps::FlowEnergy of_flow, const mps::FlowEnergy& current) const {
    of_flow.by_force -= on_fluid_;
    of_flow.added += current.total() - of_flow.total() - after_fluid_;
    of_flow.kinetic = current.kinetic;
    of_flow.potential = current.potential;
    return {energy_, of_flow, on_fluid_ + after_fluid_};
  }

  /// What a step changes.
  struct Step {
    GrainEnergy before, after;  ///< see of()
    WorkOnGrains on_grains;
    double on_fluid, after_fluid;  ///< of the exchange, see Exchange::Work [J]
    bool has_all_grains;           ///< none was removed
  };
  /// After a step, with gravity [m/s²].
  template <class Vec>
  void add(const Step& step, const Vec& gravity) {
    double by_gravity = 0;
    for (int k = 0; k < Vec::RowsAtCompileTime; ++k) {
      by_gravity += double(gravity[k]) * step.on_grains.moved_mass[k];
    }
    const WorkOnGrains& work = step.on_grains;
    const double kinetic_change = step.after.kinetic - step.before.kinetic;
    const double unexplained =
        kinetic_change - (work.by_pressure + work.by_exchange + work.by_others);
    const double moved = by_gravity + (step.after.potential - step.before.potential);
    if (has_begun_) {
      energy_.added += step.before.total() - energy_.total();
    } else {
      energy_.initial = step.before.initial;
    }
    if (!has_begun_ || !step.has_all_grains) energy_.added += unexplained;
    (step.has_all_grains ? energy_.by_integration : energy_.added) += moved;
    has_begun_ = true;
    energy_.by_pressure += work.by_pressure;
    energy_.by_exchange += work.by_exchange;
    energy_.by_contacts += work.by_others - by_gravity;
    energy_.kinetic = step.after.kinetic;
    energy_.potential = step.after.potential;
    on_fluid_ += step.on_fluid;
    after_fluid_ += step.after_fluid;
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("has_begun", has_begun_);
    archive("kinetic", energy_.kinetic);
    archive("potential", energy_.potential);
    archive("initial", energy_.initial);
    archive("by_pressure", energy_.by_pressure);
    archive("by_exchange", energy_.by_exchange);
    archive("by_contacts", energy_.by_contacts);
    archive("by_integration", energy_.by_integration);
    archive("added", energy_.added);
    archive("on_fluid", on_fluid_);
    archive("after_fluid", after_fluid_);
  }

 private:
  GrainEnergy energy_;
  double on_fluid_ = 0;     // in steps of the flow
  double after_fluid_ = 0;  // after them
  bool has_begun_ = false;
};

}  // namespace silt::coupled
