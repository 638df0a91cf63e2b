// SPDX-License-Identifier: MIT
// The motion of particles stored in any way.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace silt {

/// The motion of particles one by one, from the fields before a step to those after it. It works on
/// components, so that compilers vectorise loops over particles stored in columns, and no value is
/// read again after it was stored. MotionInRows has the same functions.
template <class P>
class MotionInColumns {
  using Real = typename P::Real;
  static constexpr int Dim = P::dimension;
  static constexpr int angular = angular_size<Dim>;

 public:
  /// Whether the particles have a spin.
  static constexpr bool rotates = HasFields<P, spin_t, torque_t, inertia_t>;
  /// Whether they also have an angle.
  static constexpr bool has_angle = rotates && HasFields<P, angle_t>;
  static constexpr bool is_in_rows = false;  ///< see MotionInRows
  /// Number of particles that are processed together.
  static constexpr Index at_once = 1;

  /// One particle. The members of particles that do not rotate are not used.
  struct State {
    Real x[Dim];                    ///< [m]
    Real v[Dim];                    ///< [m/s]
    Real a[Dim];                    ///< F/m [m/s²]
    Real angle[angular];            ///< [rad]
    Real w[angular];                ///< [1/s]
    Real w_dot[angular];            ///< M/I [1/s²]
    Real m;                         ///< [kg]
    Real inertia;                   ///< [kg m²]
    Real squared_displacement = 0;  ///< by drift() [m²]
  };

  /// Begins a step: Particles::advance() of the fields that move.
  explicit MotionInColumns(P& particles)
      : x_(particles.advance(position)),
        v_(particles.advance(velocity)),
        f_(std::as_const(particles)[force]),
        m_(std::as_const(particles)[mass]) {
    if constexpr (rotates) {
      w_ = particles.advance(spin);
      t_ = std::as_const(particles)[torque];
      inertias_ = std::as_const(particles)[inertia];
    }
    if constexpr (has_angle) angle_ = particles.advance(angle);
    const auto& box = particles.box();
    for (int k = 0; k < Dim; ++k) {
      lower_[k] = box.lower[k];
      upper_[k] = box.upper[k];
      const bool is_periodic = box.periodic[static_cast<std::size_t>(k)];
      period_[k] = is_periodic ? box.upper[k] - box.lower[k] : 0;
    }
  }

  /// Particle i before the step. The second argument is used by MotionInRows only.
  [[gnu::always_inline]] State load(Index i, Index) const {
    State p;
    p.m = m_[i];
    const Real per_mass = 1 / p.m;
    for (int k = 0; k < Dim; ++k) {
      p.x[k] = x_.before[i][k];
      p.v[k] = v_.before[i][k];
      p.a[k] = f_[i][k] * per_mass;
    }
    if constexpr (rotates) {
      p.inertia = inertias_[i];
      const Real per_inertia = 1 / p.inertia;
      for (int k = 0; k < angular; ++k) {
        p.w[k] = component(w_.before[i], k);
        p.w_dot[k] = component(t_[i], k) * per_inertia;
        if constexpr (has_angle) p.angle[k] = component(angle_.before[i], k);
      }
    }
    return p;
  }

  /// Writes particle i after the step.
  [[gnu::always_inline]] void store(Index i, Index, const State& p) const {
    for (int k = 0; k < Dim; ++k) {
      x_.after[i][k] = p.x[k];
      v_.after[i][k] = p.v[k];
    }
    if constexpr (rotates) {
      for (int k = 0; k < angular; ++k) {
        component(w_.after[i], k) = p.w[k];
        if constexpr (has_angle) component(angle_.after[i], k) = p.angle[k];
      }
    }
  }

  /// change(velocity, acceleration) for each component of the velocity and spin.
  template <class Change>
  [[gnu::always_inline]] static void change_velocities(State& p, Change&& change) {
    for (int k = 0; k < Dim; ++k) change(p.v[k], p.a[k]);
    if constexpr (rotates) {
      for (int k = 0; k < angular; ++k) change(p.w[k], p.w_dot[k]);
    }
  }

  /// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
  /// Moves a position that crosses a periodic side to the opposite one.
  [[gnu::always_inline]] void drift(State& p, double dt) const {
    for (int k = 0; k < Dim; ++k) {
      const Real x = p.x[k] + p.v[k] * Real(dt);
      const Real moved = x - p.x[k];  // with the rounding of x
      p.squared_displacement += moved * moved;
      // Not x < lower ? x + period : x, which g++ does not vectorise; x + (−0) = x, even for −0.
      const Real above = x + (x < lower_[k] ? period_[k] : Real(-0.0));
      p.x[k] = above - (above < upper_[k] ? Real(0) : period_[k]);
    }
    if constexpr (has_angle) {
      for (int k = 0; k < angular; ++k) p.angle[k] += p.w[k] * Real(dt);
    }
  }

  /// What a step did to particles.
  class Outcome {
   public:
    /// Whether all of them have finite fields and a position within the box; may also be false if
    /// values are extremely large.
    bool is_valid(const MotionInColumns&) const {
      return broken_ == 0 && is_finite(after_) && is_finite(displacements_);
    }
    /// The maximum [m²].
    Real squared_displacement() const { return std::bit_cast<Real>(farthest_); }
    /// Sums of twice the kinetic energy [J], if it is known: before the step, in 3D without
    /// rotation, and after it.
    /// The round-off depends on the order of the particles and on the instruction set.
    double energy_before() const { return double(before_); }
    /// See energy_before().
    double energy_after() const { return double(after_); }

   private:
    friend MotionInColumns;
    Real before_ = 0;
    Real after_ = 0;
    Real displacements_ = 0;  // sum of their squares [m²]
    int broken_ = 0;          // an int, because g++ 12 does not vectorise with a bool
    // Bits of non-negative numbers compare as the numbers do; unlike the maximum of Reals, the
    // maximum of bits is vectorised.
    std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t> farthest_ = 0;
  };
  /// A particle before the step.
  [[gnu::always_inline]] void begin([[maybe_unused]] Outcome& outcome,
                                    [[maybe_unused]] const State& p) const {
    if constexpr (knows_energy) {
      outcome.before_ += p.m * squared(p.v);
      if constexpr (Dim == 2) outcome.before_ += p.inertia * squared(p.w);
    }
  }
  /// The same particle after it.
  [[gnu::always_inline]] void end(Outcome& outcome, const State& p) const {
    int inside = 1;
    for (int k = 0; k < Dim; ++k) {
      inside &= int(lower_[k] <= p.x[k]) & int(p.x[k] <= upper_[k]);
    }
    outcome.broken_ |= !inside;
    if constexpr (knows_energy) {
      outcome.after_ += p.m * squared(p.v) + p.inertia * squared(p.w);
      outcome.displacements_ += p.squared_displacement;
      if constexpr (has_angle) {
        for (int k = 0; k < angular; ++k) outcome.displacements_ += p.angle[k] - p.angle[k];
      }
    } else {
      Real sum = 0;
      for (int k = 0; k < Dim; ++k) sum += p.x[k] + p.v[k];
      if constexpr (rotates) {
        for (int k = 0; k < angular; ++k) {
          sum += p.w[k];
          if constexpr (has_angle) sum += p.angle[k];
        }
      }
      outcome.broken_ |= int(!(sum - sum == 0));  // unlike is_finite(), vectorised
    }
    outcome.farthest_ = std::max(
        outcome.farthest_, std::bit_cast<decltype(outcome.farthest_)>(p.squared_displacement));
  }

 private:
  // Only for particles in rows of four, such as grains: compilers do not vectorise a sum.
  static constexpr bool knows_energy = in_rows_of_four<P>();

  template <int n>
  [[gnu::always_inline]] static Real squared(const Real (&v)[n]) {
    Real sum = v[0] * v[0];
    for (int k = 1; k < n; ++k) sum += v[k] * v[k];
    return sum;
  }

  // For fields that the particles do not have.
  struct Missing {};
  template <class F>
  static auto changing(P& particles) {
    if constexpr (HasFields<P, F>) {
      return particles.advance(F{});
    } else {
      return Missing{};
    }
  }
  template <class F>
  static auto constant(const P& particles) {
    if constexpr (HasFields<P, F>) {
      return particles[F{}];
    } else {
      return Missing{};
    }
  }
  template <class F>
  using Changing = decltype(changing<F>(std::declval<P&>()));
  template <class F>
  using Constant = decltype(constant<F>(std::declval<const P&>()));

  Changing<position_t> x_;
  Changing<velocity_t> v_;
  Constant<force_t> f_;
  Constant<mass_t> m_;
  Changing<spin_t> w_{};
  Changing<angle_t> angle_{};
  Constant<torque_t> t_{};
  Constant<inertia_t> inertias_{};
  // Of the box; the period is 0 along axes that are not periodic.
  Real lower_[Dim];
  Real upper_[Dim];
  Real period_[Dim];
};

}  // namespace silt
