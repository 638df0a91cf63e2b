// SPDX-License-Identifier: MIT
// What holds grains together that touch.
//
// Fine powders: of the two theories of adhesive spheres, DMT [DerjaguinMullerToporov1975]
// and JKR (Johnson, Kendall and Roberts 1971), Silt has the first. It is the one for grains that
// are small and stiff, as powders are; and its pull ends where the spheres part, at δ = 0, where
// contacts end in Silt. A neck of JKR's holds on beyond that.
//
// Cohesion along the tangent is another thing: LinearFriction::cohesion, c of (13).
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/dashpot.hpp>
#include <silt/dem/law_parts.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::dem {

namespace detail {
// A pull that begins and ends with a jump, where the two meet and part.
template <class C>
typename C::Real pull_while_touching(const C& contact, typename C::Real pull) {
  using Real = typename C::Real;
  const Real way_of_a_step = std::abs(contact.approach_speed()) * contact.time_step;
  return -pull * share_of_step(Real(contact.overlap), way_of_a_step);
}
}  // namespace detail

/// Pulls with 4 π γ R* as long as the two touch: what it takes to part them. With Hertz it is
/// DMT's contact, F = 4/3 E* √R* δ^{3/2} − 4 π γ R*.
struct DmtAdhesion {
  double surface_energy = 0;  ///< γ [J/m²] of one surface; the work of adhesion is 2 γ

  void check() const { require_not_negative("DmtAdhesion: surface_energy", surface_energy); }

  template <class C>
  typename C::Real adhesion_force(const C& contact) const {
    return detail::pull_while_touching(contact, pull_off(contact));
  }

  /// Nothing where they meet, and lower by what it takes to get there again.
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

/// Pulls with the same force whatever the radii, as long as the two touch.
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

  /// The smaller of both.
  static ConstantCohesion mix(const ConstantCohesion& a, const ConstantCohesion& b) {
    return {.pull = std::min(a.pull, b.pull)};
  }
};

}  // namespace silt::dem
