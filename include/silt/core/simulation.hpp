// SPDX-License-Identifier: MIT
// A simulation combines four objects: particles P, a neighbour search S, an interaction I and an
// integrator T.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/run.hpp>
#include <silt/core/step_checks.hpp>
#include <silt/core/step_transaction.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>

#include <algorithm>
#include <concepts>
#include <cstdint>
#include <optional>
#include <utility>

namespace silt {

/// Advances particles P in time under an interaction I, with the integrator T; the search S finds
/// the neighbours. A step that throws is rolled back: the simulation is as before it.
template <class P, class S, class I, class T>
class Simulation {
  static_assert(ParticleSet<P>, "silt::Simulation: the first argument must be particles");
  static_assert(NeighbourSearch<S, P>,
                "silt::Simulation: the second argument is not a neighbour search for these "
                "particles (same dimension and precision? see NeighbourSearch in "
                "silt/core/concepts.hpp)");
  static_assert(explain<I, P>());
  static_assert(HasReach<I, P>,
                "silt::Simulation: the third argument is not an interaction for these particles "
                "(does it have reach(particles), and do they have the fields it needs?)");
  static_assert(!NeighbourSearch<S, P> || !HasReach<I, P> || Integrator<T, P, S, I>,
                "silt::Simulation: this integrator cannot advance these particles with this "
                "interaction (Leapfrog takes forces on grains, SemiImplicit a flow)");
  using TypedInteraction = ForParticles<I, P>;

 public:
  /// Throws if the search radius was given and is smaller than the interaction range, if the compiler
  /// may reorder sums, or as instruction_set().
  Simulation(P particles, S search, I interaction, T integrator)
      : particles_(std::move(particles)),
        search_(std::move(search)),
        interaction_(std::move(interaction)),
        integrator_(std::move(integrator)),
        chooses_radius_(!(search_.radius() > 0)) {
    detail::require_ordered_sums();
    instruction_set();
    if constexpr (requires { particles_.own_rows(); }) particles_.own_rows();
    const detail::Team team(thread_choice_, particles_.size());
    const Largest before = prepare();
    Processes::together(particles_, [&] {
      update_halo(before);
      sort();
      search_.update(particles_);
      return Largest{};
    });
  }

  double time() const noexcept { return time_; }                      ///< [s]
  std::uint64_t steps() const noexcept { return steps_; }             ///< completed
  double last_time_step() const noexcept { return last_time_step_; }  ///< [s]
  /// Whether its state was read from a checkpoint.
  bool was_read() const noexcept { return was_read_; }
  /// Particles removed because they left the box, of all processes; see OnEscape.
  std::uint64_t particles_lost() const noexcept { return particles_lost_; }

  /// The particles at time(), with velocities as the integrator stores them: at half steps with
  /// Leapfrog. What the program changes holds from the next step on.
  P& particles() noexcept { return particles_; }
  const P& particles() const noexcept { return particles_; }
  /// In the state of its last update, which may be several steps ago: contacts search only when
  /// their list must be rebuilt. Particles may have been added since, which removes the ghosts to
  /// which its indices refer: update a search of your own then.
  const S& search() const noexcept { return search_; }
  /// The interaction, stored as ForParticles<I, P>.
  TypedInteraction& interaction() noexcept { return interaction_; }
  const TypedInteraction& interaction() const noexcept { return interaction_; }
  /// The integrator, with what it keeps from step to step. What the program changes holds from the
  /// next step on.
  T& integrator() noexcept { return integrator_; }
  const T& integrator() const noexcept { return integrator_; }

  /// Copies of the particles and the interaction with all quantities at time(); an integrator that
  /// stores velocities at half steps advances them to time(). The simulation is not changed.
  struct State {
    P particles;
    TypedInteraction interaction;  ///< its results, such as the contacts, refer to `particles`
  };
  State state() const {
    if constexpr (copies_for_state) {
      Simulation copy = *this;
      set_time(copy.interaction_, time_);
      Processes::together(copy.particles_, [&] {
        // The program may have changed particles, or removed some.
        Processes::find_halo_of_changed(copy.particles_);
        if constexpr (synchronises) {
          copy.integrator_.synchronise(copy.particles_, copy.search_, copy.interaction_);
        }
        return Largest{};
      });
      return {std::move(copy.particles_), std::move(copy.interaction_)};
    } else {
      return {particles_, interaction_};
    }
  }

  /// The particles of state().
  P snapshot() const {
    if constexpr (copies_for_state) {
      return state().particles;
    } else {
      return particles_;
    }
  }

  /// Writes or reads the state of the run for a checkpoint, see core/transfer.hpp. What the program
  /// passes to constructors (laws, walls, settings) is not restored; laws and walls are compared. Of
  /// shared particles the first process writes all, and the others none; each reads all.
  template <class Archive>
  void transfer(Archive& archive) {
    static_assert(!Transactional<TypedInteraction> || Transferable<TypedInteraction, Archive, P> ||
                      Transferable<TypedInteraction, Archive>,
                  "silt::Simulation: this interaction has state (it has save() and restore()), so "
                  "a checkpoint needs its transfer(archive, particles)");
    if constexpr (!Archive::reads) Processes::gather(particles_, interaction_);
    archive.finite([&] {
      archive("time", time_);
      archive("steps", steps_);
      archive("last_time_step", last_time_step_);
      archive("particles_lost", particles_lost_);
      run_.transfer(archive);
    });
    if constexpr (Archive::reads) {
      require_not_negative("Simulation: last_time_step", last_time_step_);
      was_read_ = true;
    }
    archive.within("particles", [&] { particles_.transfer(archive); });
    if constexpr (Archive::reads) prepare();
    if constexpr (Transferable<S, Archive, P>) {
      archive.finite([&] { detail::transfer_part(archive, "search", search_, particles_); });
    } else if constexpr (Archive::reads) {
      // The particles must not move, but an update wraps positions into a periodic box.
      const auto x = std::as_const(particles_).with_halo(position);
      at_positions(particles_, Buffer<typename P::Vec>(x.begin(), x.end()),
                   [&] { search_.update(particles_); });
    }
    archive.finite([&] { detail::transfer_part(archive, "integrator", integrator_, particles_); });
    set_time(interaction_, time_);
    detail::transfer_part(archive, "interaction", interaction_, particles_);
    if constexpr (Archive::reads && Processes::are_several) {
      Processes::keep_own(particles_, interaction_);
      update_halo(prepare());
    }
  }

  /// The time step that the interaction chooses for the present state [s]; the last one if all
  /// particles have been removed. Throws if the interaction chooses none.
  double time_step() {
    const detail::Team team(thread_choice_, particles_.size());
    set_time(interaction_, time_);
    const Largest all = Processes::together(particles_, [&] {
      Largest own{.wanted = particles_.empty() ? 0.0 : 1.0};
      if constexpr (ChoosesTimeStep<TypedInteraction, P>) {
        own.minus_time_step = -interaction_.time_step(particles_);
      }
      return own;
    });
    const double dt = -all.minus_time_step;
    const bool are_there_none = !(all.wanted > 0);
    // The last particle may leave during a run.
    if (!is_finite(dt) && are_there_none && last_time_step_ > 0) return last_time_step_;
    if (!is_finite(dt)) {
      fail({"Simulation: the interaction chooses no time step",
            are_there_none ? ", as there are no particles" : "",
            "; pass one: run({.time_step = …}) or step(dt)"});
    }
    return dt;
  }

  /// One step with the time step that the interaction chooses; shorter if that is not stable for
  /// the present contacts.
  void step() {
    double dt = time_step();
    while (true) {
      try {
        return step(dt);
      } catch (const Error& error) {
        if (!error.stable_time_step()) throw;
        dt = detail::shorter_time_step(dt, error);
      }
    }
  }

  /// One step of dt [s]. Throws silt::Error if dt is not positive or exceeds the stability limit,
  /// if a field is not finite after the step, if the interaction finds that it went wrong (see
  /// core/watch.hpp), if a particle left a box with OnEscape::refuse, or if a solve failed. The
  /// step is then rolled back: the simulation is as before the call.
  void step(double dt) {
    detail::Team team(thread_choice_, particles_.size());
    team.begin_step();
    StepState step{.finished = {.time = time_, .time_step = dt}};
    try {
      Transaction transaction(*this);
      const Largest before = prepare_step(dt);
      const Largest after = Processes::together(particles_, [&] {
        update_halo(before);
        sort();
        transaction.save();
        return advance(step);
      });
      check_energy(step.finished, after);
      remove_escaped(step, after, transaction);
      transaction.commit();
    } catch (const Error& error) {
      fail_step(step, error);
    }
    particles_lost_ += step.removed;
    time_ += dt;
    ++steps_;
    last_time_step_ = dt;
    team.end_step();
  }

  /// Advances until time() ≥ until. Returns true, or false if an observer ended the run before. If
  /// time() is at or beyond `until` already, no step is made. Observers are called for outputs: at
  /// the beginning, at the first step at or after every multiple of output_every, and at the end;
  /// and before and after every step, see Observer in core/concepts.hpp.
  ///
  /// A run that an observer ended makes no output at its end; the next run() continues it and makes
  /// none at its beginning. The same holds for the first run() after reading a checkpoint that was
  /// written during a run. If that checkpoint was written during a later run of the program, this
  /// call returns at once. Throws silt::Error if a member of `run` is out of range, if more than
  /// 10¹² steps or outputs are ahead, and what step() throws.
  template <class... Observers>
    requires(Observer<Observers, Simulation> && ...)
  bool run(const Run& run, Observers&&... observers) {
    return detail::RunLoop(*this, run, observers...).perform();
  }

 private:
  template <class, class...>
  friend class detail::RunLoop;

  using Processes = detail::Processes<P>;
  using Transaction = detail::StepTransaction<Simulation, P>;
  friend Transaction;

  static constexpr bool synchronises =
      requires(T t, P p, S s, TypedInteraction i) { t.synchronise(p, s, i); };
  // See Integrator in core/concepts.hpp.
  static constexpr bool verifies_results = requires(T t, P p, S s, TypedInteraction i) {
    { t.step(p, s, i, 0.0) } -> std::same_as<bool>;
  };
  static constexpr bool copies_for_state = synchronises || Processes::are_several;

  // What becomes known in a step.
  struct StepState {
    FinishedStep finished;
    bool is_result_finite = true;
    Index removed = 0;  // of the particles of all processes
  };

  // --- prepare ---

  // Sets the search radius, which must be at least the interaction range, of all processes.
  Largest prepare() {
    return set_radius(Processes::together(particles_, [&] { return range(); }));
  }
  Largest prepare_step(double dt) {
    const Largest all = Processes::together(particles_, [&] {
      require_positive("Simulation: time_step", dt);
      if (time_ + dt == time_) {
        fail({"Simulation: time_step = ", dt, " s does not change the time; increase it"});
      }
      set_time(interaction_, time_);
      Largest own = range();
      own.time_step = dt;
      own.minus_time_step = -dt;
      return own;
    });
    if (all.time_step != -all.minus_time_step) {
      fail({"Simulation: time_step is ", -all.minus_time_step, " s in one process and ",
            all.time_step, " s in another; give all the same"});
    }
    return set_radius(all);
  }
  Largest range() const {
    Largest own{.reach = double(interaction_.reach(particles_)),
                .displacement = Processes::moved_since_halo(particles_)};
    require_not_negative("Simulation: interaction range", own.reach);
    return own;
  }
  Largest set_radius(const Largest& all) {
    const auto reach = static_cast<typename P::Real>(all.reach);
    if (chooses_radius_) {
      search_.set_radius(reach > 0 ? reach : radius_without_range());
    } else if (search_.radius() < reach) {
      fail({"Simulation: the search radius ", search_.radius(),
            " m is smaller than the interaction range, ", reach,
            " m; increase it, or do not set it"});
    }
    return all;
  }
  void update_halo(const Largest& before) {
    Processes::update_halo(particles_, interaction_, double(search_.radius()), before);
  }
  // Called before the state is saved: rolling back a step does not undo the reordering.
  void sort() {
    if constexpr (SortsParticles<S, P>) {
      if (needs_search(interaction_, particles_)) search_.sort(particles_);
    }
  }

  // --- advance and check ---

  Largest advance(StepState& step) {
    FinishedStep& finished = step.finished;
    const Travel travel = detail::travel_of(particles_);
    bool is_verified = false;
    if constexpr (verifies_results) {
      is_verified = integrator_.step(particles_, search_, interaction_, finished.time_step);
    } else {
      integrator_.step(particles_, search_, interaction_, finished.time_step);
    }
    if (!is_verified) {
      const auto broken = detail::find_not_finite(particles_);
      step.is_result_finite = !broken;
      if (broken) detail::fail_after_step(particles_, *broken);
    }
    finished.max_displacement = detail::max_displacement_since(travel, particles_);
    finished.max_energy_gain = detail::max_energy_gain_of(integrator_);
    detail::check_step(interaction_, particles_, finished);
    if (!is_verified) detail::check_escaped(particles_);
    return {.displacement = finished.max_displacement,
            .energy_gain = particles_.empty() ? 0 : finished.max_energy_gain,
            .wanted = !is_verified && must_remove_escaped() ? 1.0 : 0.0};
  }
  void check_energy(FinishedStep finished, const Largest& after) {
    finished.max_energy_gain = after.energy_gain;
    if (!detail::must_check_energy(interaction_, particles_, finished)) return;
    Processes::together(particles_, [&] {
      detail::check_energy(interaction_, particles_, finished);
      return Largest{};
    });
  }
  // The last part of a step: the removed particles are copied before, and the halo is of those that
  // remain.
  void remove_escaped(StepState& step, const Largest& after, Transaction& transaction) {
    const bool must_remove = after.wanted > 0;
    if (must_remove) {
      Processes::together(particles_, [&] {
        step.removed = transaction.remove_if(is_outside());
        return Largest{};
      });
      step.removed = Index(detail::sum_of_all(particles_, double(step.removed)));
    }
    Processes::finish_step(particles_, step.finished.max_displacement, after);
    if (!must_remove) return;
    Processes::together(particles_, [&] {
      search_.update(particles_);  // its indices are out of date
      return Largest{};
    });
  }

  // Search radius if the interaction range is 0: arbitrary, but with its skin it must fit into a
  // periodic box.
  typename P::Real radius_without_range() const {
    typename P::Real result = 1;
    const auto& box = particles_.box();
    for (int k = 0; k < P::dimension; ++k) {
      const bool is_periodic = box.periodic[static_cast<std::size_t>(k)];
      if (is_periodic) result = std::min(result, (box.upper[k] - box.lower[k]) / 4);
    }
    return result;
  }

  // --- the transaction ---

  // After it was rolled back.
  [[noreturn]] void fail_step(const StepState& step, const Error& error) const {
    if (!step.is_result_finite) {
      detail::check_finite_before_step(particles_, {.step = steps_, .time = time_});
    }
    throw error.with_step(steps_, time_);
  }

  void save() {
    particles_.save();
    particles_.for_each_field([this]<class F>(auto, F field) {
      if constexpr (role_of<F>() == Role::state && !AdvancesField<T, F>) particles_.keep(field);
    });
    if constexpr (Transactional<S>) search_.save();
    if constexpr (Transactional<TypedInteraction>) interaction_.save();
    saved_integrator_ = integrator_;
  }
  [[gnu::cold]] void restore() noexcept {
    particles_.restore();
    if constexpr (requires { search_.restore(particles_); }) {
      search_.restore(particles_);
    } else if constexpr (Transactional<S>) {
      search_.restore();
    }
    if constexpr (Transactional<TypedInteraction>) interaction_.restore();
    integrator_ = *saved_integrator_;
  }

  auto is_outside() const {
    return [&box = particles_.box(), x = std::as_const(particles_)[position]](Index i) {
      return !box.contains(x[i]);
    };
  }
  bool must_remove_escaped() const {
    return particles_.box().on_escape == OnEscape::remove &&
           first_where(particles_.size(), is_outside()) != no_index;
  }

  P particles_;
  S search_;
  TypedInteraction interaction_;
  T integrator_;
  std::optional<T> saved_integrator_;
  bool chooses_radius_;
  std::uint64_t steps_ = 0;
  std::uint64_t particles_lost_ = 0;
  double time_ = 0;
  double last_time_step_ = 0;
  detail::ThreadChoice thread_choice_;
  bool was_read_ = false;
  detail::RunState run_;
};

// A simulation built from the interaction of another one has the same type.
template <class P, class S, class I, class T>
Simulation(P, S, I, T) -> Simulation<P, S, ForParticles<I, P>, T>;

}  // namespace silt
