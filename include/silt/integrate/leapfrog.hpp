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

namespace detail {

// The fields of particles as lanes; `Missing` for those that they do not have.
template <class P>
struct MotionFields {
  struct Missing {};
  template <class Before, class After>
  struct BeforeAndAfter {
    Before before;
    After after;
  };
  template <class Advance>
  static auto of(const Advance& field) {
    return BeforeAndAfter{lanes_of(field.before), lanes_of(field.after)};
  }
  template <class F>
  static auto change(P& particles) {
    if constexpr (HasFields<P, F>) {
      return of(particles.advance(F{}));
    } else {
      return Missing{};
    }
  }
  template <class F>
  static auto constant(const P& particles) {
    if constexpr (HasFields<P, F>) {
      return lanes_of(particles[F{}]);
    } else {
      return Missing{};
    }
  }
  template <class F>
  using Change = decltype(change<F>(std::declval<P&>()));
  template <class F>
  using Constant = decltype(constant<F>(std::declval<P&>()));
};

}  // namespace detail

/// Updates the motion of single particles, from the fields before a step to those after it. It uses
/// the type Lane, so that compilers vectorise loops over its functions; see core/lane.hpp.
template <class P>
class Motion {
  using Real = typename P::Real;
  using Scalar = Lane<Real>;
  using Vec = silt::Vec<P::dimension, Scalar>;
  using AngularVec = silt::AngularVec<P::dimension, Scalar>;

 public:
  explicit Motion(P& particles)
      : x_(Fields::of(particles.advance(position))),
        v_(Fields::of(particles.advance(velocity))),
        f_(lanes_of(std::as_const(particles)[force])),
        m_(lanes_of(std::as_const(particles)[mass])),
        particles_(&particles) {
    if constexpr (rotates) {
      w_ = Fields::of(particles.advance(spin));
      t_ = lanes_of(std::as_const(particles)[torque]);
      inertias_ = lanes_of(std::as_const(particles)[inertia]);
    }
    if constexpr (has_angle) angle_ = Fields::of(particles.advance(angle));
  }

  /// Whether the fields are overwritten, that is, before and after are the same memory.
  bool is_in_place() const { return &x_.before[0] == &x_.after[0]; }

  /// Copies what the functions below do not write; called before them.
  void copy_constants(Index first, Index last) const { particles_->copy_rows(first, last); }

  /// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33).
  template <class D>
  void kick(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return damping.kicked(v, a, Scalar(dt));
    });
  }

  /// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28); positions are unchanged.
  template <class D>
  void kick_to_mean(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      return (damping.kicked(v, a, Scalar(dt)) + v) / Scalar(2);
    });
    copy_positions(i);
  }

  /// v^N → v^{N−½}; positions are unchanged.
  template <class D>
  void step_back(Index i, const D& damping, double dt) const {
    set_velocities(i, [&]<class Value>(const Value& v, const Value& a) -> Value {
      if constexpr (requires { damping.half_step_before(v, a, Scalar(dt)); }) {
        return damping.half_step_before(v, a, Scalar(dt));
      } else {
        return v - a * Scalar(dt / 2);
      }
    });
    copy_positions(i);
  }

  /// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
  void drift(Index i, double dt) const {
    x_.after[i] = x_.before[i] + v_.after[i] * Scalar(dt);
    if constexpr (has_angle) angle_.after[i] = angle_.before[i] + w_.after[i] * Scalar(dt);
  }

  /// False if a field of particle i is not finite; may also be false if values are extremely large.
  bool is_result_finite(Index i) const {
    Real sum = x_.after[i].sum() + v_.after[i].sum();
    if constexpr (rotates) sum += sum_of(w_.after[i]);
    if constexpr (has_angle) sum += sum_of(angle_.after[i]);
    return sum - sum == 0;  // unlike is_finite(), vectorised
  }

 private:
  static constexpr bool rotates = HasFields<P, spin_t, torque_t, inertia_t>;
  static constexpr bool has_angle = rotates && HasFields<P, angle_t>;

  // set(velocity before, acceleration) returns the velocity after.
  template <class Set>
  void set_velocities(Index i, Set&& set) const {
    v_.after[i] = set(Vec(v_.before[i]), Vec(f_[i] * (1 / m_[i])));
    if constexpr (rotates) {
      w_.after[i] = set(AngularVec(w_.before[i]), AngularVec(t_[i] * (1 / inertias_[i])));
    }
  }

  void copy_positions(Index i) const {
    x_.after[i] = x_.before[i];
    if constexpr (has_angle) angle_.after[i] = angle_.before[i];
  }

  static Real sum_of(const AngularVec& angular) {
    if constexpr (P::dimension == 2) {
      return angular;
    } else {
      return angular.sum();
    }
  }

  using Fields = detail::MotionFields<P>;

  typename Fields::template Change<position_t> x_;
  typename Fields::template Change<velocity_t> v_;
  typename Fields::template Constant<force_t> f_;
  typename Fields::template Constant<mass_t> m_;
  typename Fields::template Change<spin_t> w_{};
  typename Fields::template Change<angle_t> angle_{};
  typename Fields::template Constant<torque_t> t_{};
  typename Fields::template Constant<inertia_t> inertias_{};
  P* particles_;
};

// The same for all particles, for user-defined integrators.

/// A Motion that changes the particles in place, so that its functions may be called separately.
template <class P>
Motion<P> motion_in_place(P& particles) {
  particles.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() == Role::state) particles.keep(field);
  });
  return Motion<P>(particles);
}

/// Sets the forces and torques of particles [first, last) to zero.
template <class P>
void clear(P& particles, Index first, Index last) {
  const auto set_zero = [=](auto values) {
    std::fill(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(last),
              zero_of<typename decltype(values)::value_type>());
  };
  set_zero(particles[force]);
  if constexpr (HasFields<P, torque_t>) set_zero(particles[torque]);
}

/// Sets all forces and torques to zero.
template <class P>
void clear(P& particles) {
  for_each_chunk(particles.size(), [&](Chunk c) { clear(particles, c.first, c.last); });
}

/// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33).
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

/// Advances particles under forces. The initial velocities are those at time 0; from the first step
/// on, `velocity` and `spin` hold v^{N−½}, and Simulation::snapshot() returns v^N (27), (28).
template <Damping<double> D = NoDamping>
class Leapfrog {
 public:
  Leapfrog() = default;
  /// Throws if a parameter of the damping model is out of range.
  explicit Leapfrog(D damping) : damping_(damping) {
    if constexpr (requires { damping.check(); }) damping.check();
  }

  const D& damping() const noexcept { return damping_; }

  template <class P, class S, class I>
    requires Interaction<I, P, S> && HasFields<P, velocity_t, force_t, mass_t>
  void step(P& particles, S& search, I& interaction, double dt) {
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    if (!started_) start(particles, search, interaction, dt);
    // The time between the half steps; dt if the time step is constant.
    const double between_half_steps = (last_time_step_ + dt) / 2;

    search.update(particles);
    const auto kick_and_drift = [=, damping = damping_](const Motion<P>& motion, Index i) {
      motion.kick(i, damping, between_half_steps);
      motion.drift(i, dt);
    };
    advance(particles, search, interaction, dt, UpdateRange<P>(kick_and_drift));

    last_time_step_ = dt;
  }

  /// Advances velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before
  /// the first step they are at N already, and only the forces are evaluated.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    search.update(particles);
    const auto kick_to_mean = [dt = last_time_step_, damping = damping_](const Motion<P>& motion,
                                                                         Index i) {
      motion.kick_to_mean(i, damping, dt);
    };
    advance(particles, search, interaction, last_time_step_, UpdateRange<P>(kick_to_mean));
  }

  /// Writes or reads the state of the integrator for a checkpoint, see core/transfer.hpp.
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
  // Calls update(motion, i) for a range of particles. Its type does not depend on the type of
  // `update`, so that the force loop, which takes long to compile, is compiled only once.
  template <class P>
  class UpdateRange {
   public:
    /// The update must outlive this object.
    template <class Update>
    explicit UpdateRange(const Update& update) : update_(&update), run_(run<Update>) {}
    /// Updates particles [first, last); returns false if a result is not finite.
    bool operator()(const Motion<P>& motion, Index first, Index last) const {
      return run_(update_, motion, first, last);
    }

   private:
    // Copies, so that the compiler knows that no store changes them.
    template <class Update>
    [[gnu::flatten, gnu::noinline]] static bool run(const void* from, const Motion<P>& of,
                                                    Index first, Index last) {
      const Update update = *static_cast<const Update*>(from);
      const Motion<P> motion = of;
      motion.copy_constants(first, last);
      int broken = 0;  // an int, because g++ 12 does not vectorise with a bool
      SILT_INDEPENDENT_ITERATIONS
      for (Index i = first; i < last; ++i) {
        update(motion, i);
        broken |= !motion.is_result_finite(i);
      }
      return broken == 0;
    }

    const void* update_;
    bool (*run_)(const void*, const Motion<P>&, Index, Index);
  };

  // Evaluates the forces and then updates every particle; chunk by chunk if the interaction allows.
  template <class P, class S, class I>
  void advance(P& particles, S& search, I& interaction, double dt, const UpdateRange<P>& update) {
    finite_.assign(chunk_count(particles.size()), true);
    const auto update_range = [&](const Motion<P>& motion, Index first, Index last) {
      finite_[first / chunk_size] &= update(motion, first, last);
    };
    if constexpr (AddsForces<I, P>) {
      prepare(interaction, particles, search, dt);
      const Motion<P> motion(particles);
      for_each_chunk_with_forces(interaction, particles, [&](Chunk chunk) {
        constexpr Index block = 64;  // stays in cache between the two loops
        for (Index first = chunk.first; first < chunk.last; first += block) {
          const Index last = std::min(first + block, chunk.last);
          clear(particles, first, last);
          for (Index i = first; i < last; ++i) std::as_const(interaction).add_forces(particles, i);
          if (!motion.is_in_place()) update_range(motion, first, last);
        }
      });
      conclude(interaction, particles, dt);
      if (motion.is_in_place()) {
        for_each_chunk(particles.size(),
                       [&](Chunk chunk) { update_range(motion, chunk.first, chunk.last); });
      }
    } else {
      clear(particles);
      interaction.accelerate(particles, search, dt);
      const Motion<P> motion(particles);
      for_each_chunk(particles.size(),
                     [&](Chunk chunk) { update_range(motion, chunk.first, chunk.last); });
    }
    particles.finish_advance();
    all_finite_ = std::all_of(finite_.begin(), finite_.end(), [](char finite) { return finite; });
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
  template <class P, class S, class I>
  void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // a copy: the contact histories must not advance
    search.update(particles);
    const auto step_back = [=, damping = damping_](const Motion<P>& motion, Index i) {
      motion.step_back(i, damping, dt);
    };
    advance(particles, search, trial, dt, UpdateRange<P>(step_back));
  }

  D damping_{};
  bool started_ = false;
  bool all_finite_ = false;
  double last_time_step_ = 0;
  std::vector<char> finite_;  // by chunk
};

}  // namespace silt
