// SPDX-License-Identifier: MIT
// The law of Cundall and Strack (1979) as [SahChoi2004] (8)–(13), (22)–(24) has it: a spring and a
// dashpot along the normal, a spring, a dashpot and a slider along the tangent.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace silt::dem {

/// Friction angle φ [rad], with its tangent worked out once.
struct FrictionAngle {
  double value = 0;
  double tangent = 0;

  constexpr FrictionAngle() = default;
  FrictionAngle(double angle) : value(angle), tangent(std::tan(angle)) {}
};

/// Restitution e of a head-on impact whose contact ends at zero overlap (the dashpot may pull
/// there), with the damping ratio that gives it: ζ = −ln e / √(π² + ln² e).
struct Restitution {
  double value = 1;
  double damping_ratio = 0;

  constexpr Restitution() = default;
  Restitution(double e)
      : value(e),
        damping_ratio(-std::log(e) /
                      std::sqrt(std::numbers::pi * std::numbers::pi + squared(std::log(e)))) {}
};

/// F_n = k_n δ, and D_n = c_n v_n with the velocity at N itself: second order in Δt. The default.
struct OverlapForm {
  template <int Dim, class Real>
  struct Memory {
    Vec<Dim, Real> tangential_force = Vec<Dim, Real>::Zero();  ///< spring part, on i [N]
    Real approach_speed = 0;  ///< v_n of the half step before the last [m/s]
    Real was_there = 0;       ///< 1 once approach_speed is known [-]
  };

  template <class C, class M>
  static typename C::Real spring_force(const C& contact, M&, typename C::Real k_n) {
    return k_n * contact.overlap;
  }

  /// D_n (22), with v_n^N in place of v_n^{N−½}, which is half a step late: extrapolated from the
  /// last two half steps, v_n^N = v_n^{N−½} + ½ (v_n^{N−½} − v_n^{N−3/2}).
  template <class C, class M>
  static typename C::Real dashpot_force(const C& contact, M& memory, typename C::Real k_n,
                                        typename C::Real c_n) {
    using Real = typename C::Real;
    const Real v_half = contact.approach_speed();
    // Before it touched, it flew freely.
    const Real v_n = v_half + memory.was_there * (v_half - memory.approach_speed) / 2;
    memory.approach_speed = v_half;
    memory.was_there = 1;
    // Extrapolated, the velocity of an oscillation is too large by the factor 1 + ⅜ (ω Δt)².
    const Real swing = k_n * squared(contact.time_step) / contact.effective_mass;
    return c_n * v_n * share_of_step(contact.overlap, std::abs(v_n) * contact.time_step) /
           (1 + swing * 3 / 8);
  }

  /// Extrapolation makes a dashpot count twice in the limit of stability.
  static constexpr double lateness = 2;

 private:
  // A contact begins and ends somewhere within a step, and its dashpot begins and ends with a
  // jump. With u steps since the beginning (or before the end), the steps u and u + 1 must
  // together carry u + 3/2 steps' worth of it; this is the continuous weight that does and that is
  // 1 from u = 2 on.
  template <class Real>
  static Real share_of_step(Real overlap, Real way_of_a_step) {
    const Real u = overlap / way_of_a_step;
    return u < 1 ? u * 3 / 2 : std::max(Real(1), 2 - u / 2);
  }
};

/// F_n^N = F_n^{N−1} + k_n v_n Δt and D_n = c_n v_n^{N−½}: the paper's (8), (10), (12), (22) to the
/// letter, first order in Δt. Tends to OverlapForm as Δt → 0.
struct IncrementalForm {
  template <int Dim, class Real>
  struct Memory {
    Vec<Dim, Real> tangential_force = Vec<Dim, Real>::Zero();  ///< spring part, on i [N]
    Real normal_force = 0;                                     ///< spring part [N]
  };

  template <class C, class M>
  static typename C::Real spring_force(const C& contact, M& memory, typename C::Real k_n) {
    memory.normal_force += k_n * contact.approach_speed() * contact.time_step;
    return memory.normal_force;
  }

  template <class C, class M>
  static typename C::Real dashpot_force(const C& contact, M&, typename C::Real,
                                        typename C::Real c_n) {
    return c_n * contact.approach_speed();
  }

  static constexpr double lateness = 1;
};

template <class NormalForm>
struct CundallStrackLaw {
  double normal_stiffness = 0;      ///< k_n [N/m], above 0
  double tangential_stiffness = 0;  ///< k_s [N/m]; 0: no friction force at all
  Restitution restitution = {};     ///< e [-] in (0, 1]; sets c_n = 2 ζ √(k_n m*), c_s = c_n k_s/k_n
  std::optional<double> beta = {};  ///< β [s]: c_n = β k_n, c_s = β k_s (24), in place of e
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)
  double cohesion = 0;                ///< c of (13): tangential force that holds without load [N]
  bool tension = true;  ///< false: the dashpot never pulls, and e grows to e_clip(ζ) of Schwager
                        ///< and Pöschel (2007)

  template <int Dim, class Real>
  using Memory = typename NormalForm::template Memory<Dim, Real>;

  /// Throws if a parameter is out of range.
  void check() const {
    require_positive("CundallStrack: normal_stiffness", normal_stiffness);
    require_not_negative("CundallStrack: tangential_stiffness", tangential_stiffness);
    require_positive("CundallStrack: restitution", restitution.value);
    require_between("CundallStrack: restitution", restitution.value, {0, 1});
    require_between("CundallStrack: friction_angle", friction_angle.value,
                    {0, std::numbers::pi / 2 - 1e-6});
    require_not_negative("CundallStrack: cohesion", cohesion);
    if (beta) {
      require_not_negative("CundallStrack: beta", *beta);
      if (restitution.value != 1) {
        fail("CundallStrack: restitution = " + to_text(restitution.value) + " and beta = " +
             to_text(*beta) + " s both set the dashpot; give one of them");
      }
    }
  }

  /// Force on i [N].
  template <class C, class M>
  typename C::Vec force(const C& contact, M& memory) const {
    using Real = typename C::Real;
    using Vec = typename C::Vec;
    const Real k_n = Real(normal_stiffness);
    const Real k_s = Real(tangential_stiffness);
    const Real c_over_k = dashpot_over_spring(contact.effective_mass);
    const Vec& n = contact.normal;
    const Vec v_s = contact.tangential_velocity();

    const Real F_n = NormalForm::spring_force(contact, memory, k_n);
    const Real D_n = NormalForm::dashpot_force(contact, memory, k_n, c_over_k * k_n);

    Vec F_s = turned_into_plane(memory.tangential_force, n) - k_s * v_s * contact.time_step;
    const Real limit = std::max(Real(0), F_n * Real(friction_angle.tangent) + Real(cohesion));
    const Real size = F_s.norm();
    const bool slides = size > limit;  // (13)
    if (slides) F_s *= limit / size;
    memory.tangential_force = F_s;
    // While it slides, friction alone dissipates.
    const Real c_s = slides ? Real(0) : c_over_k * k_s;  // (23)

    const Real weakest = tension ? -std::numeric_limits<double>::infinity() : 0;
    return std::max(weakest, F_n + D_n) * n + F_s - c_s * v_s;
  }

  /// Energy in the two springs [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M& memory) const {
    double energy = normal_stiffness * squared(double(contact.overlap)) / 2;
    if (tangential_stiffness > 0) {
      energy += double(memory.tangential_force.squaredNorm()) / (2 * tangential_stiffness);
    }
    return energy;
  }

  template <class C>
  Stiffness stiffness(const C& contact) const {
    return {.normal = normal_stiffness,
            .tangential = tangential_stiffness,
            .beta = NormalForm::lateness * double(dashpot_over_spring(contact.effective_mass))};
  }

  /// Between two materials: springs in series (equal ones stay as they are), the lower restitution,
  /// and the smaller friction angle and cohesion, (13).
  /// Throws if one gives its dashpot by e and the other by β.
  static CundallStrackLaw mix(const CundallStrackLaw& a, const CundallStrackLaw& b) {
    if (a.beta.has_value() != b.beta.has_value()) {
      fail("CundallStrack: one material gives restitution = " +
           to_text((a.beta ? b : a).restitution.value) + ", the other beta = " +
           to_text(*(a.beta ? a : b).beta) + " s; give both materials the same of the two");
    }
    CundallStrackLaw law = a.restitution.value <= b.restitution.value ? a : b;
    law.normal_stiffness = in_series(a.normal_stiffness, b.normal_stiffness);
    law.tangential_stiffness = in_series(a.tangential_stiffness, b.tangential_stiffness);
    if (a.beta || b.beta) law.beta = std::max(a.beta.value_or(0), b.beta.value_or(0));
    law.friction_angle =
        a.friction_angle.value <= b.friction_angle.value ? a.friction_angle : b.friction_angle;
    law.cohesion = std::min(a.cohesion, b.cohesion);
    law.tension = a.tension && b.tension;
    return law;
  }

 private:
  static double in_series(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

  // β = c/k [s]: given, or 2 ζ √(m*/k_n).
  template <class Real>
  Real dashpot_over_spring(Real effective_mass) const {
    // Only one of the two is set; the other is 0.
    return Real(beta.value_or(0)) +
           Real(2 * restitution.damping_ratio) * std::sqrt(effective_mass / Real(normal_stiffness));
  }

  // The contact plane turns; the spring turns with it and keeps its length.
  template <class Vec>
  static Vec turned_into_plane(const Vec& spring, const Vec& n) {
    using Real = typename Vec::Scalar;
    const Vec in_plane = spring - spring.dot(n) * n;
    const Real length = in_plane.norm();
    return in_plane * (length > 0 ? spring.norm() / length : Real(0));
  }
};

using CundallStrack = CundallStrackLaw<OverlapForm>;
using CundallStrackIncremental = CundallStrackLaw<IncrementalForm>;

}  // namespace silt::dem
