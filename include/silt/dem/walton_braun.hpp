// SPDX-License-Identifier: MIT
// Along the normal: the hysteretic spring of Walton and Braun (1986), whose loss does not depend on
// the speed, and needs no dashpot.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/dashpot.hpp>
#include <silt/dem/law_parts.hpp>

#include <algorithm>

namespace silt::dem {

/// Loads along F = K_1 δ, and comes back along F = K_2 (δ − δ_0) with K_2 = K_1/e²; δ_0 is what
/// stays of the deepest overlap, δ_0 = (1 − e²) δ_deepest. Pressed again it goes up the second line
/// until it meets the first. It never pulls: from δ_0 on there is no force. Once the two have
/// parted, δ_0 is forgotten [WaltonBraun1986].
///
/// An impact without other forces has restitution e exactly, and pushes for
/// π/2 √(m*/K_1) (1 + e).
struct WaltonBraun {
  double loading_stiffness = 0;  ///< K_1 [N/m], above 0
  Restitution restitution = {};  ///< e [-] in (0, 1]

  template <int, class Real>
  struct History {
    Real deepest = 0;  ///< overlap that the contact has had [m]
  };

  void check() const {
    require_positive("WaltonBraun: loading_stiffness", loading_stiffness);
    restitution.check("WaltonBraun: restitution");
  }

  template <class C, class M>
  NormalForce<C> normal_force(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real K_1 = Real(loading_stiffness);
    const Real before = history.deepest;
    history.deepest = std::max(before, contact.overlap);
    // ∫ F dδ_0 along the first line.
    const Real plastic = K_1 * Real(stays()) * (squared(history.deepest) - squared(before)) / 2;
    return {.spring = spring_force(contact, history), .stiffness = K_1, .plastic = plastic};
  }

  /// What it would give back.
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return squared(double(spring_force(contact, history))) / (2 * unloading_stiffness());
  }

  /// K_2: the stiffer of the two counts.
  template <class C>
  Stiffness stiffness(const C&) const {
    return {.normal = unloading_stiffness()};
  }

  /// Springs in series (equal ones stay as they are), the lower restitution.
  static WaltonBraun mix(const WaltonBraun& a, const WaltonBraun& b) {
    return {.loading_stiffness = in_series(a.loading_stiffness, b.loading_stiffness),
            .restitution = Restitution::mix(a.restitution, b.restitution)};
  }

 private:
  double unloading_stiffness() const { return loading_stiffness / squared(restitution.value); }
  // δ_0/δ_deepest [-].
  double stays() const { return 1 - squared(restitution.value); }

  template <class C, class M>
  typename C::Real spring_force(const C& contact, const M& history) const {
    using Real = typename C::Real;
    const Real delta_0 = Real(stays()) * history.deepest;
    return std::max(Real(0), Real(unloading_stiffness()) * (contact.overlap - delta_0));
  }
};

}  // namespace silt::dem
