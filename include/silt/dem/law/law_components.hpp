// SPDX-License-Identifier: MIT
// The functions of the components of a dem::Law.
//
// A component is a plain struct with one of four functions. C is a Contact. A component that
// declares History<Dim, Real> receives the history of the contact as the last argument.
//
//   normal_force(contact)               → NormalForce<C>
//   tangential_force(contact, normal)   → TangentialForce<C>
//   rolling_couple(contact, normal)     → RollingCouple<C>
//   adhesion_force(contact)             → Real, along the normal, negative if attractive [N]
//
// It may also have
//
//   check()                             throws if a parameter is out of range
//   stiffness(contact)                  → Stiffness; normal component
//   stiffness(contact, stiffness)       → Stiffness; tangential and rolling component: the given
//                                         one with its own entries filled in
//   elastic_energy(contact)             → [J]; followed by the history, if there is one. Contacts
//                                         check the energy of a step only if all components but
//                                         that of adhesion have it
//   adhesion_energy(contact, history)   → [J], of NormalForce::adhesion; normal component
//   max_gap(effective_radius)           → the gap [m] at which a contact that has begun ends;
//                                         normal or adhesion component, not both. In a gap the
//                                         others get an overlap of 0
//   mix(a, b)  (static)                 → the component for a contact between two materials
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>

#include <cmath>
#include <concepts>
#include <type_traits>

namespace silt::dem {

/// Force on i along the normal.
template <class C>
struct NormalForce {
  using Real = typename C::Real;

  Real spring = 0;     ///< F_n [N], positive if repulsive; limits friction and rolling resistance
  Real dashpot = 0;    ///< D_n [N], positive if repulsive
  Real stiffness = 0;  ///< dF_n/dδ of the spring [N/m]
  Real beta = 0;       ///< ratio of dashpot to spring, c/k [s]
  Real plastic = 0;    ///< energy dissipated in this step by a yielding spring [J]
  Real adhesion = 0;   ///< besides the spring, negative if attractive; limits no friction [N]
  Real contact_radius = 0;  ///< of the contact area [m]; 0: √(R* δ)
};

/// Radius of the contact area of two spheres [m]: the given one of a NormalForce or Stiffness, or,
/// if that is 0, Hertz's √(R* δ).
template <class C>
typename C::Real contact_radius_of(const C& contact, const typename C::Real& given) {
  using std::sqrt;
  using Real = typename C::Real;
  return choose(given > 0, given, Real(sqrt(contact.effective_radius * contact.overlap)));
}

/// Force on i in the contact plane.
template <class C>
struct TangentialForce {
  using Real = typename C::Real;
  using Vec = typename C::Vec;

  Vec spring = Vec::Zero();   ///< [N]
  Vec dashpot = Vec::Zero();  ///< [N]
  Real friction = 0;          ///< energy dissipated in this step by the slider [J]
};

/// Couple on i, in addition to the moment of the force.
template <class C>
struct RollingCouple {
  using Real = typename C::Real;
  using AngularVec = typename C::AngularVec;

  AngularVec spring = zero_of<AngularVec>();   ///< [N m]
  AngularVec dashpot = zero_of<AngularVec>();  ///< [N m]
  Real friction = 0;                           ///< energy dissipated in this step by the slider [J]
};

/// Placeholder for a kind of component that the law does not have.
struct NoComponent {};

/// The component keeps a history of each contact.
template <class P, int Dim, class Real>
concept HasHistory = requires { typename P::template History<Dim, Real>; };

namespace detail {

// The history of a component. Components without a history have distinct empty types: only then
// do they take no space in a struct.
template <class P, int Dim, class Real, int slot>
struct ComponentHistory {
  struct type {};
};
template <class P, int Dim, class Real, int slot>
  requires HasHistory<P, Dim, Real>
struct ComponentHistory<P, Dim, Real, slot> {
  using type = typename P::template History<Dim, Real>;
};

// f(history) for a component with a history, f() for one without.
template <class P, class C, class M, class F>
auto with_history(M& history, F&& f) {
  if constexpr (HasHistory<P, C::dimension, typename C::Real>) {
    return f(history);
  } else {
    return f();
  }
}

}  // namespace detail

/// A component with normal_force(contact) → NormalForce, the force on i along the normal; see the
/// list in this file.
template <class P, int Dim, class Real>
concept NormalComponent =
    requires(const P p, const Contact<Dim, Real> c) {
      { p.normal_force(c) } -> std::convertible_to<NormalForce<Contact<Dim, Real>>>;
    } || requires(const P p, const Contact<Dim, Real> c,
                  typename P::template History<Dim, Real> history) {
      { p.normal_force(c, history) } -> std::convertible_to<NormalForce<Contact<Dim, Real>>>;
    };

/// A component with tangential_force(contact, normal force) → TangentialForce, on i in the contact
/// plane.
template <class P, int Dim, class Real>
concept TangentialComponent =
    requires(const P p, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n) {
      { p.tangential_force(c, n) } -> std::convertible_to<TangentialForce<Contact<Dim, Real>>>;
    } || requires(const P p, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n,
                  typename P::template History<Dim, Real> history) {
      {
        p.tangential_force(c, n, history)
      } -> std::convertible_to<TangentialForce<Contact<Dim, Real>>>;
    };

/// A component with rolling_couple(contact, normal force) → RollingCouple, on i in addition to the
/// moment of the force.
template <class P, int Dim, class Real>
concept RollingComponent =
    requires(const P p, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n) {
      { p.rolling_couple(c, n) } -> std::convertible_to<RollingCouple<Contact<Dim, Real>>>;
    } || requires(const P p, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n,
                  typename P::template History<Dim, Real> history) {
      { p.rolling_couple(c, n, history) } -> std::convertible_to<RollingCouple<Contact<Dim, Real>>>;
    };

/// A component with adhesion_force(contact) → force on i along the normal [N], negative if
/// attractive.
template <class P, int Dim, class Real>
concept AdhesionComponent =
    requires(const P p, const Contact<Dim, Real> c) {
      { p.adhesion_force(c) } -> std::convertible_to<Real>;
    } || requires(const P p, const Contact<Dim, Real> c,
                  typename P::template History<Dim, Real> history) {
      { p.adhesion_force(c, history) } -> std::convertible_to<Real>;
    };

/// A component whose contacts last beyond zero overlap.
template <class P>
concept HasMaxGap = requires(const P p, const double R) {
  { p.max_gap(R) } -> std::convertible_to<double>;
};

namespace detail {

/// The contact as a component of a law gets it: without a gap, unless the component has one.
template <bool has_gap, class C>
decltype(auto) contact_without_gap(const C& contact) {
  if constexpr (has_gap) {
    return (contact);
  } else {
    C touching = contact;
    touching.overlap = larger(typename C::Real(0), contact.overlap);
    return touching;
  }
}

// The kind of a component, for any dimension and precision that it supports.
template <class P>
struct IsNormal
    : std::bool_constant<NormalComponent<P, 3, double> || NormalComponent<P, 2, double> ||
                         NormalComponent<P, 3, float> || NormalComponent<P, 2, float>> {};
template <class P>
struct IsTangential
    : std::bool_constant<TangentialComponent<P, 3, double> || TangentialComponent<P, 2, double> ||
                         TangentialComponent<P, 3, float> || TangentialComponent<P, 2, float>> {};
template <class P>
struct IsRolling
    : std::bool_constant<RollingComponent<P, 3, double> || RollingComponent<P, 2, double> ||
                         RollingComponent<P, 3, float> || RollingComponent<P, 2, float>> {};
template <class P>
struct IsAdhesion
    : std::bool_constant<AdhesionComponent<P, 3, double> || AdhesionComponent<P, 2, double> ||
                         AdhesionComponent<P, 3, float> || AdhesionComponent<P, 2, float>> {};

// The first component of the kind, or NoComponent.
template <template <class> class IsKind, class... Components>
struct FirstOf : std::type_identity<NoComponent> {};
template <template <class> class IsKind, class First, class... Rest>
struct FirstOf<IsKind, First, Rest...>
    : std::conditional_t<IsKind<First>::value, std::type_identity<First>,
                         FirstOf<IsKind, Rest...>> {};

// The component of the type Wanted.
template <class Wanted, class First, class... Rest>
Wanted pick(const First& first, const Rest&... rest) {
  if constexpr (std::is_same_v<Wanted, First>) {
    return first;
  } else if constexpr (sizeof...(Rest) > 0) {
    return pick<Wanted>(rest...);
  } else {
    static_assert(std::is_same_v<Wanted, NoComponent>, "silt::dem::Law: a component is missing");
    return {};
  }
}

template <class P, class C>
concept GivesStiffness = std::is_same_v<P, NoComponent> || requires(const P p, const C contact) {
  { p.stiffness(contact) } -> std::convertible_to<Stiffness>;
} || requires(const P p, const C contact, const Stiffness normal) {
  { p.stiffness(contact, normal) } -> std::convertible_to<Stiffness>;
};

template <class P, class C>
concept GivesElasticEnergy =
    std::is_same_v<P, NoComponent> ||
    requires(const P p, const C contact) { p.elastic_energy(contact); } ||
    requires(const P p, const C contact,
             const typename P::template History<C::dimension, typename C::Real> history) {
      p.elastic_energy(contact, history);
    };

template <class P>
concept Mixes = std::is_same_v<P, NoComponent> || requires(const P p) {
  { P::mix(p, p) } -> std::convertible_to<P>;
};

}  // namespace detail
}  // namespace silt::dem
