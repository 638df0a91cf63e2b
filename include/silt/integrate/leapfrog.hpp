// SPDX-License-Identifier: MIT
// Leapfrog, [SahChoi2004] (15)–(33): positions at whole steps, velocities and spins at half steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/integrate/damping.hpp>
#include <silt/integrate/leapfrog_operations.hpp>
#include <silt/integrate/motion.hpp>
#include <silt/integrate/outcome_of_step.hpp>
#include <silt/integrate/update_of_range.hpp>

#include <concepts>
#include <limits>
#include <tuple>
#include <utility>

namespace silt {

namespace detail {
/// Throws if a mass or moment of inertia, by which forces and torques are divided, is not positive
/// and finite.
template <class P>
void check_inertia(const P& particles) {
  const auto check = [&](auto field, const char* name, const char* unit) {
    const auto values = particles[field];
    const Index odd =
        first_where(values.size(), [&](Index i) { return !is_positive_normal(values[i]); });
    if (odd == no_index) return;
    fail({"Leapfrog: ", name, " = ", values[odd], " ", unit,
          " of a particle must be a positive, finite and normal number; set it"},
         {.particle = odd, .id = particles.id(odd)});
  };
  check(mass, "mass", "kg");
  if constexpr (HasFields<P, spin_t, torque_t, inertia_t>) check(inertia, "inertia", "kg m²");
}
}  // namespace detail

/// Advances particles under forces, [SahChoi2004] (15)–(33). The initial velocities are those at
/// time 0; from the first step on, `velocity` and `spin` hold v^{N−½}, and Simulation::snapshot()
/// returns v^N (27), (28).
///
/// The first step evaluates the forces at time 0 twice, for v^{−½} and v^{½}. Pairs that overlap at
/// time 0 have not slipped or rolled yet: their springs, apart from k_n δ, are unwound, and
/// deflected by v^{½} Δt in the second step.
///
/// The first step throws if a mass or moment of inertia is not positive and finite, as does a later
/// one of which the result is not valid.
template <Damping<double> D = NoDamping>
class Leapfrog {
 public:
  Leapfrog() = default;
  /// Throws if a parameter of the damping model is out of range.
  explicit Leapfrog(D damping) : damping_(damping) {
    if constexpr (requires { damping.check(); }) damping.check();
  }

  /// The damping model with its parameters.
  const D& damping() const noexcept { return damping_; }

  /// Replaces it from the next step on, for example by one without damping after a filling: between
  /// two runs, or in an observer's before_step. Not in checkpoints. Throws as the constructor does.
  void set_damping(D damping) {
    if constexpr (requires { damping.check(); }) damping.check();
    damping_ = damping;
  }

  template <class P, class S, class I>
    requires Interaction<I, P, S> && HasFields<P, velocity_t, force_t, mass_t>
  bool step(P& particles, S& search, I& interaction, double dt) {
    static_assert(!move_in_bodies<P>,
                  "silt::Leapfrog: some of these grains are spheres of clumps; use "
                  "dem::ClumpLeapfrog");
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    set_last_time_step(interaction, started_ ? last_time_step_ : 0);
    const bool is_first = !started_;
    if (is_first) start(particles, search, interaction, dt);
    // The time between the half steps; dt if the time step is constant.
    const double between_half_steps = (last_time_step_ + dt) / 2;

    const std::tuple kick_and_drift{detail::Kick{damping_, between_half_steps}, detail::Drift{dt}};
    const bool is_valid =
        advance(particles, search, interaction, dt, detail::UpdateOfRange<P>(kick_and_drift));
    // Not before: interactions that check masses, such as contacts, tell more. And not in every
    // step, since it reads all particles once more.
    if (is_first || !is_valid) detail::check_inertia(std::as_const(particles));

    last_time_step_ = dt;
    return is_valid;
  }

  /// Advances velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before
  /// the first step they are at N already, and only the forces are evaluated.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    const std::tuple kick_to_mean{detail::KickToMean{damping_, last_time_step_}};
    set_last_time_step(interaction, last_time_step_);
    advance(particles, search, interaction, last_time_step_,
            detail::UpdateOfRange<P>(kick_to_mean));
  }

  /// Writes or reads the state of the integrator for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("started", started_);
    archive("last_time_step", last_time_step_);
  }

  /// Upper bound of the gain of kinetic energy in the last step [-], see FinishedStep in
  /// core/watch.hpp.
  double max_energy_gain() const noexcept { return max_energy_gain_; }

  // See AdvancesField in core/concepts.hpp.
  template <class F>
  static constexpr bool advances = one_of<F, position_t, velocity_t, spin_t, angle_t>;

 private:
  // Evaluates the forces and then updates every particle, range by range if the interaction allows.
  // Returns whether all results are valid.
  template <class P, class S, class I>
  bool advance(P& particles, S& search, I& interaction, double dt,
               const detail::UpdateOfRange<P>& update) {
    if (needs_search(interaction, particles)) search.update(particles);
    const detail::FieldsOfMotion<P> fields(particles);
    detail::OutcomeOfStep<P> outcome(particles.size());
    const auto clear_forces = [&](Index first, Index last) { clear(particles, first, last); };
    const auto move = [&](Index first, Index last) {
      outcome.add(first, update(fields, first, last));
    };
    if constexpr (AcceleratesInPass<I, P, S>) {
      // Otherwise contacts of a range would see others that have moved.
      if (detail::moves_in_other_memory(particles)) {
        interaction.accelerate(particles, search, dt, {clear_forces, move});
        return finish(particles, outcome);
      }
    }
    for_each_range(particles.size(), clear_forces);
    interaction.accelerate(particles, search, dt);
    for_each_range(particles.size(), move);
    return finish(particles, outcome);
  }
  template <class P>
  bool finish(P& particles, const detail::OutcomeOfStep<P>& outcome) {
    particles.finish_advance(outcome.max_displacement());
    max_energy_gain_ = outcome.max_energy_gain();
    return outcome.is_valid();
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  [[gnu::cold]] void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // a copy: the contact histories must not advance
    const std::tuple step_back{detail::StepBack{damping_, dt}};
    advance(particles, search, trial, dt, detail::UpdateOfRange<P>(step_back));
    detail::refresh_halo(particles);
  }

  D damping_{};
  bool started_ = false;
  double last_time_step_ = 0;
  double max_energy_gain_ = std::numeric_limits<double>::infinity();
};

}  // namespace silt
