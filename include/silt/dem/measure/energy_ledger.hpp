// SPDX-License-Identifier: MIT
// Energy balance. The kick of leapfrog changes v^{N−½} to v^{N+½} by the force F^N, so that
//
//   ½ m (v^{N+½})² − ½ m (v^{N−½})² = m (v^{N+½} − v^{N−½})·v^N = (F^N − α m v^N)·v^N Δt
//
// with v^N of (27), and likewise for spins: in every step the work of all forces sums to the change
// of kinetic energy, to round-off. The work of a contact is that of its force on grain i with the
// velocity of i's surface relative to the other's, plus that of its couple with the relative spin.
// The work of a moving wall on its grains is a separate term.
//
// Springs do not return exactly the energy they stored, because positions change between kicks. The
// difference is the integration error, of order Δt².
#pragma once

#include <silt/core/energy.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/pair_history.hpp>
#include <silt/dem/measure/contact_work.hpp>
#include <silt/dem/setup/grains.hpp>

#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt::dem {

/// Observer of grains advanced by Leapfrog. All results are for time(), the beginning of the last
/// step, at which the forces were evaluated. The balance begins with the second step of the
/// simulation, since the first one shifts the velocities by half a step; initial_energies() are
/// those at that time.
///
/// Pass it after all other observers, so that it accounts for their changes before a step.
template <class P>
class EnergyLedger {
  static_assert(silt::detail::are_of_one_process<P>,
                "silt::dem::EnergyLedger: it knows the grains of one process only; use "
                "kinetic_energy() and Contacts::elastic_energy(), which are of all processes");
  using Motion = detail::MeanMotion<P>;

 public:
  /// The balance begins with this state of the simulation.
  template <class Sim>
  explicit EnergyLedger(const Sim& simulation) {
    keep_state(simulation);
  }

  /// Accounts for changes since the last step; needed only if there were any.
  template <class Sim>
  void before_step(const Sim& simulation) {
    const double noted = motion_before().sum();
    keep_state(simulation);
    added_since_ += motion_before().sum() - noted;
  }

  /// Must be called after every step. Throws if a step was missed, or if grains were added without
  /// a call of before_step().
  template <class Sim, class... Run>
  void after_step(const Sim& simulation, const Run&...) {
    if (simulation.steps() != steps_ + 1) {
      fail({"dem::EnergyLedger: step ", simulation.steps(), " does not follow step ", steps_,
            "; call after_step() after every step"});
    }
    check_all_known(simulation.particles());
    if (steps_ > 0) add_step(simulation);
    keep_state(simulation);
  }

  /// Time of the results [s].
  double time() const noexcept { return time_; }
  const Energies& energies() const noexcept { return energies_; }
  const Energies& initial_energies() const noexcept { return initial_energies_; }
  /// Totals since the beginning.
  const Work& work() const noexcept { return work_; }
  /// Energy lost from springs since the beginning [J].
  const Losses& losses() const noexcept { return losses_; }
  /// Kinetic energy, including rotation, that was added between steps from outside: by adding or
  /// removing grains or by setting their velocities [J].
  double added_energy() const noexcept { return added_energy_; }
  /// Work of the springs plus the change of their stored energy plus their losses, since the
  /// beginning [J]; NaN for a law without components() or elastic_energies().
  double integration_error() const noexcept {
    return knows_springs_ ? integration_error_ : std::numeric_limits<double>::quiet_NaN();
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.within("before", [&] { before_.transfer(archive); });
    if constexpr (has_clumps) archive.within("clumps", [&] { clumps_.transfer(archive); });
    archive("steps", steps_);
    archive("before_time", before_time_);
    archive("time_step", time_step_);
    archive.within("motion", [&] { motion_.transfer(archive); });
    archive.within("stored", [&] { stored_.transfer(archive); });
    archive("has_begun", has_begun_);
    archive("knows_springs", knows_springs_);
    archive("time", time_);
    archive("energies", energies_);
    archive("initial_energies", initial_energies_);
    archive("work", work_);
    archive("work_of_step", step_);
    archive("losses", losses_);
    archive("added_energy", added_energy_);
    archive("added_since", added_since_);
    archive("integration_error", integration_error_);
  }

  /// Work in the last step, from N − ½ to N + ½.
  const Work& work_of_step() const noexcept { return step_; }
  /// Change of the kinetic energy, including rotation, in the last step [J].
  double energy_change_of_step() const noexcept {
    return motion_.kinetic_change() + motion_.rotational_change();
  }
  /// Difference of the energy change and the work in the last step [J]: round-off.
  double imbalance() const noexcept { return energy_change_of_step() - step_.sum(); }

 private:
  using Stored = PairHistory<ElasticEnergies>;
  using Entries = std::vector<Stored::Entry>;

  // The clumps of ClumpGrains, and their energy in place of that of their spheres.
  static constexpr bool has_clumps = HasFields<P, clump_t>;
  struct NoClumps {};
  using KeptClumps = std::conditional_t<has_clumps, Clumps<P::dimension>, NoClumps>;
  struct MotionEnergies {
    double kinetic = 0;
    double rotational = 0;
    double sum() const { return kinetic + rotational; }
  };
  MotionEnergies motion_before() const {
    if constexpr (!has_clumps) {
      return {.kinetic = kinetic_energy(before_), .rotational = rotational_energy(before_)};
    } else {
      MotionEnergies sum;
      for (Index i = 0; i < before_.size(); ++i) {
        if (before_[clump][i] != 0) continue;
        sum.kinetic += double(before_[mass][i]) * in_double(before_[velocity][i]).squaredNorm() / 2;
        sum.rotational +=
            double(before_[inertia][i]) * squared_norm(in_double(before_[spin][i])) / 2;
      }
      for (Index k = 0; k < clumps_.size(); ++k) {
        const auto state = clumps_.state(k);
        sum.kinetic += clumps_.mass_of(k) * state.velocity.squaredNorm() / 2;
        sum.rotational += dot(clumps_.angular_momentum(k), state.spin) / 2;
      }
      return sum;
    }
  }

  template <class Sim>
  void keep_state(const Sim& simulation) {
    before_ = simulation.particles();
    if constexpr (has_clumps) clumps_ = simulation.integrator().clumps();
    steps_ = simulation.steps();
    before_time_ = simulation.time();
    time_step_ = simulation.last_time_step();
  }

  void check_all_known(const P& after) const {
    const Index unknown = first_where(
        after.size(), [&](Index i) { return before_.index_of(after.id(i)) == no_index; });
    if (unknown == no_index) return;
    fail(
        "dem::EnergyLedger: a grain was added before the step; call before_step() after adding "
        "grains, or pass the ledger after the observer that adds them",
        {.particle = unknown, .id = after.id(unknown)});
  }

  template <class Sim>
  void add_step(const Sim& simulation) {
    static_assert(
        requires { simulation.integrator().damping(); },
        "silt::dem::EnergyLedger requires the integrator Leapfrog, or ClumpLeapfrog");
    const P& after = simulation.particles();
    const Work last = std::exchange(step_, {});
    added_energy_ += added_since_;
    motion_.set(before_, after, (time_step_ + simulation.last_time_step()) / 2);
    if constexpr (has_clumps)
      motion_.set_clumps(before_, clumps_, simulation.integrator().clumps());
    added_since_ = -motion_.carried_away();
    const MotionEnergies before = motion_before();
    energies_ = {.kinetic = before.kinetic + motion_.kinetic_change() / 2,
                 .rotational = before.rotational + motion_.rotational_change() / 2};
    Losses lost;
    Entries stored;
    const bool knows_all = add_work(simulation.interaction(), lost, stored);
    if (!knows_all) add_other(after);
    if constexpr (has_clumps) add_drives(after);
    add_damping(simulation.integrator().damping());
    update_balance(last, lost, std::move(stored));
    time_ = before_time_;
  }

  // Returns false if an interaction is unknown to the ledger.
  template <class I>
  bool add_work(const I& interaction, Losses& lost, Entries& stored) {
    bool knows_all = true;
    if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
      interaction.for_each_part(
          [&](const auto& part) { knows_all &= add_work(part, lost, stored); });
    } else if constexpr (requires {
                           interaction.for_each_evaluated_contact(before_, [](const auto&) {});
                         }) {
      interaction.for_each_evaluated_contact(before_, [&](const auto& each) {
        motion_.add_contact(before_, each, step_, lost);
        stored.push_back({each.first, each.second, each.elastic});
      });
      knows_springs_ = knows_springs_ && I::gives_spring_energy;
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

  // The work of the forces of unknown interactions.
  void add_other(const P& after) {
    double all = 0;
    for (Index k = 0; k < after.size(); ++k) {
      const Index i = before_.index_of(after.id(k));
      all += in_double(after[force][k]).dot(motion_.velocity_of(i)) +
             dot(in_double(after[torque][k]), motion_.spin_of(i));
    }
    step_.other = all * motion_.duration() - step_.sum();
  }

  // What changes the energy of driven clumps beside the forces on their spheres.
  void add_drives(const P& after) {
    motion_.for_each_driven([&](Index k, double change) {
      double power = 0;
      clumps_.for_each_sphere(before_, k, [&](Index i, const auto&) {
        const Index now = after.index_of(before_.id(i));
        power += in_double(after[force][now]).dot(motion_.velocity_of(i)) +
                 dot(in_double(after[torque][now]), motion_.spin_of(i));
      });
      step_.drives += change - power * motion_.duration();
    });
  }

  template <class D>
  void add_damping(const D& damping) {
    if constexpr (requires { damping.drag(1.0); }) {
      for (Index i = 0; i < before_.size(); ++i) {
        if (!motion_.stays(i) || is_of_clump(i)) continue;
        const auto& v = motion_.velocity_of(i);
        const auto& w = motion_.spin_of(i);
        const double power = double(before_[mass][i]) * v.dot(damping.drag(v)) +
                             double(before_[inertia][i]) * dot(w, damping.drag(w));
        step_.damping += power * motion_.duration();
      }
      if constexpr (has_clumps)
        step_.damping += motion_.power_on_clumps(damping) * motion_.duration();
    } else {
      step_.damping = energy_change_of_step() - step_.sum();
    }
  }

  bool is_of_clump([[maybe_unused]] Index i) const {
    if constexpr (has_clumps) {
      return before_[clump][i] != 0;
    } else {
      return false;
    }
  }

  // Work is known from half step to half step; that from N − 1 to N is half of each of the two
  // kicks.
  void update_balance(const Work& last, const Losses& lost, Entries stored) {
    Stored now(std::move(stored));
    now.for_each_pair([&](Id, Id, const ElasticEnergies& each) { energies_.elastic += each; });
    if (!has_begun_) {
      initial_energies_ = energies_;
      added_energy_ = 0;
      has_begun_ = true;
    } else {
      work_.add(last, 0.5);
      work_.add(step_, 0.5);
      Losses all = lost;
      ElasticEnergies before;
      stored_.for_each_pair([&](Id a, Id b, const ElasticEnergies& each) {
        if (!exists(a) || !exists(b)) return;  // the spring was removed with the grain
        before += each;
        if (now.find(a, b) == nullptr)
          all.separation += each.tangential + each.rolling + each.at_end;
      });
      losses_ += all;
      integration_error_ += (last.springs() + step_.springs()) / 2 +
                            (energies_.elastic.sum() - before.sum()) + all.sum();
    }
    stored_ = std::move(now);
  }
  bool exists(Id id) const { return is_wall_id(id) || before_.index_of(id) != no_index; }

  P before_;  // grains at the end of the last step or the beginning of the next
  KeptClumps clumps_;  // likewise
  std::uint64_t steps_ = 0;
  double before_time_ = 0;
  double time_step_ = 0;
  Motion motion_;
  Stored stored_;
  bool has_begun_ = false;
  bool knows_springs_ = true;
  double time_ = 0;
  Energies energies_;
  Energies initial_energies_;
  Work work_;
  Work step_;
  Losses losses_;
  double added_energy_ = 0;
  double added_since_ = 0;  // energy added since time()
  double integration_error_ = 0;
};

template <class Sim>
EnergyLedger(const Sim&)
    -> EnergyLedger<std::remove_cvref_t<decltype(std::declval<Sim>().particles())>>;

}  // namespace silt::dem
