// SPDX-License-Identifier: MIT
// The watch: after every step, the interaction may check what the step did. It throws in the step
// that went wrong, before the results are used; the step is then rolled back.
#pragma once

#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/travel.hpp>
#include <silt/core/types.hpp>

#include <limits>

namespace silt {

/// What is known of a step when it is checked.
struct FinishedStep {
  double time = 0;       ///< at its beginning [s]
  double time_step = 0;  ///< [s]
  /// No particle moved farther [m]; infinite if the integrator does not tell.
  double max_displacement = std::numeric_limits<double>::infinity();
  /// The kinetic energy is at most this times that with which the forces were evaluated [-];
  /// infinite if the integrator does not tell.
  double max_energy_gain = std::numeric_limits<double>::infinity();
};

/// i.check_step(p, step) throws if the particles moved farther in the step than the method can
/// resolve, or gained energy that nothing had. Models: dem::ContactsOf, mps::BasicFlow, Forces.
template <class I, class P>
concept ChecksSteps =
    requires(const I i, const P& p, const FinishedStep& step) { i.check_step(p, step); };

/// i.check_energy(p, step) throws if the interaction gave the particles energy that nothing had. It is
/// called if step.max_energy_gain exceeds i.max_energy_gain(), or after every step if there is no such
/// function; in all processes that share the particles, for those of all, see
/// core/shared_particles.hpp. Models: dem::ContactsOf, Forces.
template <class I, class P>
concept ChecksEnergy =
    requires(const I i, const P& p, const FinishedStep& step) { i.check_energy(p, step); };

/// Number of the first particle whose velocity takes it farther in the step than most(i) [m];
/// `no_index` if there is none. least_most [m] is at most each of them.
template <class P, class F>
Index find_too_far_moved(const P& particles, const FinishedStep& step, double least_most,
                         F&& most) {
  if (step.max_displacement <= least_most) return no_index;
  const auto v = particles[velocity];
  return first_where(particles.size(), [&](Index i) {
    return !(double(v[i].norm()) * step.time_step <= double(most(i)));
  });
}

namespace detail {

/// The travel of particles that measure it.
template <class P>
Travel travel_of(const P& particles) {
  if constexpr (requires { particles.travel(); }) {
    return particles.travel();
  } else {
    return {};
  }
}

/// Upper bound of the displacements since `then` [m]; infinite if it is not known.
template <class P>
double max_displacement_since(const Travel& then, const P& particles) {
  const Travel now = travel_of(particles);
  if (then.epoch == 0 || now.epoch != then.epoch) return std::numeric_limits<double>::infinity();
  return (now.distance - then.distance) + std::numeric_limits<double>::epsilon() * now.distance;
}

/// FinishedStep::max_energy_gain of the last step of an integrator.
template <class T>
double max_energy_gain_of(const T& integrator) {
  if constexpr (requires { integrator.max_energy_gain(); }) {
    return integrator.max_energy_gain();
  } else {
    return std::numeric_limits<double>::infinity();
  }
}

/// Calls check_step() of an interaction that has it.
template <class I, class P>
void check_step(const I& interaction, const P& particles, const FinishedStep& step) {
  if constexpr (ChecksSteps<I, P>) interaction.check_step(particles, step);
}
/// Whether check_energy() has to be called, by an interaction or one of its parts.
template <class I, class P>
bool must_check_energy([[maybe_unused]] const I& interaction, [[maybe_unused]] const P& particles,
                       [[maybe_unused]] const FinishedStep& step) {
  if constexpr (requires { interaction.for_each_part([](const auto&) {}); }) {
    bool must = false;
    interaction.for_each_part(
        [&](const auto& part) { must = must || must_check_energy(part, particles, step); });
    return must;
  } else if constexpr (!ChecksEnergy<I, P>) {
    return false;
  } else if constexpr (requires { interaction.max_energy_gain(); }) {
    return !(step.max_energy_gain <= double(interaction.max_energy_gain()));
  } else {
    return true;
  }
}
/// Calls it there.
template <class I, class P>
void check_energy(const I& interaction, const P& particles, const FinishedStep& step) {
  if constexpr (ChecksEnergy<I, P>) {
    if (must_check_energy(interaction, particles, step)) interaction.check_energy(particles, step);
  }
}

}  // namespace detail

}  // namespace silt
