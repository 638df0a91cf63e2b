// SPDX-License-Identifier: MIT
// Adhesion between grains in contact.
//
// For fine powders there are two theories of adhesive spheres: DMT [DerjaguinMullerToporov1975] and
// JKR (Johnson, Kendall and Roberts 1971). Silt has DMT. It applies to small, stiff grains such as
// those of powders, and its force ends at δ = 0, where contacts in Silt end; the neck of JKR
// extends beyond δ = 0.
//
// Tangential cohesion is a different quantity: LinearFriction::cohesion, c of (13).
#pragma once

#include <silt/core/error.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/dashpot.hpp>
#include <silt/dem/law/law_components.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::dem {

namespace detail {
// The attractive force is discontinuous at the beginning and end of the contact.
template <class C>
typename C::Real pull_while_touching(const C& contact, typename C::Real pull) {
  using Real = typename C::Real;
  const Real change_per_step = std::abs(contact.approach_speed()) * contact.kick();
  return -pull * share_of_step(Real(contact.overlap), change_per_step);
}
}  // namespace detail

/// An attractive force 4 π γ R* while the contact lasts, equal to the pull-off force. With Hertz it
/// gives the contact of [DerjaguinMullerToporov1975], F = 4/3 E* √R* δ^{3/2} − 4 π γ R*.
struct DmtAdhesion {
  double surface_energy = 0;  ///< γ [J/m²] of one surface; the work of adhesion is 2 γ

  void check() const { check_magnitude_or_zero("DmtAdhesion: surface_energy", surface_energy); }

  template <class C>
  typename C::Real adhesion_force(const C& contact) const {
    return detail::pull_while_touching(contact, pull_off(contact));
  }

  /// 0 at δ = 0; otherwise minus the work needed to separate the two [J].
  template <class C>
  double elastic_energy(const C& contact) const {
    return -double(pull_off(contact)) * double(contact.overlap);
  }

  /// γ = √(γ_a γ_b), Berthelot's rule for dispersive surfaces.
  static DmtAdhesion mix(const DmtAdhesion& a, const DmtAdhesion& b) {
    return {.surface_energy = std::sqrt(a.surface_energy * b.surface_energy)};
  }

 private:
  // [N]
  template <class C>
  typename C::Real pull_off(const C& contact) const {
    return typename C::Real(4 * std::numbers::pi * surface_energy) * contact.effective_radius;
  }
};

/// A constant attractive force, independent of the radii, while the contact lasts.
struct ConstantCohesion {
  double pull = 0;  ///< [N]

  void check() const { require_not_negative("ConstantCohesion: pull", pull); }

  template <class C>
  typename C::Real adhesion_force(const C& contact) const {
    return detail::pull_while_touching(contact, typename C::Real(pull));
  }

  template <class C>
  double elastic_energy(const C& contact) const {
    return -pull * double(contact.overlap);
  }

  /// The smaller of the two.
  static ConstantCohesion mix(const ConstantCohesion& a, const ConstantCohesion& b) {
    return {.pull = std::min(a.pull, b.pull)};
  }
};

}  // namespace silt::dem
