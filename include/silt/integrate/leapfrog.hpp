// SPDX-License-Identifier: MIT
// Leapfrog, [SahChoi2004] (15)–(33): positions at whole steps, velocities and spins at half steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/integrate/damping.hpp>

#include <algorithm>
#include <concepts>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

template <class F, class... Fs>
inline constexpr bool one_of = (std::same_as<F, Fs> || ...);

/// The motion of particles, one at a time, from the fields before to those after a step. Written
/// over lanes, a loop that calls it becomes vector instructions; see core/lane.hpp.
template <class P>
class Motion {
  using Real = typename P::Real;
  using Scalar = Lane<Real>;
  using Vec = silt::Vec<P::dimension, Scalar>;
  using AngularVec = silt::AngularVec<P::dimension, Scalar>;

 public:
  explicit Motion(P& particles)
      : x_(of(particles.advance(position))),
        v_(of(particles.advance(velocity))),
        f_(lanes_of(particles[force].data())),
        m_(lanes_of(particles[mass].data())) {
    if constexpr (turns) {
      w_ = of(particles.advance(spin));
      t_ = lanes_of(particles[torque].data());
      inertias_ = lanes_of(particles[inertia].data());
    }
    if constexpr (has_angle) angle_ = of(particles.advance(angle));
  }

  /// Whether what was before is written over.
  bool is_in_place() const { return x_.before == x_.after; }

  /// v^{N−½} → v^{N+½} (32) and, where particles turn, θ'^{N−½} → θ'^{N+½} (33).
  template <class D>
  void kick(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return damping.kicked(v, a, Scalar(dt));
    });
  }

  /// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28); positions stay.
  template <class D>
  void kick_to_the_mean(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return (damping.kicked(v, a, Scalar(dt)) + v) / Scalar(2);
    });
    stay(i);
  }

  /// v^N → v^{N−½}; positions stay.
  template <class D>
  void step_back(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      if constexpr (requires { damping.half_step_before(v, a, Scalar(dt)); }) {
        return damping.half_step_before(v, a, Scalar(dt));
      } else {
        return v - a * Scalar(dt / 2);
      }
    });
    stay(i);
  }

  /// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
  void drift(Index i, double dt) const {
    x_.after[i] = x_.before[i] + v_.after[i] * Scalar(dt);
    if constexpr (has_angle) angle_.after[i] = angle_.before[i] + w_.after[i] * Scalar(dt);
  }

  /// False if something of particle i is not finite; rarely also if it is merely huge.
  bool is_sound(Index i) const {
    Real sum = x_.after[i].sum() + v_.after[i].sum();
    if constexpr (turns) sum += sum_of(w_.after[i]);
    if constexpr (has_angle) sum += sum_of(angle_.after[i]);
    return sum - sum == 0;  // no call, as is_finite() makes one
  }

 private:
  static constexpr bool turns = HasFields<P, spin_t, torque_t, inertia_t>;
  static constexpr bool has_angle = turns && HasFields<P, angle_t>;

  // set(velocity before, acceleration) gives the one after.
  template <class Set>
  void set_velocities(Index i, Set&& set) const {
    v_.after[i] = set(Vec(v_.before[i]), Vec(f_[i] * (1 / m_[i])));
    if constexpr (turns) w_.after[i] = set(AngularVec(w_.before[i]), AngularVec(t_[i] * (1 / inertias_[i])));
  }

  void stay(Index i) const {
    x_.after[i] = x_.before[i];
    if constexpr (has_angle) angle_.after[i] = angle_.before[i];
  }

  static Real sum_of(const AngularVec& turning) {
    if constexpr (P::dimension == 2) {
      return turning;
    } else {
      return turning.sum();
    }
  }

  template <class Value>
  struct Column {
    const Value* before;
    Value* after;
  };
  template <class Advance>
  static auto of(const Advance& field) {
    auto* const after = lanes_of(field.after.data());
    return Column<std::remove_pointer_t<decltype(after)>>{lanes_of(field.before.data()), after};
  }

  Column<Vec> x_;
  Column<Vec> v_;
  const Vec* f_;
  const Scalar* m_;
  Column<AngularVec> w_{};
  Column<AngularVec> angle_{};
  const AngularVec* t_ = nullptr;
  const Scalar* inertias_ = nullptr;
};

// The same for all particles, for an integrator of one's own.

/// Motion that changes the particles in place, so that each of its verbs may be called alone.
template <class P>
Motion<P> motion_in_place(P& particles) {
  particles.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() == Role::state) particles.keep(field);
  });
  return Motion<P>(particles);
}

/// Forces and moments of particles [first, last) to zero.
template <class P>
void clear(P& particles, Index first, Index last) {
  const auto set_zero = [=](auto values) {
    std::fill(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(last),
              zero_of<typename decltype(values)::value_type>());
  };
  set_zero(particles[force]);
  if constexpr (HasFields<P, torque_t>) set_zero(particles[torque]);
}

/// Forces and moments to zero.
template <class P>
void clear(P& particles) {
  for_each_chunk(particles.size(), [&](Chunk c) { clear(particles, c.first, c.last); });
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

/// Advances particles under forces. The velocities given at the start are those at time 0;
/// from the first step on, `velocity` and `spin` hold v^{N−½}, and Simulation::snapshot()
/// gives v^N (27) (28).
template <Damping<double> D = NoDamping>
class Leapfrog {
 public:
  Leapfrog() = default;
  /// Throws if the damping's numbers are out of range.
  explicit Leapfrog(D damping) : damping_(damping) {
    if constexpr (requires { damping.check(); }) damping.check();
  }

  const D& damping() const noexcept { return damping_; }

  template <class P, class S, class I>
    requires Interaction<I, P, S> && HasFields<P, velocity_t, force_t, mass_t>
  void step(P& particles, S& search, I& interaction, double dt) {
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    if (!started_) start(particles, search, interaction, dt);
    // A changed time step moves the half step; with a constant one this is dt.
    const double between_half_steps = (last_time_step_ + dt) / 2;

    search.update(particles);
    advance(particles, search, interaction, dt,
            [=, damping = damping_](const Motion<P>& motion, Index i) {
              motion.kick(i, damping, between_half_steps);
              motion.drift(i, dt);
            });

    last_time_step_ = dt;
  }

  /// Brings velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before
  /// the first step they are there already, and only the forces are made.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    search.update(particles);
    advance(particles, search, interaction, last_time_step_,
            [dt = last_time_step_, damping = damping_](const Motion<P>& motion, Index i) {
              motion.kick_to_the_mean(i, damping, dt);
            });
  }

  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("started", started_);
    archive("last_time_step", last_time_step_);
  }

  // See AdvancesField in core/concepts.hpp.
  template <class F>
  static constexpr bool advances = one_of<F, position_t, velocity_t, spin_t, angle_t>;
  bool all_finite() const noexcept { return all_finite_; }

 private:
  // Makes the forces, and then move(motion, i) for every particle; chunk by chunk, where the
  // interaction can.
  template <class P, class S, class I, class Move>
  void advance(P& particles, S& search, I& interaction, double dt, Move&& move) {
    sound_.assign(chunk_count(particles.size()), true);
    const auto move_all_of = [&](const Motion<P>& motion, Index first, Index last) {
      sound_[first / chunk_size] &= all_sound_after(move, motion, first, last);
    };
    if constexpr (AddsForces<I, P>) {
      prepare(interaction, particles, search, dt);
      const Motion<P> motion(particles);
      for_each_chunk_with_forces(interaction, particles, [&](Chunk chunk) {
        constexpr Index block = 64;  // what stays at hand between the two
        for (Index first = chunk.first; first < chunk.last; first += block) {
          const Index last = std::min(first + block, chunk.last);
          clear(particles, first, last);
          for (Index i = first; i < last; ++i) std::as_const(interaction).add_forces(particles, i);
          if (!motion.is_in_place()) move_all_of(motion, first, last);
        }
      });
      conclude(interaction, particles, dt);
      if (motion.is_in_place()) {
        for_each_chunk(particles.size(),
                       [&](Chunk chunk) { move_all_of(motion, chunk.first, chunk.last); });
      }
    } else {
      clear(particles);
      interaction.accelerate(particles, search, dt);
      const Motion<P> motion(particles);
      for_each_chunk(particles.size(),
                     [&](Chunk chunk) { move_all_of(motion, chunk.first, chunk.last); });
    }
    particles.arrive();
    all_finite_ = std::all_of(sound_.begin(), sound_.end(), [](char sound) { return sound; });
  }

  // Moves particles [first, last). By value: copies that no store can change.
  template <class Move, class M>
  [[gnu::flatten, gnu::noinline]] static bool all_sound_after(const Move move, const M motion,
                                                              Index first, Index last) {
    int broken = 0;  // an int, of which g++ 12 makes lanes
    SILT_EACH_LANE_ALONE
    for (Index i = first; i < last; ++i) {
      move(motion, i);
      broken |= !motion.is_sound(i);
    }
    return broken == 0;
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // what contacts remember must not grow by a step that is not made
    search.update(particles);
    advance(particles, search, trial, dt,
            [=, damping = damping_](const Motion<P>& motion, Index i) {
              motion.step_back(i, damping, dt);
            });
  }

  D damping_{};
  bool started_ = false;
  bool all_finite_ = false;
  double last_time_step_ = 0;
  std::vector<char> sound_;  // by chunk
};

}  // namespace silt
