// SPDX-License-Identifier: MIT
// Normal component: Hertz's spring, with a dashpot that makes restitution independent of speed.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/elastic.hpp>
#include <silt/dem/law/law_components.hpp>

#include <cmath>
#include <limits>

namespace silt::dem {

/// F = 4/3 E* √R* δ^{3/2} + c v_n, with c = 2 √(5/6) ζ √(S m*), S = dF/dδ = 2 E* √(R* δ)
/// [TsujiTanakaIshida1992]. With ζ = −ln e/√(π² + ln² e), an impact without other forces has
/// exactly the restitution e [AntypovElliott2011]; an elastic impact lasts 2.9433 δ_max/v with
/// δ_max = (15 m* v²/(16 E* √R*))^{2/5}.
struct Hertz {
  Elastic elastic = {};
  Restitution restitution = {};  ///< e [-] in (0, 1]
  /// Limits the dashpot so that the normal force is never attractive, which raises the restitution.
  bool limit_damping = false;

  template <int, class Real>
  using History = CentredDashpot::History<Real>;

  void check() const {
    elastic.check("Hertz");
    restitution.check("Hertz: restitution");
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real S = tangent(contact);
    const Real c = dashpot(contact, S);
    const Real spring = S * contact.overlap * 2 / 3;
    const Real damping = CentredDashpot::force(contact, history, S, c);
    // The overlap may have been rounded to 0; then so are S and c.
    const Real divisor = larger(S, Real(std::numeric_limits<float>::min()));
    return {.spring = spring,
            .dashpot = limited_dashpot(limit_damping, spring, damping),
            .stiffness = S,
            .beta = c / divisor};
  }

  /// 8/15 E* √R* δ^{5/2} [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M&) const {
    return double(tangent(contact)) * squared(double(contact.overlap)) * 4 / 15;
  }

  /// Proportional to √δ.
  template <class C>
  Stiffness stiffness(const C& contact) const {
    const double S = double(tangent(contact));
    const double c = double(dashpot(contact, tangent(contact)));
    return {.normal = S, .beta = S > 0 ? CentredDashpot::stability_factor * c / S : 0};
  }

  /// 1/E* is the sum of both materials' (1 − ν²)/E; the lower restitution; the dashpot is limited
  /// if either one is.
  static Hertz mix(const Hertz& a, const Hertz& b) {
    return {.elastic = Elastic::mix(a.elastic, b.elastic),
            .restitution = Restitution::mix(a.restitution, b.restitution),
            .limit_damping = a.limit_damping || b.limit_damping};
  }

 private:
  // S [N/m].
  template <class C>
  typename C::Real tangent(const C& contact) const {
    using std::sqrt;
    using Real = typename C::Real;
    return Real(2 * elastic.contact_modulus()) * sqrt(contact.effective_radius * contact.overlap);
  }

  // c [N s/m].
  template <class C>
  typename C::Real dashpot(const C& contact, typename C::Real S) const {
    using std::sqrt;
    using Real = typename C::Real;
    return Real(2 * std::sqrt(5.0 / 6) * restitution.damping_ratio) *
           sqrt(S * contact.effective_mass);
  }
};

}  // namespace silt::dem
