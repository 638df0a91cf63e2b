// SPDX-License-Identifier: MIT
// Leapfrog, [SahChoi2004] (15)–(33): positions at whole steps, velocities and spins at half steps.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/lane.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/particles.hpp>
#include <silt/integrate/damping.hpp>
#include <silt/integrate/motion.hpp>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace silt {

template <class F, class... Fs>
inline constexpr bool one_of = (std::same_as<F, Fs> || ...);

// The same for all particles, for user-defined integrators.

namespace detail {
// Calls change(motion, state) for every particle, in place.
template <class P, class Change>
void change_motion(P& particles, Change&& change) {
  particles.for_each_field([&]<class F>(auto, F field) {
    if constexpr (role_of<F>() == Role::state) particles.keep(field);
  });
  const Motion<P> motion(particles);
  for_each(particles.size(), [&](Index i) {
    auto state = motion.load(i, i + 1);
    change(motion, state);
    motion.store(i, i + 1, state);
  });
}
}  // namespace detail

/// Sets the forces and torques of particles [first, last) to zero.
template <class P>
void clear(P& particles, Index first, Index last) {
  const auto set_zero = [=](auto values) {
    using Value = typename decltype(values)::value_type;
    if constexpr (requires { values.data(); }) {
      // By number: g++ does not merge the stores of vectors.
      auto* const numbers = reinterpret_cast<typename P::Real*>(values.data() + first);
      std::fill_n(numbers, (last - first) * (sizeof(Value) / sizeof(*numbers)),
                  typename P::Real(0));
    } else {
      std::fill(values.begin() + std::ptrdiff_t(first), values.begin() + std::ptrdiff_t(last),
                zero_of<Value>());
    }
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
  detail::change_motion(particles, [&](const auto& motion, auto& particle) {
    motion.kick(particle, damping, time_step);
  });
}

/// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
template <class P>
void drift(P& particles, double time_step) {
  detail::change_motion(
      particles, [&](const auto& motion, auto& particle) { motion.drift(particle, time_step); });
}

/// Advances particles under forces. The initial velocities are those at time 0; from the first step
/// on, `velocity` and `spin` hold v^{N−½}, and Simulation::snapshot() returns v^N (27), (28).
///
/// The first step evaluates the forces at time 0 twice, for v^{−½} and v^{½}. Pairs that overlap at
/// time 0 have not slipped or rolled yet: their springs, apart from k_n δ, are unwound, and deflected
/// by v^{½} Δt in the second step.
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

    const auto kick_and_drift = [=, damping = damping_](const Motion<P>& motion, auto& particle) {
      motion.kick(particle, damping, between_half_steps);
      motion.drift(particle, dt);
    };
    const bool is_valid = advance(particles, search, interaction, dt, Update<P>(kick_and_drift));

    last_time_step_ = dt;
    return is_valid;
  }

  /// Advances velocities and spins from N − ½ to N: v^N = ½ (v^{N−½} + v^{N+½}) (27), (28). Before
  /// the first step they are at N already, and only the forces are evaluated.
  template <class P, class S, class I>
  void synchronise(P& particles, S& search, I& interaction) {
    const auto kick_to_mean = [dt = last_time_step_, damping = damping_](const Motion<P>& motion,
                                                                         auto& particle) {
      motion.kick_to_mean(particle, damping, dt);
    };
    advance(particles, search, interaction, last_time_step_, Update<P>(kick_to_mean));
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
  // What a step did to a range of particles.
  template <class Real>
  struct Outcome {
    bool is_valid = true;           // see Motion::Outcome
    Real squared_displacement = 0;  // maximum [m²]
  };

  // Calls update(motion, particle) for a range. Its type does not depend on that of `update`, so
  // that the loop over the forces, which takes long to compile, is compiled only once.
  template <class P>
  class Update {
    using Real = typename P::Real;

   public:
    /// The function must outlive this object.
    template <class Function>
    explicit Update(const Function& update) : update_(&update), run_(run<Function>) {}

    Outcome<Real> operator()(const Motion<P>& motion, Index first, Index last) const {
      return run_(update_, motion, first, last);
    }

   private:
    // Copies, so that the compiler knows that no store changes them.
    template <class Function>
    [[gnu::flatten, gnu::noinline]] static Outcome<Real> run(const void* from, const Motion<P>& of,
                                                             Index first, Index last) {
      const Function update = *static_cast<const Function*>(from);
      const Motion<P> motion = of;
      typename Motion<P>::Outcome outcome;
      const auto update_from = [&](Index i) {
        auto particle = motion.load(i, last);
        update(motion, particle);
        motion.add_to(outcome, particle);
        motion.store(i, last, particle);
      };
      if constexpr (Motion<P>::is_in_rows) {
        for (Index i = first; i < last; i += Motion<P>::at_once) update_from(i);
      } else {
        SILT_INDEPENDENT_ITERATIONS
        for (Index i = first; i < last; ++i) update_from(i);
      }
      return {outcome.is_valid(motion), outcome.squared_displacement()};
    }

    const void* update_;
    Outcome<Real> (*run_)(const void*, const Motion<P>&, Index, Index);
  };

  // The outcome of all ranges, from any thread.
  template <class Real>
  class Outcomes {
   public:
    void add(const Outcome<Real>& outcome) {
      if (!outcome.is_valid) is_valid_.store(false, std::memory_order_relaxed);
      Real highest = farthest_.load(std::memory_order_relaxed);
      while (outcome.squared_displacement > highest &&
             !farthest_.compare_exchange_weak(highest, outcome.squared_displacement,
                                              std::memory_order_relaxed)) {
      }
    }
    bool is_valid() const { return is_valid_.load(std::memory_order_relaxed); }
    // [m], rounded up; infinity if a result is not valid
    double max_displacement() const {
      if (!is_valid()) return std::numeric_limits<double>::infinity();
      return std::sqrt(double(farthest_.load(std::memory_order_relaxed))) *
             (1 + 4 * double(std::numeric_limits<Real>::epsilon()));
    }

   private:
    std::atomic<bool> is_valid_ = true;
    std::atomic<Real> farthest_ = 0;
  };

  // Evaluates the forces and then updates every particle, range by range if the interaction allows.
  // Returns whether all results are valid.
  template <class P, class S, class I>
  bool advance(P& particles, S& search, I& interaction, double dt, const Update<P>& update) {
    if (needs_search(interaction, particles)) search.update(particles);
    const Motion<P> motion(particles);
    Outcomes<typename P::Real> outcomes;
    const auto clear_forces = [&](Index first, Index last) { clear(particles, first, last); };
    const auto move = [&](Index first, Index last) { outcomes.add(update(motion, first, last)); };
    accelerate_in_pass(interaction, particles, search, dt, Pass{clear_forces, move});
    particles.finish_advance(outcomes.max_displacement());
    return outcomes.is_valid();
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps. Springs of contacts are unwound,
  // since Simulation tells the interaction that nothing has moved yet.
  template <class P, class S, class I>
  void start(P& particles, S& search, I& interaction, double dt) {
    last_time_step_ = dt;
    started_ = true;
    I trial = interaction;  // a copy: the contact histories must not advance
    const auto step_back = [=, damping = damping_](const Motion<P>& motion, auto& particle) {
      motion.step_back(particle, damping, dt);
    };
    advance(particles, search, trial, dt, Update<P>(step_back));
  }

  D damping_{};
  bool started_ = false;
  double last_time_step_ = 0;
};

}  // namespace silt
