// SPDX-License-Identifier: MIT
// Normal component: the adhesive, elasto-plastic spring of Luding (2008), for powders whose
// cohesion grows with the largest load they have borne.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/law_components.hpp>

#include <algorithm>
#include <cmath>

namespace silt::dem {

/// Loading along F = k_1 δ; unloading and reloading along F = k_2* (δ − δ_0) with
/// δ_0 = (1 − k_1/k_2*) δ_max; where that is below −k_c δ, F = −k_c δ, and δ_max falls so that
/// reloading begins there. k_2* grows from k_1 to k_2 in proportion to δ_max, up to
/// δ_max = δ* = k_2/(k_2 − k_1) φ_f 2 R*; beyond, the contact is elastic [Luding2008].
///
/// The largest tension after a load is k_c (k_2* − k_1)/(k_2* + k_c) δ_max. Without cohesion and
/// dashpot, an impact has the restitution √(k_1/k_2*). The force is 0 at δ = 0, where the contact
/// ends. Friction is limited by F + k_c δ.
struct PlasticCohesive {
  double loading_stiffness = 0;    ///< k_1 [N/m], above 0
  double unloading_stiffness = 0;  ///< k_2 [N/m], above k_1
  double cohesive_stiffness = 0;   ///< k_c [N/m]
  double plastic_depth = 0.05;     ///< φ_f [-] in (0, 1]: the largest δ_0 over 2 R*
  double dashpot = 0;              ///< c_n [N s/m], in addition to the hysteresis

  template <int, class Real>
  struct History {
    CentredDashpot::History<Real> dashpot{};  ///< its speed before
    Real max_overlap = 0;  ///< δ_max [m]
    Real overlap = 0;      ///< of the previous step [m]
    Real force = 0;        ///< of the spring in the previous step [N]
    Real energy = 0;       ///< recovered when unloaded [J]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("dashpot", dashpot);
      archive("max_overlap", max_overlap);
      archive("overlap", overlap);
      archive("force", force);
      archive("energy", energy);
    }
  };

  void check() const {
    check_magnitude("PlasticCohesive: loading_stiffness", loading_stiffness);
    check_magnitude("PlasticCohesive: unloading_stiffness", unloading_stiffness);
    if (!(unloading_stiffness > loading_stiffness)) {
      fail({"PlasticCohesive: unloading_stiffness = ", unloading_stiffness,
            " N/m is not above loading_stiffness = ", loading_stiffness,
            " N/m; raise it, or use LinearSpringDashpot"});
    }
    check_magnitude_or_zero("PlasticCohesive: cohesive_stiffness", cohesive_stiffness);
    require_positive("PlasticCohesive: plastic_depth", plastic_depth);
    require_between("PlasticCohesive: plastic_depth", plastic_depth, {0, 1});
    check_magnitude_or_zero("PlasticCohesive: dashpot", dashpot);
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using std::sqrt;
    using Real = typename C::Real;
    const Real k_1 = Real(loading_stiffness);
    const Real k_c = Real(cohesive_stiffness);
    const Real delta = contact.overlap;
    const Real deepest = Real(2 * plastic_depth / (1 - loading_stiffness / unloading_stiffness)) *
                         contact.effective_radius;                              // δ*
    const Real rise = Real(unloading_stiffness - loading_stiffness) / deepest;  // dk_2*/dδ_max
    const Real loaded = smaller(larger(Real(history.max_overlap), delta), deepest);
    const auto unloading = [&](const Real& delta_max) -> Real {
      return k_1 * delta - rise * delta_max * (delta_max - delta);
    };
    // The δ_max whose line of unloading begins on that of cohesion, k_2* (δ − δ_0) = −k_c δ.
    const Real reached = delta / 2 + sqrt(squared(delta) / 4 + (k_1 + k_c) / rise * delta);
    const bool coheres = unloading(loaded) < -k_c * delta;
    const Real delta_max = choose(coheres, smaller(reached, loaded), loaded);
    const Real spring = choose(coheres, Real(-k_c * delta), unloading(delta_max));
    const Real energy = squared(spring) / (2 * (k_1 + rise * delta_max));
    const Real work = (Real(history.force) + spring) / 2 * (delta - Real(history.overlap));
    const Real plastic = larger(Real(0), Real(Real(history.energy) + work - energy));
    history.max_overlap = delta_max;
    history.overlap = delta;
    history.force = spring;
    history.energy = energy;
    return {.spring = spring + k_c * delta,
            .dashpot = CentredDashpot::force(contact, history.dashpot, k_1, Real(dashpot)),
            .stiffness = k_1,
            .beta = Real(dashpot / loading_stiffness),
            .plastic = plastic,
            .adhesion = -k_c * delta};
  }

  /// Energy recovered when unloaded [J].
  template <class C, class M>
  double elastic_energy(const C&, const M& history) const {
    return double(history.energy);
  }

  /// The larger one of k_2 and k_c.
  template <class C>
  Stiffness stiffness(const C&) const {
    const double k = std::max(unloading_stiffness, cohesive_stiffness);
    return {.normal = k, .beta = CentredDashpot::stability_factor * dashpot / k};
  }

  /// Springs and dashpots in series (equal ones are kept); the smaller cohesion and depth.
  static PlasticCohesive mix(const PlasticCohesive& a, const PlasticCohesive& b) {
    return {.loading_stiffness = in_series(a.loading_stiffness, b.loading_stiffness),
            .unloading_stiffness = in_series(a.unloading_stiffness, b.unloading_stiffness),
            .cohesive_stiffness = std::min(a.cohesive_stiffness, b.cohesive_stiffness),
            .plastic_depth = std::min(a.plastic_depth, b.plastic_depth),
            .dashpot = in_series(a.dashpot, b.dashpot)};
  }
};

}  // namespace silt::dem
