// SPDX-License-Identifier: MIT
// A spring with a slider in series and a dashpot beside it: what friction along the tangent,
// rolling resistance and twisting have in common.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace silt::dem {

/// Friction angle φ [rad], with its tangent worked out once.
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

/// The contact plane turns; the spring turns with it and keeps its length.
template <class Vec>
Vec turned_into_plane(const Vec& spring, const Vec& n) {
  using Real = typename Vec::Scalar;
  const Vec in_plane = spring - spring.dot(n) * n;
  const Real length = in_plane.norm();
  return in_plane * (length > 0 ? spring.norm() / length : Real(0));
}

/// In SI units of a force; for rolling and twisting, of a moment.
template <class Real>
struct Slider {
  Real stiffness = 0;  ///< k [N/m]
  Real dashpot = 0;    ///< c [N s/m]; while it slides, friction alone dissipates (23)
  Real limit = 0;      ///< of the spring's force, not below 0 [N]
};

template <class Vec>
struct SliderForce {
  Vec spring;                  ///< [N]
  Vec dashpot;                 ///< [N]
  typename Vec::Scalar lost;  ///< in this step by sliding [J]
};

/// F^N = F^{N−1} − k v Δt, (10)–(13) of [SahChoi2004], from the spring's force of the step before,
/// already turned with the contact.
template <class Vec, class Real>
SliderForce<Vec> slide(const Slider<Real>& slider, const Vec& before, const Vec& v,
                       Real time_step) {
  const Vec tried = before - slider.stiffness * v * time_step;
  const Real size = tried.norm();
  const bool slides = size > slider.limit;  // (13)
  const Vec F = slides ? Vec(tried * (slider.limit / size)) : tried;
  const Real c = slides ? Real(0) : slider.dashpot;
  // It slid by (F − tried)/k, against the mean of the forces before and after.
  const Real lost = slides ? (tried - F).dot(before + F) / (2 * slider.stiffness) : Real(0);
  return {F, -c * v, std::max(Real(0), lost)};
}

template <class Vec>
struct KeptForce {
  Vec force;                  ///< [N]
  typename Vec::Scalar lost;  ///< by the change [J]
};

/// A spring's force when its stiffness has become k in a step in which it goes this way [m]. A
/// stiffer spring has the same force, a softer one the same stretch: either way it holds no more
/// energy than before.
template <class Vec, class Real>
KeptForce<Vec> with_stiffness(Real k, const Vec& force, Real k_before, const Vec& way) {
  const Vec kept = k < k_before ? Vec(force * (k / k_before)) : force;
  // The way was gone while the force changed, against the mean of both.
  const Real lost = force.squaredNorm() / k_before - kept.squaredNorm() / k - way.dot(force - kept);
  return {kept, k_before > 0 && k > 0 ? std::max(Real(0), lost / 2) : Real(0)};
}

/// ½ F²/k [J]; 0 without a spring.
template <class Vec>
double energy_of_spring(const Vec& force, double stiffness) {
  return stiffness > 0 ? double(force.squaredNorm()) / (2 * stiffness) : 0;
}

}  // namespace silt::dem
