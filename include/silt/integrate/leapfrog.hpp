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
#include <array>
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
/// time 0 have not slipped or rolled yet: their springs, apart from k_n δ, are unwound, and
/// deflected by v^{½} Δt in the second step.
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
    set_last_time_step(interaction, started_ ? last_time_step_ : 0);
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
    set_last_time_step(interaction, last_time_step_);
    advance(particles, search, interaction, last_time_step_, Update<P>(kick_to_mean));
  }

  /// Writes or reads the state of the integrator for a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive("started", started_);
    archive("last_time_step", last_time_step_);
  }

  /// Upper bound of the gain of kinetic energy in the last step, see FinishedStep in
  /// core/watch.hpp.
  double max_energy_gain() const noexcept { return max_energy_gain_; }

  // See AdvancesField in core/concepts.hpp.
  template <class F>
  static constexpr bool advances = one_of<F, position_t, velocity_t, spin_t, angle_t>;

 private:
  // What a step did to a range of particles, see Motion::Outcome.
  template <class P>
  struct Outcome {
    bool is_valid = true;
    typename P::Real squared_displacement = 0;  // maximum [m²]
    typename Motion<P>::Energies energies{};
  };

  // Calls update(motion, particle) for a range. Its type does not depend on that of `update`, so
  // that the loop over the forces, which takes long to compile, is compiled only once.
  template <class P>
  class Update {
   public:
    /// The function must outlive this object.
    template <class Function>
    explicit Update(const Function& update) : update_(&update), run_(run<Function>) {}

    Outcome<P> operator()(const Motion<P>& motion, Index first, Index last) const {
      return run_(update_, motion, first, last);
    }

   private:
    // Copies, so that the compiler knows that no store changes them.
    template <class Function>
    [[gnu::flatten, gnu::noinline]] static Outcome<P> run(const void* from, const Motion<P>& of,
                                                          Index first, Index last) {
      const Function update = *static_cast<const Function*>(from);
      const Motion<P> motion = of;
      typename Motion<P>::Outcome outcome;
      const auto update_from = [&](Index i) {
        auto particle = motion.load(i, last);
        motion.begin(outcome, particle);
        update(motion, particle);
        motion.end(outcome, particle);
        motion.store(i, last, particle);
      };
      if constexpr (Motion<P>::is_in_rows) {
        for (Index i = first; i < last; i += Motion<P>::at_once) update_from(i);
      } else {
        SILT_INDEPENDENT_ITERATIONS
        for (Index i = first; i < last; ++i) update_from(i);
      }
      return {outcome.is_valid(motion), outcome.squared_displacement(), outcome.energies()};
    }

    const void* update_;
    Outcome<P> (*run_)(const void*, const Motion<P>&, Index, Index);
  };

  // The outcome of all ranges, from any thread.
  template <class P>
  class Outcomes {
    using Real = typename P::Real;

   public:
    // For n particles.
    explicit Outcomes(Index n) : energies_(Motion<P>::knows_energy ? n : 0, {}) {}

    // `first` is the first particle of the range.
    void add(Index first, const Outcome<P>& outcome) {
      if constexpr (Motion<P>::knows_energy) {
        energies_[first / chunk_size].add(first % chunk_size, outcome.energies);
      }
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
    // See FinishedStep. Rounded up by more than the round-off of the sums, which depends on the
    // order of the ranges.
    double max_energy_gain() const {
      constexpr double infinity = std::numeric_limits<double>::infinity();
      if constexpr (!Motion<P>::knows_energy) return infinity;
      double before = 0;
      double after = 0;
      for (const EnergiesOfChunk& each : energies_) {
        before += each.sum(&Energies::before) + each.others_before;
        after += each.sum(&Energies::after) + each.others_after;
      }
      if (after == 0) return 0;
      const double gain = 1.1 * after / before;
      return is_finite(gain) ? gain : infinity;
    }

   private:
    using Energies = typename Motion<P>::Energies;
    // Most ranges begin at a multiple of range_size. No two have the same first particle, so that
    // such a range has a place of its own, and its thread need not wait for others.
    struct EnergiesOfChunk {
      // `first` is the first particle of the range, within the chunk.
      void add(Index first, const Energies& energies) {
        if (first % range_size == 0) {
          of_ranges[first / range_size] = energies;
          return;
        }
        const auto add_to = [](double& sum, double part) {
          std::atomic_ref<double>(sum).fetch_add(part, std::memory_order_relaxed);
        };
        add_to(others_before, Motion<P>::sum_of(energies.before));
        add_to(others_after, Motion<P>::sum_of(energies.after));
      }
      template <class Member>
      double sum(Member energy) const {
        auto all = of_ranges[0].*energy;
        for (Index k = 1; k < of_ranges.size(); ++k) all += of_ranges[k].*energy;
        return Motion<P>::sum_of(all);
      }

      std::array<Energies, chunk_size / range_size> of_ranges{};
      double others_before = 0;
      double others_after = 0;
    };
    PerChunk<EnergiesOfChunk> energies_;
    std::atomic<bool> is_valid_ = true;
    std::atomic<Real> farthest_ = 0;
  };

  // Evaluates the forces and then updates every particle, range by range if the interaction allows.
  // Returns whether all results are valid.
  template <class P, class S, class I>
  bool advance(P& particles, S& search, I& interaction, double dt, const Update<P>& update) {
    if (needs_search(interaction, particles)) search.update(particles);
    const Motion<P> motion(particles);
    Outcomes<P> outcomes(particles.size());
    const auto clear_forces = [&](Index first, Index last) { clear(particles, first, last); };
    const auto move = [&](Index first, Index last) {
      outcomes.add(first, update(motion, first, last));
    };
    accelerate_in_pass(interaction, particles, search, dt, Pass{clear_forces, move});
    particles.finish_advance(outcomes.max_displacement());
    max_energy_gain_ = outcomes.max_energy_gain();
    return outcomes.is_valid();
  }

  // v^0 → v^{−½}, so that v^0 is the mean of its two half steps.
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
  double max_energy_gain_ = std::numeric_limits<double>::infinity();
};

}  // namespace silt
