// SPDX-License-Identifier: MIT
// A spring and a slider in series, with a parallel dashpot: shared by tangential friction, rolling
// resistance and twisting resistance.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

namespace silt::dem {

/// Friction angle φ [rad] and its tangent, computed once.
struct FrictionAngle {
  double value = 0;
  double tangent = 0;

  constexpr FrictionAngle() = default;
  FrictionAngle(double angle) : value(angle), tangent(std::tan(angle)) {}

  /// Throws unless 0 ≤ φ < π/2.
  void check(std::string_view name) const {
    require_between(name, value, {0, std::numbers::pi / 2 - 1e-6});
  }

  /// The smaller one.
  static FrictionAngle mix(const FrictionAngle& a, const FrictionAngle& b) {
    return b.value < a.value ? b : a;
  }
};

/// The spring force of the previous step, rotated into the current contact plane with its magnitude
/// unchanged.
template <class Vec>
Vec rotated_into_plane(const Vec& spring, const Vec& n) {
  using Real = typename Vec::Scalar;
  const Vec in_plane = spring - spring.dot(n) * n;
  const Real squared_length = in_plane.squaredNorm();
  const Real ratio = squared_length > 0 ? spring.squaredNorm() / squared_length : Real(0);
  return in_plane * std::sqrt(ratio);
}

/// In units of a force; for rolling and twisting, in those of a couple.
template <class Real>
struct Slider {
  Real stiffness = 0;  ///< k [N/m]
  Real dashpot = 0;    ///< c [N s/m]; inactive while the slider slides (23)
  Real limit = 0;      ///< of the spring force, not below 0 [N]
};

template <class Vec>
struct SliderForce {
  Vec spring;                 ///< [N]
  Vec dashpot;                ///< [N]
  typename Vec::Scalar lost;  ///< energy dissipated by sliding in this step [J]
};

/// |v|; of a single number without a root.
template <class Vec>
typename Vec::Scalar magnitude(const Vec& v) {
  if constexpr (Vec::SizeAtCompileTime == 1) {
    return std::abs(v[0]);
  } else {
    return v.norm();
  }
}

/// F^N = F^{N−1} − k v Δt, (10)–(13) of [SahChoi2004]. `before` is the spring force of the previous
/// step, already rotated with the contact.
template <class Vec, class Real>
SliderForce<Vec> slide(const Slider<Real>& slider, const Vec& before, const Vec& v,
                       Real time_step) {
  const Vec trial = before - slider.stiffness * v * time_step;
  const Real size = magnitude(trial);
  const bool slides = size > slider.limit;  // (13)
  const Vec F = slides ? Vec(trial * (slider.limit / size)) : trial;
  const Real c = slides ? Real(0) : slider.dashpot;
  // The slider moved by (F − trial)/k, against the mean of the forces before and after.
  const Real lost = slides ? (trial - F).dot(before + F) / (2 * slider.stiffness) : Real(0);
  return {F, -c * v, std::max(Real(0), lost)};
}

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
  const Vec kept = ratio < 1 ? Vec(force * ratio) : force;
  // The force changes during the displacement: the work is that of the mean of both.
  const Real lost =
      (force.squaredNorm() * ratio - kept.squaredNorm()) / k - displacement.dot(force - kept);
  const bool had_spring = double(ratio) < std::numeric_limits<double>::infinity();
  return {kept, had_spring && ratio > 0 && k > 0 ? std::max(Real(0), lost / 2) : Real(0)};
}

/// ½ F²/k [J]; 0 without a spring.
template <class Vec>
double energy_of_spring(const Vec& force, double stiffness) {
  return stiffness > 0 ? double(force.squaredNorm()) / (2 * stiffness) : 0;
}

}  // namespace silt::dem
