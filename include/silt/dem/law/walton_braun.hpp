// SPDX-License-Identifier: MIT
// Normal component: the hysteretic spring of Walton and Braun (1986). Its restitution does not
// depend on the speed, and it needs no dashpot.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/law_components.hpp>


namespace silt::dem {

/// Loading along F = K_1 δ, unloading along F = K_2 (δ − δ_0) with K_2 = K_1/e² and the plastic
/// overlap δ_0 = (1 − e²) δ_max. Reloading follows the second line up to the first. The force is
/// never attractive: it is 0 for δ < δ_0. δ_0 is reset when the contact ends [WaltonBraun1986].
///
/// An impact without other forces has exactly the restitution e; the force acts for
/// π/2 √(m*/K_1) (1 + e).
struct WaltonBraun {
  double loading_stiffness = 0;  ///< K_1 [N/m], above 0
  Restitution restitution = {};  ///< e [-] in (0, 1]

  template <int, class Real>
  struct History {
    Real max_overlap = 0;  ///< δ_max, largest overlap since the contact began [m]

    template <class Archive>
    void transfer(Archive& archive) {
      archive("max_overlap", max_overlap);
    }
  };

  void check() const {
    check_magnitude("WaltonBraun: loading_stiffness", loading_stiffness);
    restitution.check("WaltonBraun: restitution");
    if (unloading_stiffness() > 1e100) {
      fail({"WaltonBraun: restitution = ", restitution.value, " gives an unloading stiffness of ",
            unloading_stiffness(), " N/m, above 1e100 N/m; give a higher restitution"});
    }
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real K_1 = Real(loading_stiffness);
    const Real before = history.max_overlap;
    history.max_overlap = larger(before, contact.overlap);
    // ∫ F dδ_0 along the loading line.
    const Real plastic =
        K_1 * Real(residual_share()) * (squared(history.max_overlap) - squared(before)) / 2;
    return {.spring = spring_force(contact, history), .stiffness = K_1, .plastic = plastic};
  }

  /// Energy recovered when unloaded [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return squared(double(spring_force(contact, history))) / (2 * unloading_stiffness());
  }

  /// K_2, the larger of the two.
  template <class C>
  Stiffness stiffness(const C&) const {
    return {.normal = unloading_stiffness()};
  }

  /// Springs in series (equal stiffnesses are kept), the lower restitution.
  static WaltonBraun mix(const WaltonBraun& a, const WaltonBraun& b) {
    return {.loading_stiffness = in_series(a.loading_stiffness, b.loading_stiffness),
            .restitution = Restitution::mix(a.restitution, b.restitution)};
  }

 private:
  double unloading_stiffness() const { return loading_stiffness / squared(restitution.value); }
  // δ_0/δ_max [-].
  double residual_share() const { return 1 - squared(restitution.value); }

  template <class C, class M>
  typename C::Real spring_force(const C& contact, const M& history) const {
    using Real = typename C::Real;
    const Real delta_0 = Real(residual_share()) * history.max_overlap;
    return larger(Real(0), Real(Real(unloading_stiffness()) * (contact.overlap - delta_0)));
  }
};

}  // namespace silt::dem
