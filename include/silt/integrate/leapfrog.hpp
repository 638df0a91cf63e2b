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
#include <cstddef>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

namespace silt {

template <class F, class... Fs>
inline constexpr bool one_of = (std::same_as<F, Fs> || ...);

namespace detail {

// The fields of particles; `Missing` for those that they do not have. Columns are lanes, so that
// compilers vectorise loops over the particles; see core/lane.hpp.
template <class P>
struct MotionFields {
  static constexpr bool in_rows =
      requires(const P particles) { particles.storage(position).rows(); };
  using Scalar =
      std::conditional_t<in_rows, typename P::Real, Lane<typename P::Real>>;
  struct Missing {};
  template <class Before, class After>
  struct BeforeAndAfter {
    Before before;
    After after;
  };
  template <class Values>
  static auto of(const Values& values) {
    if constexpr (in_rows) {
      return values;
    } else {
      return lanes_of(values);
    }
  }
  template <class Advance>
  static auto change(const Advance& field) {
    return BeforeAndAfter{of(field.before), of(field.after)};
  }
  template <class F>
  static auto change_of(P& particles) {
    if constexpr (HasFields<P, F>) {
      return change(particles.advance(F{}));
    } else {
      return Missing{};
    }
  }
  template <class F>
  static auto constant_of(const P& particles) {
    if constexpr (HasFields<P, F>) {
      return of(particles[F{}]);
    } else {
      return Missing{};
    }
  }
  template <class F>
  using Change = decltype(change_of<F>(std::declval<P&>()));
  template <class F>
  using Constant = decltype(constant_of<F>(std::declval<P&>()));
};

}  // namespace detail

/// Updates the motion of single particles, from the fields before a step to those after it.
template <class P>
class Motion {
  using Real = typename P::Real;
  using Fields = detail::MotionFields<P>;
  using Scalar = typename Fields::Scalar;
  using Vec = silt::Vec<P::dimension, Scalar>;
  using AngularVec = silt::AngularVec<P::dimension, Scalar>;

 public:
  explicit Motion(P& particles)
      : x_(Fields::change(particles.advance(position))),
        v_(Fields::change(particles.advance(velocity))),
        f_(Fields::of(std::as_const(particles)[force])),
        m_(Fields::of(std::as_const(particles)[mass])),
        particles_(&particles) {
    if constexpr (rotates) {
      w_ = Fields::change(particles.advance(spin));
      t_ = Fields::of(std::as_const(particles)[torque]);
      inertias_ = Fields::of(std::as_const(particles)[inertia]);
    }
    if constexpr (has_angle) angle_ = Fields::change(particles.advance(angle));
    const auto& box = particles.box();
    for (int k = 0; k < P::dimension; ++k) {
      constexpr Real infinity = std::numeric_limits<Real>::infinity();
      const bool is_periodic = box.periodic[static_cast<std::size_t>(k)];
      lower_[k] = is_periodic ? -infinity : box.lower[k];
      upper_[k] = is_periodic ? infinity : box.upper[k];
    }
  }

  /// Whether the fields are overwritten, that is, before and after are the same memory.
  bool is_in_place() const { return &x_.before[0] == &x_.after[0]; }

  /// The particles are stored in rows, see Bundle in core/columns.hpp.
  static constexpr bool in_rows = Fields::in_rows;
  /// Copies the fields in the rows of particle i that the functions below do not write; called
  /// before them.
  void copy_constants(Index i) const { particles_->copy_row(i); }

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

  /// False if a field of particle i is not finite or its position is outside the box, except along
  /// periodic axes; may also be false if values are extremely large.
  bool is_result_valid(Index i) const {
    int inside = 1;
    for (int k = 0; k < P::dimension; ++k) {
      inside &= int(lower_[k] <= Real(x_.after[i][k])) & int(Real(x_.after[i][k]) <= upper_[k]);
    }
    Real sum = x_.after[i].sum() + v_.after[i].sum();
    if constexpr (rotates) sum += sum_of(w_.after[i]);
    if constexpr (has_angle) sum += sum_of(angle_.after[i]);
    return (int(sum - sum == 0) & inside) != 0;  // unlike is_finite(), vectorised
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

  typename Fields::template Change<position_t> x_;
  typename Fields::template Change<velocity_t> v_;
  typename Fields::template Constant<force_t> f_;
  typename Fields::template Constant<mass_t> m_;
  typename Fields::template Change<spin_t> w_{};
  typename Fields::template Change<angle_t> angle_{};
  typename Fields::template Constant<torque_t> t_{};
  typename Fields::template Constant<inertia_t> inertias_{};
  P* particles_;
  Real lower_[P::dimension];
  Real upper_[P::dimension];
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
  bool step(P& particles, S& search, I& interaction, double dt) {
    if constexpr (requires { damping_.check(dt); }) damping_.check(dt);
    if (!started_) start(particles, search, interaction, dt);
    // The time between the half steps; dt if the time step is constant.
    const double between_half_steps = (last_time_step_ + dt) / 2;

    search.update(particles);
    const auto kick_and_drift = [=, damping = damping_](const Motion<P>& motion, Index i) {
      motion.kick(i, damping, between_half_steps);
      motion.drift(i, dt);
    };
    const bool is_valid =
        advance(particles, search, interaction, dt, UpdateRange<P>(kick_and_drift));

    last_time_step_ = dt;
    return is_valid;
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

 private:
  // Calls update(motion, i) for a range of particles. Its type does not depend on the type of
  // `update`, so that the force loop, which takes long to compile, is compiled only once.
  template <class P>
  class UpdateRange {
   public:
    /// The update must outlive this object.
    template <class Update>
    explicit UpdateRange(const Update& update) : update_(&update), run_(run<Update>) {}
    /// Updates particles [first, last); returns false if a result is not valid.
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
      int broken = 0;  // an int, because g++ 12 does not vectorise with a bool
      if constexpr (Motion<P>::in_rows) {
        for (Index i = first; i < last; ++i) {
          motion.copy_constants(i);
          update(motion, i);
          broken |= !motion.is_result_valid(i);
        }
      } else {
        SILT_INDEPENDENT_ITERATIONS
        for (Index i = first; i < last; ++i) {
          update(motion, i);
          broken |= !motion.is_result_valid(i);
        }
      }
      return broken == 0;
    }

    const void* update_;
    bool (*run_)(const void*, const Motion<P>&, Index, Index);
  };

  // Evaluates the forces and then updates every particle; chunk by chunk if the interaction allows.
  // Returns whether all results are valid.
  template <class P, class S, class I>
  bool advance(P& particles, S& search, I& interaction, double dt, const UpdateRange<P>& update) {
    valid_.assign(chunk_count(particles.size()), true);
    const auto update_range = [&](const Motion<P>& motion, Index first, Index last) {
      valid_[first / chunk_size] &= update(motion, first, last);
    };
    if constexpr (AddsForces<I, P>) {
      prepare(interaction, particles, search, dt);
      const Motion<P> motion(particles);
      for_each_chunk_with_forces(interaction, particles, [&](Chunk chunk) {
        constexpr Index block = 64;  // stays in cache between the two loops
        for (Index first = chunk.first; first < chunk.last; first += block) {
          const Index last = std::min(first + block, chunk.last);
          clear(particles, first, last);
          add_forces_of(std::as_const(interaction), particles, first, last);
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
    return std::all_of(valid_.begin(), valid_.end(), [](char valid) { return valid; });
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
  double last_time_step_ = 0;
  std::vector<char> valid_;  // by chunk
};

}  // namespace silt
