// SPDX-License-Identifier: MIT
// What the parts of a dem::Law are asked, and what they answer.
//
// A part is a plain struct with one of four functions. C is a Contact; a part that declares
// Memory<Dim, Real> gets what it remembers of the contact as the last argument.
//
//   normal_force(contact)               → NormalForce<C>
//   tangential_force(contact, normal)   → TangentialForce<C>
//   rolling_couple(contact, normal)     → RollingCouple<C>
//   adhesion_force(contact)             → Real, along the normal, below 0 where it pulls [N]
//
// It may also have
//
//   check()                             throws if a parameter is out of range
//   stiffness(contact)                  → Stiffness, of a normal part; of the two that come after
//   stiffness(contact, normal)            it: the Stiffness that they were given, with their own
//                                         put in
//   elastic_energy(contact)             [J], and the memory last, if there is one
//   mix(a, b)  (static)                 the part between two materials
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>

#include <concepts>
#include <type_traits>

namespace silt::dem {

/// Along the normal, seen from i.
template <class C>
struct NormalForce {
  using Real = typename C::Real;

  Real spring = 0;     ///< F_n [N], pushes above 0; friction and rolling resistance go by it
  Real dashpot = 0;    ///< D_n [N], likewise
  Real stiffness = 0;  ///< dF_n/dδ of the spring [N/m]
  Real beta = 0;       ///< dashpot over spring, c/k [s]
  Real plastic = 0;    ///< lost in this step by a spring that yields [J]
};

/// In the contact plane, on i.
template <class C>
struct TangentialForce {
  using Real = typename C::Real;
  using Vec = typename C::Vec;

  Vec spring = Vec::Zero();   ///< [N]
  Vec dashpot = Vec::Zero();  ///< [N]
  Real friction = 0;          ///< lost in this step by the slider [J]
};

/// On i, beside the moment of the force.
template <class C>
struct RollingCouple {
  using Real = typename C::Real;
  using AngularVec = typename C::AngularVec;

  AngularVec spring = zero_of<AngularVec>();   ///< [N m]
  AngularVec dashpot = zero_of<AngularVec>();  ///< [N m]
  Real friction = 0;               ///< lost in this step by the slider [J]
};

/// No part of this kind.
struct NoPart {};

/// The part remembers something of each contact.
template <class P, int Dim, class Real>
concept HasHistory = requires { typename P::template History<Dim, Real>; };

namespace detail {

// What a part remembers. Those that remember nothing share no type, so that they take no space
// beside one another in a struct.
template <class P, int Dim, class Real, int place>
struct PartHistory {
  struct type {};
};
template <class P, int Dim, class Real, int place>
  requires HasHistory<P, Dim, Real>
struct PartHistory<P, Dim, Real, place> {
  using type = typename P::template History<Dim, Real>;
};

// f(memory) for a part that remembers something, f() for one that does not.
template <class P, class C, class M, class F>
auto recalling(M& history, F&& f) {
  if constexpr (HasHistory<P, C::dimension, typename C::Real>) {
    return f(history);
  } else {
    return f();
  }
}

}  // namespace detail

template <class P, int Dim, class Real>
concept NormalPart =
    requires(const P part, const Contact<Dim, Real> c) {
      { part.normal_force(c) } -> std::convertible_to<NormalForce<Contact<Dim, Real>>>;
    } || requires(const P part, const Contact<Dim, Real> c,
                  typename P::template History<Dim, Real> history) {
      { part.normal_force(c, history) } -> std::convertible_to<NormalForce<Contact<Dim, Real>>>;
    };

template <class P, int Dim, class Real>
concept TangentialPart =
    requires(const P part, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n) {
      { part.tangential_force(c, n) } -> std::convertible_to<TangentialForce<Contact<Dim, Real>>>;
    } || requires(const P part, const Contact<Dim, Real> c,
                  const NormalForce<Contact<Dim, Real>> n,
                  typename P::template History<Dim, Real> history) {
      { part.tangential_force(c, n, history) } ->
          std::convertible_to<TangentialForce<Contact<Dim, Real>>>;
    };

template <class P, int Dim, class Real>
concept RollingPart =
    requires(const P part, const Contact<Dim, Real> c, const NormalForce<Contact<Dim, Real>> n) {
      { part.rolling_couple(c, n) } -> std::convertible_to<RollingCouple<Contact<Dim, Real>>>;
    } || requires(const P part, const Contact<Dim, Real> c,
                  const NormalForce<Contact<Dim, Real>> n,
                  typename P::template History<Dim, Real> history) {
      { part.rolling_couple(c, n, history) } ->
          std::convertible_to<RollingCouple<Contact<Dim, Real>>>;
    };

template <class P, int Dim, class Real>
concept AdhesionPart = requires(const P part, const Contact<Dim, Real> c) {
  { part.adhesion_force(c) } -> std::convertible_to<Real>;
} || requires(const P part, const Contact<Dim, Real> c,
              typename P::template History<Dim, Real> history) {
  { part.adhesion_force(c, history) } -> std::convertible_to<Real>;
};

namespace detail {

// Of which kind a part is, whatever dimension and precision it is for.
template <class P>
struct IsNormal
    : std::bool_constant<NormalPart<P, 3, double> || NormalPart<P, 2, double> ||
                         NormalPart<P, 3, float> || NormalPart<P, 2, float>> {};
template <class P>
struct IsTangential
    : std::bool_constant<TangentialPart<P, 3, double> || TangentialPart<P, 2, double> ||
                         TangentialPart<P, 3, float> || TangentialPart<P, 2, float>> {};
template <class P>
struct IsRolling
    : std::bool_constant<RollingPart<P, 3, double> || RollingPart<P, 2, double> ||
                         RollingPart<P, 3, float> || RollingPart<P, 2, float>> {};
template <class P>
struct IsAdhesion
    : std::bool_constant<AdhesionPart<P, 3, double> || AdhesionPart<P, 2, double> ||
                         AdhesionPart<P, 3, float> || AdhesionPart<P, 2, float>> {};

// The first of the parts that is of the kind, or NoPart.
template <template <class> class IsKind, class... Parts>
struct FirstOf : std::type_identity<NoPart> {};
template <template <class> class IsKind, class First, class... Rest>
struct FirstOf<IsKind, First, Rest...>
    : std::conditional_t<IsKind<First>::value, std::type_identity<First>,
                         FirstOf<IsKind, Rest...>> {};

// That part, if it is among them.
template <class Wanted, class First, class... Rest>
Wanted pick(const First& first, const Rest&... rest) {
  if constexpr (std::is_same_v<Wanted, First>) {
    return first;
  } else if constexpr (sizeof...(Rest) > 0) {
    return pick<Wanted>(rest...);
  } else {
    static_assert(std::is_same_v<Wanted, NoPart>, "silt::dem::Law: a part is missing");
    return {};
  }
}

template <class P, class C>
concept GivesStiffness = std::is_same_v<P, NoPart> || requires(const P part, const C contact) {
  { part.stiffness(contact) } -> std::convertible_to<Stiffness>;
} || requires(const P part, const C contact, const Stiffness normal) {
  { part.stiffness(contact, normal) } -> std::convertible_to<Stiffness>;
};

template <class P>
concept Mixes = std::is_same_v<P, NoPart> || requires(const P part) {
  { P::mix(part, part) } -> std::convertible_to<P>;
};

}  // namespace detail
}  // namespace silt::dem
