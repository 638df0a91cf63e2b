// SPDX-License-Identifier: MIT
// The law of Cundall and Strack (1979) in the form of [SahChoi2004] (8)–(13), (22)–(24): spring and
// dashpot in the normal direction; spring, dashpot and slider in the tangential direction.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/slider.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace silt::dem {

/// F_n = k_n δ and D_n = c_n v_n, with v_n at the time N of the positions: second order in Δt. The
/// default.
struct OverlapForm {
  template <int Dim, class Real>
  struct History : CentredDashpot::History<Real> {
    Vec<Dim, Real> tangential_force = Vec<Dim, Real>::Zero();  ///< spring part, on i [N]

    template <class Archive>
    void transfer(Archive& archive) {
      CentredDashpot::History<Real>::transfer(archive);
      archive("tangential_force", tangential_force);
    }
  };

  /// Spring force F_n [N].
  template <class C, class M>
  static typename C::Real spring_force(const C& contact, M&, typename C::Real k_n) {
    return k_n * contact.overlap;
  }

  /// Dashpot force D_n [N]; see CentredDashpot.
  template <class C, class M>
  static typename C::Real dashpot_force(const C& contact, M& history, typename C::Real k_n,
                                        typename C::Real c_n) {
    return CentredDashpot::force(contact, history, k_n, c_n);
  }

  /// Deflection of the spring [m].
  template <class C, class M>
  static double compression(const C& contact, const M&, double) {
    return double(contact.overlap);
  }

  /// The β of a dashpot counts so many times for the stable time step [-]; see CentredDashpot.
  static constexpr double stability_factor = CentredDashpot::stability_factor;
};

/// F_n^N = F_n^{N−1} + k_n v_n Δt and D_n = c_n v_n^{N−½}: exactly (8), (10), (12) and (22) of
/// [SahChoi2004], first order in Δt. Converges to OverlapForm as Δt → 0.
struct IncrementalForm {
  template <int Dim, class Real>
  struct History {
    Vec<Dim, Real> tangential_force = Vec<Dim, Real>::Zero();  ///< spring part, on i [N]
    Real normal_force = 0;                                     ///< spring part [N]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("tangential_force", tangential_force);
      archive("normal_force", normal_force);
    }
  };

  /// Spring force F_n^N [N], (8) (10) (12); kept in the history.
  template <class C, class M>
  static typename C::Real spring_force(const C& contact, M& history, typename C::Real k_n) {
    history.normal_force += k_n * contact.approach_speed() * contact.time_step;
    return history.normal_force;
  }

  /// Dashpot force D_n [N], (22).
  template <class C, class M>
  static typename C::Real dashpot_force(const C& contact, M&, typename C::Real,
                                        typename C::Real c_n) {
    return c_n * contact.approach_speed();
  }

  /// Deflection of the spring, F_n/k_n [m].
  template <class C, class M>
  static double compression(const C&, const M& history, double k_n) {
    return double(history.normal_force) / k_n;
  }

  /// The dashpot uses the velocity at N − ½, as the stability limit assumes [-].
  static constexpr double stability_factor = 1;
};

/// The law of [CundallStrack1979] as in [SahChoi2004], with the normal force of a NormalForm: see
/// CundallStrack and CundallStrackIncremental.
template <class NormalForm>
struct CundallStrackLaw {
  double normal_stiffness = 0;      ///< k_n [N/m], above 0
  double tangential_stiffness = 0;  ///< k_s [N/m]; 0: no friction
  Restitution restitution = {};  ///< e [-] in (0, 1]; sets c_n = 2 ζ √(k_n m*), c_s = c_n k_s/k_n
  std::optional<double> beta = {};    ///< β [s]: c_n = β k_n, c_s = β k_s (24); alternative to e
  FrictionAngle friction_angle = {};  ///< φ_μ [rad] in [0, π/2)
  double cohesion = 0;                ///< c of (13): limit of the tangential force without load [N]
  /// Limits the dashpot so that the normal force is never attractive; the restitution is then the
  /// larger e_clip(ζ) of [SchwagerPoeschel2007].
  bool limit_damping = false;

  template <int Dim, class Real>
  using History = typename NormalForm::template History<Dim, Real>;

  /// Throws if a parameter is out of range.
  void check() const {
    check_magnitude("CundallStrack: normal_stiffness", normal_stiffness);
    check_magnitude_or_zero("CundallStrack: tangential_stiffness", tangential_stiffness);
    restitution.check("CundallStrack: restitution");
    friction_angle.check("CundallStrack: friction_angle");
    require_not_negative("CundallStrack: cohesion", cohesion);
    require_spring_for("friction_angle", friction_angle.value, "rad");
    require_spring_for("cohesion", cohesion, "N");
    if (beta) {
      check_magnitude_or_zero("CundallStrack: beta", *beta);
      if (restitution.value != 1) {
        fail({"CundallStrack: restitution = ", restitution.value, " and beta = ", *beta,
              " s both define the dashpot; give only one of them"});
      }
    }
  }

  template <class C, class M>
  auto components(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real k_n = Real(normal_stiffness);
    const Real k_s = Real(tangential_stiffness);
    const Real c_over_k = dashpot_over_spring(contact.effective_mass);

    ForceComponents<C::dimension, Real> result;
    const Real F_n = NormalForm::spring_force(contact, history, k_n);
    const Real D_n = NormalForm::dashpot_force(contact, history, k_n, c_over_k * k_n);
    result.normal_spring = F_n;
    result.normal_dashpot = limited_dashpot(limit_damping, F_n, D_n);

    const Slider<Real> slider{
        .stiffness = k_s,
        .dashpot = c_over_k * k_s,
        .limit = larger(Real(0), Real(F_n * Real(friction_angle.tangent) + Real(cohesion)))};
    const auto tangential =
        slide(slider, rotated_into_plane(history.tangential_force, contact.normal),
              contact.tangential_velocity(), contact);
    history.tangential_force = tangential.spring;
    result.tangential_spring = tangential.spring;
    result.tangential_dashpot = tangential.dashpot;
    result.friction = tangential.lost;
    return result;
  }

  template <class C, class M>
  ElasticEnergies elastic_energies(const C& contact, const M& history) const {
    return {.normal = normal_stiffness *
                      squared(NormalForm::compression(contact, history, normal_stiffness)) / 2,
            .tangential = energy_of_spring(history.tangential_force, tangential_stiffness)};
  }

  /// Energy stored in the two springs [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return elastic_energies(contact, history).sum();
  }

  template <class C>
  Stiffness stiffness(const C& contact) const {
    return {
        .normal = normal_stiffness,
        .tangential = tangential_stiffness,
        .beta = NormalForm::stability_factor * double(dashpot_over_spring(contact.effective_mass))};
  }

  /// Between two materials: springs in series (equal stiffnesses are kept), the lower restitution,
  /// the smaller friction angle and cohesion (13).
  /// Throws if one material defines its dashpot by e and the other by β.
  static CundallStrackLaw mix(const CundallStrackLaw& a, const CundallStrackLaw& b) {
    if (a.beta.has_value() != b.beta.has_value()) {
      fail({"CundallStrack: one material has restitution = ", (a.beta ? b : a).restitution.value,
            ", the other beta = ", *(a.beta ? a : b).beta,
            " s; use the same of the two for both materials"});
    }
    CundallStrackLaw law = a.restitution.value <= b.restitution.value ? a : b;
    law.normal_stiffness = in_series(a.normal_stiffness, b.normal_stiffness);
    law.tangential_stiffness = in_series(a.tangential_stiffness, b.tangential_stiffness);
    if (a.beta || b.beta) law.beta = std::max(a.beta.value_or(0), b.beta.value_or(0));
    law.friction_angle = FrictionAngle::mix(a.friction_angle, b.friction_angle);
    law.cohesion = std::min(a.cohesion, b.cohesion);
    law.limit_damping = a.limit_damping || b.limit_damping;
    return law;
  }

 private:
  // Friction limits the tangential force, which is zero without its spring.
  void require_spring_for(std::string_view name, double value, std::string_view unit) const {
    if (!(value > 0) || tangential_stiffness > 0) return;
    fail({"CundallStrack: ", name, " = ", value, " ", unit,
          " has no effect, because tangential_stiffness = 0 gives no tangential force; set "
          "tangential_stiffness, e.g. to half of normal_stiffness, or ",
          name, " to 0"});
  }

  // β = c/k [s]: the given value, or 2 ζ √(m*/k_n).
  template <class Real>
  Real dashpot_over_spring(Real effective_mass) const {
    using std::sqrt;
    // Only one of the two is set; the other is 0.
    return Real(beta.value_or(0)) +
           Real(2 * restitution.damping_ratio / std::sqrt(normal_stiffness)) * sqrt(effective_mass);
  }
};

/// F_n from the overlap; second order in Δt.
using CundallStrack = CundallStrackLaw<OverlapForm>;
/// F_n by increments, as in the paper; first order in Δt.
using CundallStrackIncremental = CundallStrackLaw<IncrementalForm>;

}  // namespace silt::dem
