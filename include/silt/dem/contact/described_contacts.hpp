// SPDX-License-Identifier: MIT
// What a program says about contacts: materials, walls and settings, for grains of any type.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/rows_of_four.hpp>
#include <silt/core/types.hpp>
#include <silt/dem/contact/contact_settings.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/materials.hpp>
#include <silt/dem/setup/grains.hpp>
#include <silt/dem/wall/walls.hpp>

#include <string>
#include <utility>

namespace silt::dem {

template <class P, class Law, class... Walls>
class ContactsOf;

/// Contacts between grains, and between grains and walls, with one law or one per pair of
/// materials. A wall is any type that models dem::Wall. A simulation of grains of type P stores
/// them as a ContactsOf<P, …>; for calls without a simulation see for_particles() in
/// core/concepts.hpp.
template <class Law, class... Walls>
class Contacts {
 public:
  /// Throws if a parameter of the law or of a wall is out of range.
  explicit Contacts(Law law, Walls... walls) : Contacts(Materials<Law>{law}, std::move(walls)...) {}
  explicit Contacts(Materials<Law> materials, Walls... walls)
      : materials_(std::move(materials)), walls_(std::move(walls)...) {
    for (Index w = 0; w < walls_.size(); ++w) {
      materials_.check(walls_.material(w), "of wall " + std::to_string(w));
    }
  }

  /// A copy with other settings. Throws if a setting is out of range.
  Contacts with(const ContactSettings& settings) const {
    settings.check();
    Contacts contacts = *this;
    contacts.settings_ = settings;
    return contacts;
  }

  /// Fails to compile, with a readable message, for particles that these contacts cannot act on.
  template <class P>
  static constexpr void explain() {
    static_assert(HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                            material_t>,
                  "silt::dem::Contacts: these particles lack a field of dem::Grains");
    static_assert(in_rows_with_radius<P, decltype(detail::mass_in_contacts<P>())>(),
                  "silt::dem::Contacts: these particles are not stored as dem::Grains; use "
                  "dem::Grains<Dim, Real, further_fields…>");
    static_assert(ContactLaw<Law, P::dimension, typename P::Real>,
                  "silt::dem::Contacts: the law has neither force(contact) nor force(contact, "
                  "history) that returns a vector, nor components() instead (see ContactLaw in "
                  "silt/dem/law/contact.hpp)");
    static_assert((Wall<Walls, P::dimension, typename P::Real> && ...),
                  "silt::dem::Contacts: a wall lacks nearest(x), material or check(), or has "
                  "another dimension or precision (see silt/dem/wall/wall.hpp), or its motion is "
                  "not a RigidMotion (see silt/dem/wall/moving.hpp)");
  }

  // See ForParticles in core/concepts.hpp.
  using Description = Contacts;
  template <class P>
    requires HasFields<P, velocity_t, spin_t, force_t, torque_t, mass_t, inertia_t, radius_t,
                       material_t> &&
                 ContactLaw<Law, P::dimension, typename P::Real> &&
                 (Wall<Walls, P::dimension, typename P::Real> && ...)
  using For = ContactsOf<P, Law, Walls...>;

 protected:
  Materials<Law> materials_;
  WallSet<Walls...> walls_;
  ContactSettings settings_;
};

}  // namespace silt::dem
