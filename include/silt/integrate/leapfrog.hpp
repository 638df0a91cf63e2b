// SPDX-License-Identifier: MIT
// Leapfrog, [SahChoi2004] (15)–(33): positions at whole steps, velocities and spins at half steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/integrate/damping.hpp>

namespace silt {

/// Forces and moments to zero.
template <class P>
void clear(P& particles) {
  const auto f = particles[force];
  for_each(particles.size(), [&](Index i) { f[i].setZero(); });
  if constexpr (HasFields<P, torque_t>) {
    const auto m = particles[torque];
    const auto zero = zero_of<typename P::Spin>();
    for_each(particles.size(), [&](Index i) { m[i] = zero; });
  }
}

/// v^{N−½} → v^{N+½} (32) and, where particles turn, θ'^{N−½} → θ'^{N+½} (33).
template <class P, class D>
void kick(P& particles, const D& damping, double time_step) {
  using Vec = typename P::Vec;
  const auto dt = static_cast<typename P::Real>(time_step);
  const auto v = particles[velocity];
  const auto f = particles[force];
  const auto m = particles[mass];
  for_each(particles.size(),
           [&](Index i) { v[i] = damping.kicked(Vec(v[i]), Vec(f[i] / m[i]), dt); });
  if constexpr (HasFields<P, spin_t, torque_t, inertia_t>) {
    using Spin = typename P::Spin;
    const auto w = particles[spin];
    const auto t = particles[torque];
    const auto inertias = particles[inertia];
    for_each(particles.size(),
             [&](Index i) { w[i] = damping.kicked(Spin(w[i]), Spin(t[i] / inertias[i]), dt); });
  }
}

/// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
template <class P>
void drift(P& particles, double time_step) {
  const auto dt = static_cast<typename P::Real>(time_step);
  const auto x = particles[position];
  const auto v = particles[velocity];
  for_each(particles.size(), [&](Index i) { x[i] += v[i] * dt; });
  if constexpr (HasFields<P, spin_t, angle_t>) {
    const auto w = particles[spin];
    const auto turned = particles[angle];
    for_each(particles.size(), [&](Index i) { turned[i] += w[i] * dt; });
  }
}

/// Advances particles under forces. The velocities given at the start are those at time 0; from the
/// first step on, `velocity` and `spin` hold v^{N−½}, and Simulation::snapshot() gives v^N (27) (28).
template <Damping<double> D = NoDamping>
class Leapfrog {
 public:
  Leapfrog() = default;
  /// Throws if the damping's numbers are out of range.
  explicit Leapfrog(D damping) : damping_(damping) {
    if constexpr (requires { damping.check(); }) damping.check();
  }

  template <class P, class S, class I>
    requires Interaction<I, P, S> && HasFields<P, velocity_t, force_t, mass_t>
  void step(P& particles, S& search, I& interaction, double dt) {
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    if (!started_) start(particles, search, interaction, dt);
    // A changed time step moves the half step; with a constant one this is dt.
    const double between_half_steps = (last_time_step_ + dt) / 2;

    search.update(particles);
    clear(particles);
    interaction.accelerate(particles, search, dt);
    kick(particles, damping_, between_half_steps);
    drift(particles, dt);

    last_time_step_ = dt;
  }

  /// Brings velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before the
  /// first step they are there already, and only the forces are made.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    const P before = particles;
    search.update(particles);
    clear(particles);
    interaction.accelerate(particles, search, last_time_step_);
    kick(particles, damping_, last_time_step_);
    average(particles, before, velocity);
    if constexpr (HasFields<P, spin_t>) average(particles, before, spin);
  }

 private:
  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // what contacts remember must not grow by a step that is not made
    search.update(particles);
    clear(particles);
    trial.accelerate(particles, search, dt);
    step_back(particles[velocity], particles[force], particles[mass], dt);
    if constexpr (HasFields<P, spin_t, torque_t, inertia_t>) {
      step_back(particles[spin], particles[torque], particles[inertia], dt);
    }
  }

  template <class Values, class Sums, class Inertias>
  void step_back(Values v, Sums sums, Inertias inertias, double time_step) {
    using Value = typename Values::value_type;
    using Real = typename Inertias::value_type;
    for_each(v.size(), [&](Index i) {
      const Value a = sums[i] / inertias[i];
      if constexpr (requires { damping_.half_step_before(a, a, Real(time_step)); }) {
        v[i] = damping_.half_step_before(Value(v[i]), a, Real(time_step));
      } else {
        v[i] -= a * Real(time_step / 2);
      }
    });
  }

  template <class P, class F>
  static void average(P& after, const P& before, F field) {
    const auto v = after[field];
    const auto v_before = before[field];
    for_each(v.size(), [&](Index i) { v[i] = (v[i] + v_before[i]) / 2; });
  }

  D damping_{};
  bool started_ = false;
  double last_time_step_ = 0;
};

}  // namespace silt
