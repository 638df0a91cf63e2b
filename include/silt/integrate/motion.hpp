// SPDX-License-Identifier: MIT
// The equations of motion of the leapfrog for single particles, [SahChoi2004] (15)–(33).
#pragma once

#include <silt/core/four.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace silt {

/// The motion of single particles, from the fields before a step to those after it. It works on
/// components, so that compilers vectorise loops over particles stored in columns, and no value is
/// read again after it was stored.
template <class P>
class MotionInColumns {
  using Real = typename P::Real;
  static constexpr int Dim = P::dimension;
  static constexpr int angular = angular_size<Dim>;

 public:
  static constexpr bool rotates = HasFields<P, spin_t, torque_t, inertia_t>;
  static constexpr bool has_angle = rotates && HasFields<P, angle_t>;
  static constexpr bool is_in_rows = false;

  /// One particle. The members of particles that do not rotate are not used.
  struct Single {
    Real x[Dim];          ///< [m]
    Real v[Dim];          ///< [m/s]
    Real a[Dim];          ///< F/m [m/s²]
    Real angle[angular];  ///< [rad]
    Real w[angular];      ///< [1/s]
    Real w_dot[angular];  ///< M/I [1/s²]
  };

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

  [[gnu::always_inline]] Single load(Index i) const {
    Single p;
    const Real per_mass = 1 / m_[i];
    for (int k = 0; k < Dim; ++k) {
      p.x[k] = x_.before[i][k];
      p.v[k] = v_.before[i][k];
      p.a[k] = f_[i][k] * per_mass;
    }
    if constexpr (rotates) {
      const Real per_inertia = 1 / inertias_[i];
      for (int k = 0; k < angular; ++k) {
        p.w[k] = component(w_.before[i], k);
        p.w_dot[k] = component(t_[i], k) * per_inertia;
        if constexpr (has_angle) p.angle[k] = component(angle_.before[i], k);
      }
    }
    return p;
  }

  [[gnu::always_inline]] void store(Index i, const Single& p) const {
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

  /// v^{N−½} → v^{N+½} (32) and, if the particles rotate, θ'^{N−½} → θ'^{N+½} (33).
  template <class D>
  [[gnu::always_inline]] void kick(Single& p, const D& damping, double dt) const {
    change_velocities(p, [&](Real v, Real a) { return damping.kicked(v, a, Real(dt)); });
  }

  /// v^N = ½ (v^{N−½} + v^{N+½}) (27), (28).
  template <class D>
  [[gnu::always_inline]] void kick_to_mean(Single& p, const D& damping, double dt) const {
    change_velocities(p, [&](Real v, Real a) { return (damping.kicked(v, a, Real(dt)) + v) / 2; });
  }

  /// v^N → v^{N−½}.
  template <class D>
  [[gnu::always_inline]] void step_back(Single& p, const D& damping, double dt) const {
    change_velocities(p, [&](Real v, Real a) {
      if constexpr (requires { damping.half_step_before(v, a, Real(dt)); }) {
        return damping.half_step_before(v, a, Real(dt));
      } else {
        return v - a * Real(dt / 2);
      }
    });
  }

  /// x^{N+1} = x^N + v^{N+½} Δt,  θ^{N+1} = θ^N + θ'^{N+½} Δt        (19)
  /// Moves a position that crosses a periodic side to the opposite one. Returns |v^{N+½} Δt|² [m²].
  [[gnu::always_inline]] Real drift(Single& p, double dt) const {
    Real squared_displacement = 0;
    for (int k = 0; k < Dim; ++k) {
      const Real x = p.x[k] + p.v[k] * Real(dt);
      const Real moved = x - p.x[k];  // with the rounding of x
      squared_displacement += moved * moved;
      const Real above = x + (x < lower_[k] ? period_[k] : Real(0));
      p.x[k] = above - (above < upper_[k] ? Real(0) : period_[k]);
    }
    if constexpr (has_angle) {
      for (int k = 0; k < angular; ++k) p.angle[k] += p.w[k] * Real(dt);
    }
    return squared_displacement;
  }

  /// Whether all particles added have finite fields and a position within the box; may also be
  /// false if values are extremely large.
  class Check {
   public:
    bool is_valid() const { return broken_ == 0; }

   private:
    friend MotionInColumns;
    int broken_ = 0;  // an int, because g++ 12 does not vectorise with a bool
  };
  [[gnu::always_inline]] void add_to(Check& check, const Single& p) const {
    int inside = 1;
    Real sum = 0;
    for (int k = 0; k < Dim; ++k) {
      inside &= int(lower_[k] <= p.x[k]) & int(p.x[k] <= upper_[k]);
      sum += p.x[k] + p.v[k];
    }
    if constexpr (rotates) {
      for (int k = 0; k < angular; ++k) {
        sum += p.w[k];
        if constexpr (has_angle) sum += p.angle[k];
      }
    }
    check.broken_ |= int(!(sum - sum == 0)) | !inside;  // unlike is_finite(), vectorised
  }

 private:
  // change(velocity before, acceleration) returns the velocity after.
  template <class Change>
  [[gnu::always_inline]] static void change_velocities(Single& p, Change&& change) {
    for (int k = 0; k < Dim; ++k) p.v[k] = static_cast<Real>(change(p.v[k], p.a[k]));
    if constexpr (rotates) {
      for (int k = 0; k < angular; ++k) p.w[k] = static_cast<Real>(change(p.w[k], p.w_dot[k]));
    }
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

/// The same for particles in rows of four numbers, which are processed together: {x y z R},
/// {vx vy vz m} and {wx wy wz I}; in 2D {x y R m} and {vx vy w I}. For processors whose registers
/// hold four numbers.
template <class P>
class MotionInRows {
  using Real = typename P::Real;
  using Four = silt::Four<Real>;
  using Bits = simd::Pack<std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>, 4>;
  static constexpr int Dim = P::dimension;
  static constexpr bool has_angle = HasFields<P, angle_t>;

 public:
  static constexpr bool is_in_rows = true;

  struct Single {
    Four x;
    Four v;      ///< in 2D with the spin
    Four a;      ///< F/m [m/s²]; in 2D with M/I
    Four w;      ///< 3D only
    Four w_dot;  ///< M/I [1/s²]; 3D only
    Real angle[angular_size<Dim>];
  };

  explicit MotionInRows(P& particles)
      : f_(std::as_const(particles)[force]), t_(std::as_const(particles)[torque]) {
    linear_ = particles.advance_rows(position);
    angular_ = particles.advance_rows(spin);
    if constexpr (has_angle) angle_ = particles.advance(angle);
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const auto& box = particles.box();
    Real lower[4], upper[4], period[4];
    for (int k = 0; k < 4; ++k) {
      lower[k] = k < Dim ? box.lower[k] : -infinity;
      upper[k] = k < Dim ? box.upper[k] : infinity;
      const bool is_periodic = k < Dim && box.periodic[static_cast<std::size_t>(k)];
      period[k] = is_periodic ? upper[k] - lower[k] : 0;
    }
    load_four(lower, lower_);
    load_four(upper, upper_);
    load_four(period, period_);
  }

  [[gnu::always_inline]] Single load(Index i) const {
    Single p;
    load_four(linear_.before + 8 * i, p.x);
    load_four(linear_.before + 8 * i + 4, p.v);
    const auto& f = f_[i];
    const auto& t = t_[i];
    if constexpr (Dim == 2) {
      const Real per_mass = 1 / p.x[3];
      p.a = Four{f[0] * per_mass, f[1] * per_mass, t * (1 / p.v[3]), 0};
    } else {
      load_four(angular_.before + 4 * i, p.w);
      p.a = Four{f[0], f[1], f[2], 0} * (1 / p.v[3]);
      p.w_dot = Four{t[0], t[1], t[2], 0} * (1 / p.w[3]);
    }
    if constexpr (has_angle) {
      for (int k = 0; k < angular_size<Dim>; ++k) p.angle[k] = component(angle_.before[i], k);
    }
    return p;
  }

  [[gnu::always_inline]] void store(Index i, const Single& p) const {
    simd::store<Real, 4>(linear_.after + 8 * i, p.x);
    simd::store<Real, 4>(linear_.after + 8 * i + 4, p.v);
    if constexpr (Dim == 3) simd::store<Real, 4>(angular_.after + 4 * i, p.w);
    if constexpr (has_angle) {
      for (int k = 0; k < angular_size<Dim>; ++k) component(angle_.after[i], k) = p.angle[k];
    }
  }

  // As in MotionInColumns. Packs are passed by reference, because how they are returned depends on
  // the processor flags.

  template <class D>
  [[gnu::always_inline]] void kick(Single& p, const D& damping, double dt) const {
    change_velocities<D>(p, [&](auto& v, const auto& a) { v = damping.kicked(v, a, Real(dt)); });
  }
  template <class D>
  [[gnu::always_inline]] void kick_to_mean(Single& p, const D& damping, double dt) const {
    change_velocities<D>(
        p, [&](auto& v, const auto& a) { v = (damping.kicked(v, a, Real(dt)) + v) / 2; });
  }
  template <class D>
  [[gnu::always_inline]] void step_back(Single& p, const D& damping, double dt) const {
    change_velocities<D>(p, [&](auto& v, const auto& a) {
      if constexpr (requires { damping.half_step_before(v, a, Real(dt)); }) {
        v = damping.half_step_before(v, a, Real(dt));
      } else {
        v = v - a * Real(dt / 2);
      }
    });
  }

  [[gnu::always_inline]] Real drift(Single& p, double dt) const {
    const Four moved = p.v * Real(dt);
    const Four none{};
    // No number but the position moves.
    Four move;
    if constexpr (Dim == 2) {
      move = __builtin_shufflevector(moved, none, 0, 1, 6, 7);
    } else {
      move = __builtin_shufflevector(moved, none, 0, 1, 2, 7);
    }
    const Four x = p.x + move;
    const Four with_rounding = x - p.x;
    const Four squares = with_rounding * with_rounding;
    const Four above = x + (Four)((Bits)(x < lower_) & (Bits)period_);
    p.x = above - (Four)(~(Bits)(above < upper_) & (Bits)period_);
    if constexpr (has_angle) {
      for (int k = 0; k < angular_size<Dim>; ++k) {
        p.angle[k] += (Dim == 2 ? p.v[2] : p.w[k]) * Real(dt);
      }
    }
    return squares[0] + squares[1] + squares[2];
  }

  class Check {
   public:
    bool is_valid() const { return ((valid_[0] & valid_[1]) & (valid_[2] & valid_[3])) != 0; }

   private:
    friend MotionInRows;
    Bits valid_ = ~Bits{};
  };
  [[gnu::always_inline]] void add_to(Check& check, const Single& p) const {
    Four sum = p.x + p.v;
    if constexpr (Dim == 3) sum += p.w;
    if constexpr (has_angle) {
      for (const Real turned : p.angle) sum += turned;
    }
    check.valid_ &= (Bits)(lower_ <= p.x) & (Bits)(p.x <= upper_) & (Bits)(sum - sum == Four{});
  }

 private:
  // change(velocity, acceleration) for numbers, or for four at once if the damping model D is for
  // them, too, and they fit into a register: otherwise g++ warns of functions that return them. The
  // fourth is not a velocity.
  template <class D, class Change>
  [[gnu::always_inline]] static void change_velocities(Single& p, Change&& change) {
    const auto change_three = [&](Four& v, const Four& a) {
      Four changed = v;
      if constexpr (requires { requires D::accepts_packs && sizeof(Four) <= simd::width; }) {
        change(changed, a);
      } else {
        Real numbers[4];
        simd::store<Real, 4>(numbers, v);
        for (int k = 0; k < 3; ++k) change(numbers[k], Real(a[k]));
        load_four(numbers, changed);
      }
      v = __builtin_shufflevector(changed, v, 0, 1, 2, 7);
    };
    change_three(p.v, p.a);
    if constexpr (Dim == 3) change_three(p.w, p.w_dot);
  }

  using Rows = decltype(std::declval<P&>().advance_rows(position));
  struct Missing {};
  static auto angles(P& particles) {
    if constexpr (has_angle) {
      return particles.advance(angle);
    } else {
      return Missing{};
    }
  }

  Rows linear_;
  Rows angular_;
  decltype(std::declval<const P&>()[force]) f_;
  decltype(std::declval<const P&>()[torque]) t_;
  decltype(angles(std::declval<P&>())) angle_{};
  Four lower_;
  Four upper_;
  Four period_;
};

template <class P>
using Motion =
    std::conditional_t<in_rows_of_four<P>() && 4 * sizeof(typename P::Real) <= simd::width,
                       MotionInRows<P>, MotionInColumns<P>>;

}  // namespace silt
