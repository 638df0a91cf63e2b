// SPDX-License-Identifier: MIT
// Energy balance of grains and the fluid around them. The work of each force is defined with mean
// velocities, see WorkOnGrains and FlowEnergy, so that all of it is the change of the energies to
// round-off. What the exchange takes from both is the loss of drag.
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/work_on_grains.hpp>
#include <silt/measure/energy.hpp>
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
  double added = 0;  ///< between steps, and by the first one, which shifts velocities by half a step

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
  /// Its by_force includes the exchange; the changes that follow from the added mass after a step are
  /// in `added`, in the next step.
  mps::FlowEnergy fluid;
  double by_exchange_on_fluid = 0;  ///< drag, added mass and lift

  double total() const { return grains.total() + fluid.total(); }  ///< kinetic + potential [J]
  /// Of both, by drag [J]; with an added mass, what the motion of the fluid between the grains has
  /// stored is included.
  double lost_by_exchange() const { return -(grains.by_exchange + by_exchange_on_fluid); }
  /// Round-off [J].
  double imbalance() const { return grains.imbalance() + fluid.imbalance(); }
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

  const GrainEnergy& energy() const noexcept { return energy_; }
  double by_exchange_on_fluid() const noexcept { return on_fluid_; }  ///< [J]

  /// After a step: of() before and after it, and the work of all forces in it.
  template <class Vec>
  void add(const GrainEnergy& before, const GrainEnergy& after, const WorkOnGrains& work,
           double on_fluid, const Vec& gravity) {
    double by_gravity = 0;
    for (int k = 0; k < Vec::RowsAtCompileTime; ++k) by_gravity += double(gravity[k]) * work.moved_mass[k];
    const double kinetic_change = work.by_pressure + work.by_exchange + work.by_others;
    if (has_begun_) {
      energy_.added += before.total() - energy_.total();
    } else {
      energy_.initial = before.initial;
      energy_.added = after.kinetic - before.kinetic - kinetic_change;
      has_begun_ = true;
    }
    energy_.by_pressure += work.by_pressure;
    energy_.by_exchange += work.by_exchange;
    energy_.by_contacts += work.by_others - by_gravity;
    energy_.by_integration += by_gravity + (after.potential - before.potential);
    energy_.kinetic = after.kinetic;
    energy_.potential = after.potential;
    on_fluid_ += on_fluid;
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
    archive("by_exchange_on_fluid", on_fluid_);
  }

 private:
  GrainEnergy energy_;
  double on_fluid_ = 0;
  bool has_begun_ = false;
};

}  // namespace silt::coupled
