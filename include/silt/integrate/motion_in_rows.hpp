// SPDX-License-Identifier: MIT
// The motion of particles stored in rows.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace silt {

/// The same for particles in rows of four numbers: {x y z R}, {vx vy vz m} and {wx wy wz I}; in 2D
/// {x y R m} and {vx vy w I}. For processors whose registers hold four numbers; where they hold
/// eight, two particles are processed together.
template <class P>
class MotionInRows {
  using Real = typename P::Real;
  static constexpr int N = 8 * sizeof(Real) <= simd::width ? 8 : 4;
  using Pack = simd::Pack<Real, N>;
  static constexpr int Dim = P::dimension;
  static constexpr int angular = angular_size<Dim>;
  static constexpr bool has_angle = HasFields<P, angle_t>;

 public:
  static constexpr bool is_in_rows = true;
  static constexpr Index at_once = N / 4;

  /// One or two particles, in lanes. Members as in MotionInColumns.
  struct State {
    Pack x;        ///< [m]
    Pack v;        ///< [m/s]; in 2D with the spin [1/s]
    Pack a;        ///< F/m [m/s²]; in 2D with M/I [1/s²]
    Pack w;        ///< [1/s]; 3D only
    Pack w_dot;    ///< M/I [1/s²]; 3D only
    Pack m;        ///< of the first three of v [kg]; in 2D {m, m, I}
    Pack inertia;  ///< of the first three of w [kg m²]; 3D only
    Real angle[at_once][angular];  ///< of each particle [rad]
    Pack squares{};  ///< of the displacement by drift() [m²]
  };

  /// Begins a step: Particles::advance_rows() of the rows that move.
  explicit MotionInRows(P& particles)
      : f_(std::as_const(particles)[force]), t_(std::as_const(particles)[torque]) {
    linear_ = particles.advance_rows(position);
    angular_ = particles.advance_rows(spin);
    if constexpr (has_angle) angle_ = particles.advance(angle);
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const auto& box = particles.box();
    Real lower[N], upper[N], period[N];
    for (int lane = 0; lane < N; ++lane) {
      const int k = lane % 4;
      lower[lane] = k < Dim ? box.lower[k] : -infinity;
      upper[lane] = k < Dim ? box.upper[k] : infinity;
      const bool is_periodic = k < Dim && box.periodic[static_cast<std::size_t>(k)];
      period[lane] = is_periodic ? upper[lane] - lower[lane] : 0;
    }
    lower_ = simd::load<Real, N>(lower);
    upper_ = simd::load<Real, N>(upper);
    period_ = simd::load<Real, N>(period);
  }

  /// Particle i and, if two are processed together, the next of the range that ends at `last`; at
  /// its end, the same again.
  [[gnu::always_inline]] State load(Index i, Index last) const {
    const Index j = second(i, last);
    State p;
    load_fours(linear_.before + 8 * i, linear_.before + 8 * j, p.x);
    load_fours(linear_.before + 8 * i + 4, linear_.before + 8 * j + 4, p.v);
    if constexpr (Dim == 2) {
      shuffle_fours<3, 3, 7, 7>(p.x, p.v, p.m);
      set_threes({f_[i][0], f_[i][1], t_[i]}, {f_[j][0], f_[j][1], t_[j]}, p.a);
      p.a *= 1 / p.m;
    } else {
      load_fours(angular_.before + 4 * i, angular_.before + 4 * j, p.w);
      if constexpr (at_once == 1) {
        p.m = simd::broadcast<Real, N>(linear_.before[8 * i + 7]);
        p.inertia = simd::broadcast<Real, N>(angular_.before[4 * i + 3]);
      } else {
        shuffle_fours<3, 3, 3, 3>(p.v, p.v, p.m);
        shuffle_fours<3, 3, 3, 3>(p.w, p.w, p.inertia);
      }
      Pack per_mass, per_inertia;
      inverse_of_fourths(p.v, p.w, per_mass, per_inertia);
      load_threes(f_[i].data(), f_[j].data(), p.a);
      load_threes(t_[i].data(), t_[j].data(), p.w_dot);
      p.a *= per_mass;
      p.w_dot *= per_inertia;
    }
    if constexpr (has_angle) {
      for (int k = 0; k < angular; ++k) {
        p.angle[0][k] = component(angle_.before[i], k);
        p.angle[at_once - 1][k] = component(angle_.before[j], k);
      }
    }
    if constexpr (at_once == 2) {
      if (i == j) {  // its energy counts once
        keep_first_four(p.m);
        if constexpr (Dim == 3) keep_first_four(p.inertia);
      }
    }
    return p;
  }

  [[gnu::always_inline]] void store(Index i, Index last, const State& p) const {
    const Index j = second(i, last);
    store_fours(p.x, linear_.after + 8 * i, linear_.after + 8 * j);
    store_fours(p.v, linear_.after + 8 * i + 4, linear_.after + 8 * j + 4);
    if constexpr (Dim == 3) store_fours(p.w, angular_.after + 4 * i, angular_.after + 4 * j);
    if constexpr (has_angle) {
      for (int k = 0; k < angular; ++k) {
        component(angle_.after[i], k) = p.angle[0][k];
        component(angle_.after[j], k) = p.angle[at_once - 1][k];
      }
    }
  }

  /// As in MotionInColumns; change() is called with numbers, or with whole packs if the damping model D
  /// accepts them, too. The fourth of each four is not a velocity.
  template <class D, class Change>
  [[gnu::always_inline]] static void change_velocities(State& p, Change&& change) {
    const auto change_threes = [&](Pack& v, const Pack& a) {
      Pack changed = v;
      if constexpr (requires { requires D::accepts_packs; }) {
        change(changed, a);
      } else {
        Real numbers[N];
        simd::store<Real, N>(numbers, v);
        for (int k = 0; k < N; ++k) {
          if (k % 4 < 3) change(numbers[k], Real(a[k]));
        }
        changed = simd::load<Real, N>(numbers);
      }
      shuffle_fours<0, 1, 2, 7>(changed, v, v);
    };
    change_threes(p.v, p.a);
    if constexpr (Dim == 3) change_threes(p.w, p.w_dot);
  }

  [[gnu::always_inline]] void drift(State& p, double dt) const {
    const Pack moved = p.x + p.v * Real(dt);
    // No number but the position moves.
    Pack x;
    if constexpr (Dim == 2) {
      shuffle_fours<0, 1, 6, 7>(moved, p.x, x);
    } else {
      shuffle_fours<0, 1, 2, 7>(moved, p.x, x);
    }
    const Pack with_rounding = x - p.x;
    p.squares = with_rounding * with_rounding;
    const Pack above = x < lower_ ? x + period_ : x;
    p.x = above < upper_ ? above : above - period_;
    if constexpr (has_angle) {
      for (Index one = 0; one < at_once; ++one) {
        for (int k = 0; k < angular; ++k) {
          const auto lane = static_cast<int>(4 * one) + (Dim == 2 ? 2 : k);
          p.angle[one][k] += (Dim == 2 ? p.v : p.w)[lane] * Real(dt);
        }
      }
    }
  }

  static constexpr bool knows_energy = true;
  /// Sums of twice the kinetic energy [J], `before` the step and `after` it. The fourth of each
  /// four is unspecified.
  struct Energies {
    Pack before{};  ///< in 3D without rotation
    Pack after{};
  };
  static double sum_of(const Pack& energy) {
    double sum = 0;
    for (int k = 0; k < N; ++k) {
      if (k % 4 < 3) sum += double(energy[k]);
    }
    return sum;
  }

  // Extremes and sums that become infinite or NaN take less time than comparisons for every
  // particle.
  /// What a step did to particles, as in MotionInColumns.
  class Outcome {
   public:
    /// As in MotionInColumns.
    bool is_valid(const MotionInRows& motion) const {
      // Copies, so that the members need not be in memory while particles are added.
      const Pack squares = squares_, lowest = lowest_, highest = highest_;
      Pack sums;
      shuffle_fours<0, 1, 2, 7>(squares + energies_.after, squares, sums);
      for (int k = 0; k < N; ++k) {
        if (!(is_finite(sums[k]) && motion.lower_[k] <= lowest[k] &&
              highest[k] <= motion.upper_[k])) {
          return false;
        }
      }
      return is_finite(angles_);
    }
    /// The maximum [m²].
    Real squared_displacement() const { return std::max(farthest_[0], farthest_[N - 4]); }
    /// The round-off depends on the order of the particles.
    const Energies& energies() const { return energies_; }

   private:
    friend MotionInRows;
    static constexpr Real infinity = std::numeric_limits<Real>::infinity();
    Pack squares_{};
    Energies energies_;
    Real angles_ = 0;
    Pack lowest_ = simd::broadcast<Real, N>(infinity);
    Pack highest_ = simd::broadcast<Real, N>(-infinity);
    Pack farthest_{};  // first lane of each particle
  };
  /// A particle before the step.
  [[gnu::always_inline]] void begin(Outcome& outcome, const State& p) const {
    outcome.energies_.before += p.m * (p.v * p.v);
  }
  /// The same particle after it.
  [[gnu::always_inline]] void end(Outcome& outcome, const State& p) const {
    outcome.squares_ += p.squares;
    outcome.energies_.after += p.m * (p.v * p.v);
    if constexpr (Dim == 3) outcome.energies_.after += p.inertia * (p.w * p.w);
    if constexpr (has_angle) {
      for (const auto& of_one : p.angle) {
        for (const Real turned : of_one) outcome.angles_ += turned - turned;
      }
    }
    outcome.lowest_ = p.x < outcome.lowest_ ? p.x : outcome.lowest_;
    outcome.highest_ = outcome.highest_ < p.x ? p.x : outcome.highest_;
    Pack y, z;
    shuffle_fours<1, 0, 3, 2>(p.squares, p.squares, y);
    shuffle_fours<2, 3, 0, 1>(p.squares, p.squares, z);
    const Pack squared_displacement = p.squares + y + z;
    outcome.farthest_ =
        outcome.farthest_ < squared_displacement ? squared_displacement : outcome.farthest_;
  }

 private:
  static Index second(Index i, Index last) { return at_once == 1 ? i : std::min(i + 1, last - 1); }

  static void set_threes(const std::array<Real, 3>& a, const std::array<Real, 3>& b, Pack& to) {
    if constexpr (at_once == 1) {
      to = Pack{a[0], a[1], a[2], 0};
    } else {
      to = Pack{a[0], a[1], a[2], 0, b[0], b[1], b[2], 0};
    }
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
  Pack lower_;
  Pack upper_;
  Pack period_;
};

}  // namespace silt
