// SPDX-License-Identifier: MIT
// The motion of particles stored in rows.
//
// Included once for each instruction set, see core/each_instruction_set.hpp.
#ifndef SILT_INSTRUCTION_SET
#ifndef SILT_INTEGRATE_MOTION_IN_ROWS
#define SILT_INTEGRATE_MOTION_IN_ROWS

#include <silt/core/error.hpp>
#include <silt/core/particles.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <utility>

namespace silt::detail {

/// The fields of particles in rows of four numbers, {x y z R}, {vx vy vz m} and {wx wy wz I}, in 2D
/// {x y R m} and {vx vy w I}, before a step and after it.
template <class P>
struct RowsOfMotion {
  using Real = typename P::Real;
  static constexpr bool has_angle = HasFields<P, angle_t>;

  /// Begins a step: Particles::advance_rows() of the rows that move.
  explicit RowsOfMotion(P& particles)
      : linear(particles.advance_rows(position)),
        angular(particles.advance_rows(spin)),
        forces(std::as_const(particles)[force]),
        torques(std::as_const(particles)[torque]) {
    if constexpr (has_angle) angles = particles.advance(angle);
    constexpr Real infinity = std::numeric_limits<Real>::infinity();
    const auto& box = particles.box();
    for (int k = 0; k < 4; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const bool is_position = k < P::dimension;
      lower[axis] = is_position ? box.lower[k] : -infinity;
      upper[axis] = is_position ? box.upper[k] : infinity;
      const bool is_periodic = is_position && box.periodic[axis];
      period[axis] = is_periodic ? upper[axis] - lower[axis] : 0;
    }
  }

  using Rows = decltype(std::declval<P&>().advance_rows(position));
  struct Missing {};
  static auto angles_of(P& particles) {
    if constexpr (has_angle) {
      return particles.advance(angle);
    } else {
      return Missing{};
    }
  }

  Rows linear;
  Rows angular;
  decltype(std::declval<const P&>()[force]) forces;
  decltype(std::declval<const P&>()[torque]) torques;
  decltype(angles_of(std::declval<P&>())) angles{};
  // Of the box, and of the fourth number; the period is 0 along axes that are not periodic.
  std::array<Real, 4> lower;
  std::array<Real, 4> upper;
  std::array<Real, 4> period;
};

}  // namespace silt::detail

#define SILT_KERNELS <silt/integrate/motion_in_rows.hpp>
#include <silt/core/each_instruction_set.hpp>

#endif
#else

namespace silt::detail::SILT_INSTRUCTION_SET {
namespace simd = silt::simd::SILT_INSTRUCTION_SET;

/// The motion of particles in rows of four numbers. Where registers hold eight, two particles are
/// processed together.
template <class P>
class MotionInRows : RowsOfMotion<P> {
  using Real = typename P::Real;
  static constexpr int N = 8 * sizeof(Real) <= simd::width ? 8 : 4;
  using Pack = simd::Pack<Real, N>;
  static constexpr int Dim = P::dimension;
  static constexpr int spin_words = angular_size<Dim>;
  using RowsOfMotion<P>::has_angle;

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
    Real angle[at_once][spin_words];  ///< of each particle [rad]
    Pack squares{};  ///< of the displacement by drift() [m²]
  };

  explicit MotionInRows(const RowsOfMotion<P>& rows) : RowsOfMotion<P>(rows) {
    simd::load_fours(rows.lower.data(), rows.lower.data(), lower_);
    simd::load_fours(rows.upper.data(), rows.upper.data(), upper_);
    simd::load_fours(rows.period.data(), rows.period.data(), period_);
  }

  /// Particle i and, if two are processed together, the next of the range that ends at `last`; at
  /// its end, the same again.
  [[gnu::always_inline]] State load(Index i, Index last) const {
    const Index j = second(i, last);
    State p;
    simd::load_fours(this->linear.before + 8 * i, this->linear.before + 8 * j, p.x);
    simd::load_fours(this->linear.before + 8 * i + 4, this->linear.before + 8 * j + 4, p.v);
    if constexpr (Dim == 2) {
      simd::shuffle_fours<3, 3, 7, 7>(p.x, p.v, p.m);
      set_threes({this->forces[i][0], this->forces[i][1], this->torques[i]},
                 {this->forces[j][0], this->forces[j][1], this->torques[j]}, p.a);
      p.a *= 1 / p.m;
    } else {
      simd::load_fours(this->angular.before + 4 * i, this->angular.before + 4 * j, p.w);
      if constexpr (at_once == 1) {
        p.m = this->linear.before[8 * i + 7] - Pack{};
        p.inertia = this->angular.before[4 * i + 3] - Pack{};
      } else {
        simd::shuffle_fours<3, 3, 3, 3>(p.v, p.v, p.m);
        simd::shuffle_fours<3, 3, 3, 3>(p.w, p.w, p.inertia);
      }
      Pack per_mass, per_inertia;
      simd::inverse_of_fourths(p.v, p.w, per_mass, per_inertia);
      simd::load_threes(this->forces[i].data(), this->forces[j].data(), p.a);
      simd::load_threes(this->torques[i].data(), this->torques[j].data(), p.w_dot);
      p.a *= per_mass;
      p.w_dot *= per_inertia;
    }
    if constexpr (has_angle) {
      for (int k = 0; k < spin_words; ++k) {
        p.angle[0][k] = component(this->angles.before[i], k);
        p.angle[at_once - 1][k] = component(this->angles.before[j], k);
      }
    }
    if constexpr (at_once == 2) {
      if (i == j) {  // its energy counts once
        simd::keep_first_four(p.m);
        if constexpr (Dim == 3) simd::keep_first_four(p.inertia);
      }
    }
    return p;
  }

  [[gnu::always_inline]] void store(Index i, Index last, const State& p) const {
    const Index j = second(i, last);
    simd::store_fours(p.x, this->linear.after + 8 * i, this->linear.after + 8 * j);
    simd::store_fours(p.v, this->linear.after + 8 * i + 4, this->linear.after + 8 * j + 4);
    if constexpr (Dim == 3)
      simd::store_fours(p.w, this->angular.after + 4 * i, this->angular.after + 4 * j);
    if constexpr (has_angle) {
      for (int k = 0; k < spin_words; ++k) {
        component(this->angles.after[i], k) = p.angle[0][k];
        component(this->angles.after[j], k) = p.angle[at_once - 1][k];
      }
    }
  }

  /// As in MotionInColumns. The compiler makes packs of the numbers. The fourth of each four is not
  /// a velocity, and its change is not used.
  template <class Change>
  [[gnu::always_inline]] static void change_velocities(State& p, Change&& change) {
    const auto change_threes = [&](Pack& v, const Pack& a) {
      Real numbers[N], of_a[N];
      simd::store<Real, N>(numbers, v);
      simd::store<Real, N>(of_a, a);
      for (int k = 0; k < N; ++k) change(numbers[k], of_a[k]);
      Pack changed;
      simd::load_pack(numbers, changed);
      simd::shuffle_fours<0, 1, 2, 7>(changed, v, v);
    };
    change_threes(p.v, p.a);
    if constexpr (Dim == 3) change_threes(p.w, p.w_dot);
  }

  [[gnu::always_inline]] void drift(State& p, double dt) const {
    const Pack moved = p.x + p.v * Real(dt);
    // No number but the position moves.
    Pack x;
    if constexpr (Dim == 2) {
      simd::shuffle_fours<0, 1, 6, 7>(moved, p.x, x);
    } else {
      simd::shuffle_fours<0, 1, 2, 7>(moved, p.x, x);
    }
    const Pack with_rounding = x - p.x;
    p.squares = with_rounding * with_rounding;
    const Pack above = x < lower_ ? x + period_ : x;
    p.x = above < upper_ ? above : above - period_;
    if constexpr (has_angle) {
      for (Index one = 0; one < at_once; ++one) {
        for (int k = 0; k < spin_words; ++k) {
          const auto lane = static_cast<int>(4 * one) + (Dim == 2 ? 2 : k);
          p.angle[one][k] += (Dim == 2 ? p.v : p.w)[lane] * Real(dt);
        }
      }
    }
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
      simd::shuffle_fours<0, 1, 2, 7>(squares + after_, squares, sums);
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
    /// Sums of twice the kinetic energy [J], before the step, in 3D without rotation, and after it.
    /// The round-off depends on the order of the particles and on the instruction set.
    double energy_before() const { return sum_of(before_); }
    double energy_after() const { return sum_of(after_); }

   private:
    friend MotionInRows;
    static constexpr Real infinity = std::numeric_limits<Real>::infinity();
    // The fourth of each four is unspecified.
    static double sum_of(const Pack& energy) {
      double sum = 0;
      for (int k = 0; k < N; ++k) {
        if (k % 4 < 3) sum += double(energy[k]);
      }
      return sum;
    }

    Pack squares_{};
    Pack before_{};
    Pack after_{};
    Real angles_ = 0;
    Pack lowest_ = infinity - Pack{};
    Pack highest_ = -infinity - Pack{};
    Pack farthest_{};  // first lane of each particle
  };
  /// A particle before the step.
  [[gnu::always_inline]] void begin(Outcome& outcome, const State& p) const {
    outcome.before_ += p.m * (p.v * p.v);
  }
  /// The same particle after it.
  [[gnu::always_inline]] void end(Outcome& outcome, const State& p) const {
    outcome.squares_ += p.squares;
    outcome.after_ += p.m * (p.v * p.v);
    if constexpr (Dim == 3) outcome.after_ += p.inertia * (p.w * p.w);
    if constexpr (has_angle) {
      for (const auto& of_one : p.angle) {
        for (const Real turned : of_one) outcome.angles_ += turned - turned;
      }
    }
    outcome.lowest_ = p.x < outcome.lowest_ ? p.x : outcome.lowest_;
    outcome.highest_ = outcome.highest_ < p.x ? p.x : outcome.highest_;
    Pack y, z;
    simd::shuffle_fours<1, 0, 3, 2>(p.squares, p.squares, y);
    simd::shuffle_fours<2, 3, 0, 1>(p.squares, p.squares, z);
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

  Pack lower_;
  Pack upper_;
  Pack period_;
};

}  // namespace silt::detail::SILT_INSTRUCTION_SET

#endif
