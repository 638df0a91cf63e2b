// SPDX-License-Identifier: MIT
// Where the energy goes. Leapfrog's kick takes v^{N−½} to v^{N+½} under the force F^N, so that
//
//   ½ m (v^{N+½})² − ½ m (v^{N−½})² = m (v^{N+½} − v^{N−½})·v^N = (F^N − α m v^N)·v^N Δt
//
// with v^N of (27), and likewise for spins: in every step the works of all that acts sum to the
// change of kinetic energy, to round-off. A contact's work is its force on grain i times the
// velocity of i's surface against the other's, and its couple times the relative spin; what a wall
// that moves does on its grains is beside that.
//
// Springs do not give back exactly what they took: positions move between kicks. What is missing
// is the integration's error, of order Δt².
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/error.hpp>
#include <silt/core/pair_history.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/energy_terms.hpp>
#include <silt/dem/grains.hpp>
#include <silt/dem/mean_motion.hpp>

#include <concepts>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::dem {

/// An observer of grains that Leapfrog advances. What it tells is for time(), the beginning of the
/// last step: there the forces were made. It begins with the simulation's second step, as in the
/// first one leapfrog sets its velocities off by half a step; beginning() are the energies then.
///
/// Stand it behind all other observers, so that it sees what they changed before a step.
template <class P>
class EnergyLedger {
  using Motion = MeanMotion<P>;

 public:
  template <class Sim>
  explicit EnergyLedger(const Sim& simulation) {
    note(simulation);
  }

  /// Notices what changed since the last step; needed only where something did.
  template <class Sim>
  void before_step(const Sim& simulation) {
    const double noted = energy_of_motion(before_);
    note(simulation);
    came_since_ += energy_of_motion(before_) - noted;
  }

  /// To be called after every step. Throws if it missed one, or grains that came before it.
  template <class Sim, class Run>
  void after_step(const Sim& simulation, const Run&) {
    after_step(simulation);
  }
  template <class Sim>
  void after_step(const Sim& simulation) {
    if (simulation.steps() != steps_ + 1) {
      fail("dem::EnergyLedger: it saw step " + std::to_string(steps_) + " and then step " +
           std::to_string(simulation.steps()) + "; call after_step() after every one");
    }
    check_that_all_are_known(simulation.particles());
    if (steps_ > 0) enter(simulation);
    note(simulation);
  }

  /// Of what follows [s].
  double time() const noexcept { return time_; }
  const Energies& energies() const noexcept { return energies_; }
  const Energies& beginning() const noexcept { return beginning_; }
  /// Since the beginning.
  const Works& works() const noexcept { return works_; }
  const Losses& losses() const noexcept { return losses_; }
  /// Kinetic energy, rotation included, that grains brought with them or took away, or that a hand
  /// gave them, between steps [J].
  double outside() const noexcept { return outside_; }
  /// Work of the springs, less what they gave from their store and what they lost, since the
  /// beginning [J]; NaN for a law that does not tell both.
  double integration_error() const noexcept {
    return knows_springs_ ? integration_error_ : std::numeric_limits<double>::quiet_NaN();
  }

  /// In the last step, from N − ½ to N + ½.
  const Works& works_of_step() const noexcept { return step_; }
  /// Of the kinetic energy, rotation included [J].
  double change_of_step() const noexcept {
    return motion_.kinetic_change() + motion_.rotational_change();
  }
  /// What change and works of the last step differ by [J]: round-off.
  double imbalance() const noexcept { return change_of_step() - step_.sum(); }

 private:
  using Stored = PairHistory<ElasticEnergies>;
  using Entries = std::vector<Stored::Entry>;

  static double energy_of_motion(const P& grains) {
    return kinetic_energy(grains) + rotational_energy(grains);
  }

  template <class Sim>
  void note(const Sim& simulation) {
    before_ = simulation.particles();
    steps_ = simulation.steps();
    noted_time_ = simulation.time();
    time_step_ = simulation.last_time_step();
  }

  void check_that_all_are_known(const P& after) const {
    const Index stranger = first_where(
        after.size(), [&](Index i) { return before_.index_of(after.id(i)) == no_index; });
    if (stranger == no_index) return;
    fail("dem::EnergyLedger: it does not know a grain that was there during the step; call "
         "before_step() after adding grains, or stand it behind the observer that adds them",
         {.particle = stranger, .id = after.id(stranger)});
  }

  template <class Sim>
  void enter(const Sim& simulation) {
    static_assert(requires { simulation.integrator().damping(); },
                  "silt::dem::EnergyLedger: it reads the half steps of Leapfrog");
    const P& after = simulation.particles();
    const Works last = std::exchange(step_, {});
    outside_ += came_since_;
    motion_.set(before_, after, (time_step_ + simulation.last_time_step()) / 2);
    came_since_ = -motion_.carried_away();
    energies_ = {.kinetic = kinetic_energy(before_) + motion_.kinetic_change() / 2,
                 .rotational = rotational_energy(before_) + motion_.rotational_change() / 2};
    Losses lost;
    Entries stored;
    const bool knows_all = add_works(simulation.interaction(), lost, stored);
    if (!knows_all) add_other(after);
    add_damping(simulation.integrator().damping());
    take_stock(last, lost, std::move(stored));
    time_ = noted_time_;
  }

  // False if there is an interaction that the ledger does not know.
  template <class I>
  bool add_works(const I& interaction, Losses& lost, Entries& stored) {
    bool knows_all = true;
    if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
      interaction.for_each_part(
          [&](const auto& part) { knows_all &= add_works(part, lost, stored); });
    } else if constexpr (requires { interaction.for_each_evaluated_contact(before_, [](const auto&) {}); }) {
      interaction.for_each_evaluated_contact(before_, [&](const auto& each) {
        motion_.add_contact(before_, each, step_, lost);
        stored.push_back({each.first, each.second, each.elastic});
      });
      knows_springs_ = knows_springs_ && I::template gives_spring_energy<P>;
    } else if constexpr (requires(typename P::Vec g) { g = interaction.acceleration(); }) {
      add_gravity(in_double(interaction.acceleration()));
    } else {
      knows_all = false;
    }
    return knows_all;
  }

  void add_gravity(const typename Motion::Vector& g) {
    for (Index i = 0; i < before_.size(); ++i) {
      const double m = double(before_[mass][i]);
      if (motion_.stays(i)) {
        step_.gravity += m * g.dot(motion_.velocity_of(i)) * motion_.duration();
      }
      energies_.potential -= m * g.dot(in_double(before_[position][i]));
    }
  }

  // What forces did beyond what is known of them.
  void add_other(const P& after) {
    double all = 0;
    for (Index k = 0; k < after.size(); ++k) {
      const Index i = before_.index_of(after.id(k));
      all += in_double(after[force][k]).dot(motion_.velocity_of(i)) +
             dot(in_double(after[torque][k]), motion_.spin_of(i));
    }
    step_.other = all * motion_.duration() - step_.sum();
  }

  template <class D>
  void add_damping(const D& damping) {
    if constexpr (requires { damping.drag(1.0); }) {
      for (Index i = 0; i < before_.size(); ++i) {
        if (!motion_.stays(i)) continue;
        const auto& v = motion_.velocity_of(i);
        const auto& w = motion_.spin_of(i);
        const double power =
            double(before_[mass][i]) * v.dot(damping.drag(v)) +
            double(before_[inertia][i]) * dot(w, damping.drag(w));
        step_.damping += power * motion_.duration();
      }
    } else {
      step_.damping = change_of_step() - step_.sum();
    }
  }

  // The work of a kick is whole from half step to half step; of that from N − 1 to N, one half is
  // the kick's before.
  void take_stock(const Works& last, const Losses& lost, Entries stored) {
    Stored now(std::move(stored));
    now.for_each_pair([&](Id, Id, const ElasticEnergies& each) { energies_.elastic += each; });
    if (!has_begun_) {
      beginning_ = energies_;
      outside_ = 0;
      has_begun_ = true;
    } else {
      works_.add(last, 0.5);
      works_.add(step_, 0.5);
      Losses all = lost;
      ElasticEnergies before;
      stored_.for_each_pair([&](Id a, Id b, const ElasticEnergies& each) {
        if (!is_there(a) || !is_there(b)) return;  // removed, and the spring with it
        before += each;
        if (now.find(a, b) == nullptr) all.opened += each.tangential + each.rolling;
      });
      losses_ += all;
      integration_error_ += (last.springs() + step_.springs()) / 2 +
                            (energies_.elastic.sum() - before.sum()) + all.sum();
    }
    stored_ = std::move(now);
  }
  bool is_there(Id id) const { return is_wall_id(id) || before_.index_of(id) != no_index; }

  P before_;  // as the last step ended, or the next one begins
  std::uint64_t steps_ = 0;
  double noted_time_ = 0;
  double time_step_ = 0;
  Motion motion_;
  Stored stored_;
  bool has_begun_ = false;
  bool knows_springs_ = true;
  double time_ = 0;
  Energies energies_;
  Energies beginning_;
  Works works_;
  Works step_;
  Losses losses_;
  double outside_ = 0;
  double came_since_ = 0;  // from outside, since time()
  double integration_error_ = 0;
};

template <class Sim>
EnergyLedger(const Sim&)
    -> EnergyLedger<std::remove_cvref_t<decltype(std::declval<Sim>().particles())>>;

}  // namespace silt::dem
