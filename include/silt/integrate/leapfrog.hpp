// SPDX-License-Identifier: MIT
// Leapfrog, [SahChoi2004] (15)–(33): positions at whole steps, velocities and spins at half steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/integrate/damping.hpp>

#include <algorithm>
#include <concepts>
#include <span>
#include <utility>
#include <vector>

namespace silt {

template <class F, class... Fs>
inline constexpr bool one_of = (std::same_as<F, Fs> || ...);

/// The motion of particles, one at a time, from the fields before to those after a step.
template <class P>
class Motion {
  using Vec = typename P::Vec;
  using Spin = typename P::Spin;
  using Real = typename P::Real;

 public:
  explicit Motion(P& particles)
      : x_(particles.advance(position)),
        v_(particles.advance(velocity)),
        f_(particles.advance(force).after),
        m_(particles[mass]) {
    if constexpr (turns) {
      w_ = particles.advance(spin);
      t_ = particles.advance(torque).after;
      inertias_ = particles[inertia];
    }
    if constexpr (has_angle) angle_ = particles.advance(angle);
  }

  /// Force and moment to zero.
  void clear(Index i) {
    f_[i].setZero();
    if constexpr (turns) t_[i] = zero_of<Spin>();
  }

  /// v^{N−½} → v^{N+½} (32) and, where particles turn, θ'^{N−½} → θ'^{N+½} (33).
  template <class D>
  void kick(Index i, const D& damping, double dt) {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return damping.kicked(v, a, Real(dt));
    });
  }

  /// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28); positions stay.
  template <class D>
  void kick_to_the_mean(Index i, const D& damping, double dt) {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return (damping.kicked(v, a, Real(dt)) + v) / 2;
    });
    stay(i);
  }

  /// v^N → v^{N−½}; positions stay.
  template <class D>
  void step_back(Index i, const D& damping, double dt) {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      if constexpr (requires { damping.half_step_before(v, a, Real(dt)); }) {
        return damping.half_step_before(v, a, Real(dt));
      } else {
        return v - a * Real(dt / 2);
      }
    });
    stay(i);
  }

  /// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
  void drift(Index i, double dt) {
    x_.after[i] = x_.before[i] + v_.after[i] * Real(dt);
    if constexpr (has_angle) angle_.after[i] = angle_.before[i] + w_.after[i] * Real(dt);
  }

  /// False if something of particle i is not finite; rarely also if it is merely huge.
  bool is_sound(Index i) const {
    Real sum = x_.after[i].sum() + v_.after[i].sum();
    if constexpr (turns) sum += sum_of(w_.after[i]);
    if constexpr (has_angle) sum += sum_of(angle_.after[i]);
    return is_finite(sum);
  }

 private:
  static constexpr bool turns = HasFields<P, spin_t, torque_t, inertia_t>;
  static constexpr bool has_angle = turns && HasFields<P, angle_t>;

  // set(velocity before, acceleration) gives the one after.
  template <class Set>
  void set_velocities(Index i, Set&& set) {
    v_.after[i] = set(Vec(v_.before[i]), Vec(f_[i] / m_[i]));
    if constexpr (turns) w_.after[i] = set(Spin(w_.before[i]), Spin(t_[i] / inertias_[i]));
  }

  void stay(Index i) {
    x_.after[i] = x_.before[i];
    if constexpr (has_angle) angle_.after[i] = angle_.before[i];
  }

  static Real sum_of(const Spin& turning) {
    if constexpr (P::dimension == 2) {
      return turning;
    } else {
      return turning.sum();
    }
  }

  template <class Value>
  using Advance = typename P::template Advance<Value>;
  Advance<Vec> x_;
  Advance<Vec> v_;
  std::span<Vec> f_;
  std::span<const Real> m_;
  Advance<Spin> w_;
  Advance<Spin> angle_;
  std::span<Spin> t_;
  std::span<const Real> inertias_;
};

// The same for all particles, for an integrator of one's own.

/// Motion that changes the particles in place, so that each of its verbs may be called alone.
template <class P>
Motion<P> motion_in_place(P& particles) {
  particles.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() != Role::constant) particles.keep(field);
  });
  return Motion<P>(particles);
}

/// Forces and moments to zero.
template <class P>
void clear(P& particles) {
  auto motion = motion_in_place(particles);
  for_each(particles.size(), [&](Index i) { motion.clear(i); });
}

/// v^{N−½} → v^{N+½} (32) and, where particles turn, θ'^{N−½} → θ'^{N+½} (33).
template <class P, class D>
void kick(P& particles, const D& damping, double time_step) {
  auto motion = motion_in_place(particles);
  for_each(particles.size(), [&](Index i) { motion.kick(i, damping, time_step); });
}

/// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
template <class P>
void drift(P& particles, double time_step) {
  auto motion = motion_in_place(particles);
  for_each(particles.size(), [&](Index i) { motion.drift(i, time_step); });
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
    const auto add_forces = make_forces(particles, search, interaction, dt);
    advance(particles, [&](Motion<P>& motion, Index i) {
      add_forces(motion, i);
      motion.kick(i, damping_, between_half_steps);
      motion.drift(i, dt);
    });

    last_time_step_ = dt;
  }

  /// Brings velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before the
  /// first step they are there already, and only the forces are made.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    search.update(particles);
    const auto add_forces = make_forces(particles, search, interaction, last_time_step_);
    advance(particles, [&](Motion<P>& motion, Index i) {
      add_forces(motion, i);
      motion.kick_to_the_mean(i, damping_, last_time_step_);
    });
  }

  // See AdvancesField in core/concepts.hpp.
  template <class F>
  static constexpr bool advances =
      one_of<F, position_t, velocity_t, spin_t, angle_t, force_t, torque_t>;
  bool all_finite() const noexcept { return all_finite_; }

 private:
  // What adds the forces of particle i: at once, where the interaction can do that for one particle.
  template <class P, class S, class I>
  static auto make_forces(P& particles, S& search, I& interaction, double dt) {
    if constexpr (ActsByParticle<I, P, S>) {
      interaction.interact(particles, search, dt);
      return [&particles, &interaction = std::as_const(interaction)](Motion<P>& motion, Index i) {
        motion.clear(i);
        interaction.add_forces(particles, i);
      };
    } else {
      clear(particles);
      interaction.accelerate(particles, search, dt);
      return [](Motion<P>&, Index) {};
    }
  }

  // move(motion, i) for every particle.
  template <class P, class Move>
  void advance(P& particles, Move&& move) {
    const Motion<P> all(particles);
    sound_.resize(chunk_count(particles.size()));
    for_each_chunk(particles.size(), [&](Chunk chunk) __attribute__((flatten)) {
      Motion<P> motion = all;  // where no store can reach it
      bool sound = true;
      for (Index i = chunk.first; i < chunk.last; ++i) {
        move(motion, i);
        sound &= motion.is_sound(i);
      }
      sound_[chunk.number] = sound;
    });
    all_finite_ = std::all_of(sound_.begin(), sound_.end(), [](char sound) { return sound; });
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // what contacts remember must not grow by a step that is not made
    search.update(particles);
    const auto add_forces = make_forces(particles, search, trial, dt);
    advance(particles, [&](Motion<P>& motion, Index i) {
      add_forces(motion, i);
      motion.step_back(i, damping_, dt);
    });
  }

  D damping_{};
  bool started_ = false;
  bool all_finite_ = false;
  double last_time_step_ = 0;
  std::vector<char> sound_;  // by chunk
};

}  // namespace silt
