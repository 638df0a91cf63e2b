// SPDX-License-Identifier: MIT
// Adhesion by a liquid bridge between moist spheres, which lasts beyond the contact until it
// ruptures.
#pragma once

#include <silt/core/cube_root.hpp>
#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/first_and_last_step.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace silt::dem {

/// A bridge of the volume V forms when two spheres touch, and pulls with
///
///   F = 2 π R γ cos θ / (1 + 1.05 s + 2.5 s²),  s = D √(R/V),  R = 2 R*,
///
/// where D is the gap, 0 while they touch, until it ruptures at D = (1 + θ/2) (V^⅓ + V^⅔/(10 R))
/// [WillettAdamsJohnsonSeville2000], with the harmonic mean of two radii for their radius of equal
/// spheres. At a wall of several elements, such as a mesh, the bridge ends where another element
/// becomes the nearest. The liquid has no viscosity, and is not used up.
struct CapillaryBridge {
  double surface_tension = 0;  ///< γ [N/m], above 0
  double contact_angle = 0;    ///< θ [rad] in [0, π/2)
  double volume = 0;           ///< V of each bridge [m³], above 0

  template <int, class Real>
  using History = StepsOfContact<Real>;

  void check() const {
    check_magnitude("CapillaryBridge: surface_tension", surface_tension);
    require_between("CapillaryBridge: contact_angle", contact_angle,
                    {0, std::numbers::pi / 2 - 1e-6});
    check_magnitude("CapillaryBridge: volume", volume);
  }

  template <class C, class M>
  typename C::Real adhesion_force(const C& contact, M& history) const {
    using Real = typename C::Real;
    const Real gap = max_gap(contact.effective_radius);
    const auto shares = history.next(contact, gap);
    return shares.of_beginning * pull_at(Real(0), contact) + shares.of_end * pull_at(gap, contact) -
           pull_at(gap_of(contact), contact);
  }

  /// Minus the work to pull the two apart to zero overlap, or that from there on [J].
  template <class C, class M>
  double elastic_energy(const C& contact, const M&) const {
    const double pull = double(pull_at(typename C::Real(0), contact));
    if (contact.overlap >= 0) return -pull * double(contact.overlap);
    const double per_length = double(per_gap(contact.effective_radius));
    const double s = double(gap_of(contact)) * per_length;
    const double root = std::sqrt(10 - squared(1.05));
    return pull / per_length * 2 / root *
           (std::atan((5 * s + 1.05) / root) - std::atan(1.05 / root));
  }

  /// The gap at which the bridge ruptures [m].
  template <class Real>
  Real max_gap(const Real& effective_radius) const {
    const double length = cube_root(volume);
    return Real((1 + contact_angle / 2) * length) * (1 + Real(length / 20) / effective_radius);
  }

  /// The smaller surface tension and contact angle, and the mean volume.
  static CapillaryBridge mix(const CapillaryBridge& a, const CapillaryBridge& b) {
    return {.surface_tension = std::min(a.surface_tension, b.surface_tension),
            .contact_angle = std::min(a.contact_angle, b.contact_angle),
            .volume = (a.volume + b.volume) / 2};
  }

 private:
  template <class C>
  static typename C::Real gap_of(const C& contact) {
    return larger(typename C::Real(0), typename C::Real(-contact.overlap));
  }
  // √(R/V) [1/m].
  template <class Real>
  Real per_gap(const Real& effective_radius) const {
    using std::sqrt;
    return sqrt(Real(effective_radius * Real(2 / volume)));
  }
  // [N]
  template <class C>
  typename C::Real pull_at(const typename C::Real& gap, const C& contact) const {
    using Real = typename C::Real;
    const Real s = gap * per_gap(contact.effective_radius);
    return Real(4 * std::numbers::pi * surface_tension * std::cos(contact_angle)) *
           contact.effective_radius / (1 + s * (Real(1.05) + Real(2.5) * s));
  }
};

}  // namespace silt::dem
