// SPDX-License-Identifier: MIT
// A spring and a slider in series, with a parallel dashpot: shared by tangential friction, rolling
// resistance and twisting resistance.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <string_view>

namespace silt::dem {

/// Friction angle φ [rad] and its tangent, computed once.
struct FrictionAngle {
  double value = 0;
  double tangent = 0;

  constexpr FrictionAngle() = default;
  /// From φ [rad]; check() tests its range.
  FrictionAngle(double angle) : value(angle), tangent(std::tan(angle)) {}

  /// Throws unless 0 ≤ φ < π/2; the message also says how to convert degrees and coefficients.
  void check(std::string_view name) const {
    require_not_negative(name, value);
    if (value <= std::numbers::pi / 2 - 1e-6) return;
    const std::string own = to_text(value);
    fail({name, " = ", own, " rad is not below π/2; give radians: ",
          (value < 90 ? own + " degrees are " + to_text(value * std::numbers::pi / 180)
                      : "degrees times π/180"),
          ", and a coefficient μ is the angle atan(μ)"});
  }

  /// The smaller one.
  static FrictionAngle mix(const FrictionAngle& a, const FrictionAngle& b) {
    return b.value < a.value ? b : a;
  }
};

/// Largest coefficient of rolling or twisting friction: those of grains are below 1, angles in
/// degrees mostly above 2.
inline constexpr double max_resistance = 2;

/// Throws unless 0 ≤ μ ≤ max_resistance.
inline void check_resistance(std::string_view name, double coefficient) {
  require_not_negative(name, coefficient);
  if (coefficient <= max_resistance) return;
  const std::string own = to_text(coefficient);
  fail({name, " = ", own, " is above ", max_resistance,
        "; give a coefficient, not an angle in degrees",
        (coefficient < 90 ? ": for " + own + " degrees it is " +
                                to_text(std::tan(coefficient * std::numbers::pi / 180))
                          : "")});
}

/// The spring force [N] of the previous step, or couple [N m], rotated into the current contact
/// plane, to which n is normal, with its magnitude unchanged.
template <class Vec>
Vec rotated_into_plane(const Vec& spring, const Vec& n) {
  using std::sqrt;
  using Real = typename Vec::Scalar;
  const Vec in_plane = spring - spring.dot(n) * n;
  const Real squared_length = in_plane.squaredNorm();
  // Without a force in the plane it does not matter, but a root has no derivative at 0.
  const bool has_direction = squared_length > 0;
  const Real ratio = choose(has_direction, Real(spring.squaredNorm()), Real(1)) /
                     choose(has_direction, squared_length, Real(1));
  // The ratio of a finite spring overflows if it is normal to the plane but for rounding errors.
  return in_plane * sqrt(smaller(ratio, Real(Eigen::NumTraits<Real>::highest())));
}

/// In units of a force; for rolling and twisting, in those of a couple.
template <class Real>
struct Slider {
  Real stiffness = 0;  ///< k [N/m]
  Real dashpot = 0;    ///< c [N s/m]; inactive while the slider slides (23)
  Real limit = 0;      ///< of the spring force, not below 0 [N]
};

/// What slide() returns: force on i, or couple [N m].
template <class Vec>
struct SliderForce {
  Vec spring;                 ///< [N]
  Vec dashpot;                ///< [N]
  typename Vec::Scalar lost;  ///< energy dissipated by sliding in this step [J]
};

/// |v| [unit of v]; of a single number without a root.
template <class Vec>
typename Vec::Scalar magnitude(const Vec& v) {
  if constexpr (Vec::SizeAtCompileTime == 1) {
    using std::abs;
    return abs(v[0]);
  } else {
    return v.norm();
  }
}

/// F^N = F^{N−1} − k v Δt, (10)–(13) of [SahChoi2004]. `before` is the spring force of the previous
/// step, already rotated with the contact. At time 0 nothing has slipped yet; the dashpot is then
/// inactive if the first step will make the slider slide.
template <class Vec, class Real, class C>
SliderForce<Vec> slide(const Slider<Real>& slider, const Vec& before, const Vec& v,
                       const C& contact) {
  const Vec trial = before - slider.stiffness * v * contact.time_step;
  const Real size = magnitude(trial);
  const bool slides = size > slider.limit;  // (13)
  const Real share = choose(slides, slider.limit, Real(1)) / choose(slides, size, Real(1));
  const Vec F = trial * share;
  const Real first = slider.stiffness * contact.first_time_step;
  const bool will_slide = v.squaredNorm() * first * first > slider.limit * slider.limit;
  const Real c = choose(will_slide, Real(0), choose(slides, Real(0), slider.dashpot));
  // The slider moved by (F − trial)/k, against the mean of the forces before and after.
  const Real lost =
      (trial - F).dot(before + F) / choose(slides, Real(2 * slider.stiffness), Real(1));
  return {F, -c * v, larger(Real(0), lost)};
}

/// What with_stiffness() and with_displacement() return: force on i, or couple [N m].
template <class Vec>
struct RescaledForce {
  Vec force;                  ///< [N]
  typename Vec::Scalar lost;  ///< energy dissipated by the change of stiffness [J]
};

/// Force of a spring whose stiffness changes to k from k/ratio in a step with this displacement
/// [m]; in the first step of a contact the ratio is not finite. If the stiffness rises, the force
/// is kept; if it falls, the deflection is kept. In neither case does the stored energy rise.
template <class Vec, class Real>
RescaledForce<Vec> with_stiffness(Real k, Real ratio, const Vec& force, const Vec& displacement) {
  const Vec kept = force * choose(ratio < 1, ratio, Real(1));
  // The force changes during the displacement: the work is that of the mean of both.
  const Real lost =
      (force.squaredNorm() * ratio - kept.squaredNorm()) / k - displacement.dot(force - kept);
  const bool had_spring = ratio < std::numeric_limits<double>::infinity();
  return {kept, choose(had_spring && ratio > 0 && k > 0, larger(Real(0), Real(lost / 2)), Real(0))};
}

/// The same if the displacement F/k [m] is always kept. If the stiffness rises, the lost energy is
/// negative.
template <class Vec, class Real>
RescaledForce<Vec> with_displacement(Real k, Real ratio, const Vec& force) {
  const bool is_bounded = ratio < std::numeric_limits<double>::infinity();
  const Real finite_ratio = choose(is_bounded, choose(ratio > 0, ratio, Real(1)), Real(1));
  const Real lost = force.squaredNorm() * finite_ratio * (1 - finite_ratio) / k;
  const Real share = choose(k > 0, finite_ratio, Real(0));
  return {force * share, choose(k > 0, Real(lost / 2), Real(0))};
}

/// ½ F²/k [J]; 0 without a spring.
template <class Vec>
double energy_of_spring(const Vec& force, double stiffness) {
  return stiffness > 0 ? double(force.squaredNorm()) / (2 * stiffness) : 0;
}

}  // namespace silt::dem
