// SPDX-License-Identifier: MIT
// A user-defined contact law: LAMMPS's gran/hooke/history, so that both codes do the same work.
#pragma once

#include <silt/core/types.hpp>

#include <algorithm>
#include <cmath>

namespace bench {

/// Linear springs and dashpots in normal and tangential direction, and a slider, see
/// `pair_style gran/hooke/history kn kt gamma_n gamma_t xmu dampflag` in LAMMPS's manual:
///   F_n = k_n δ − m* γ_n v_n,  F_t = −(k_t s + m* γ_t v_t),  |F_t| ≤ µ |F_n|
/// s is the tangential displacement since the beginning of the contact; while it slips, s is
/// reduced to the value that gives the limited F_t. Needs LeverArm::radius.
struct HookeHistory {
  double kn = 0;       ///< k_n [N/m]
  double kt = 0;       ///< k_t [N/m], above 0
  double gamma_n = 0;  ///< γ_n [1/s]; m* γ_n is the dashpot coefficient
  double gamma_t = 0;  ///< γ_t [1/s]; 0 is LAMMPS's dampflag 0
  double xmu = 0;      ///< µ [-]

  template <int Dim, class Real>
  struct History {
    silt::Vec<Dim, Real> shear = silt::Vec<Dim, Real>::Zero();  ///< s [m]
  };

  template <class Contact, class M>
  typename Contact::Vec force(const Contact& c, M& history) const {
    using Real = typename Contact::Real;
    using Vec = typename Contact::Vec;
    const Real F_n = Real(kn) * c.overlap + c.effective_mass * Real(gamma_n) * c.approach_speed();
    const Vec v_t = c.tangential_velocity();
    const Vec moved = history.shear + v_t * c.time_step;
    const Vec s = moved - moved.dot(c.normal) * c.normal;
    const Vec D_t = c.effective_mass * Real(gamma_t) * v_t;
    const Vec F_t = -(Real(kt) * s + D_t);
    const Real size = F_t.norm();
    const Real limit = Real(xmu) * std::abs(F_n);
    const bool slides = size > limit;
    const Real kept = silt::choose(slides, limit, Real(1)) / silt::choose(slides, size, Real(1));
    history.shear = kept * s - (1 - kept) / Real(kt) * D_t;
    return F_n * c.normal + kept * F_t;
  }
};

}  // namespace bench
