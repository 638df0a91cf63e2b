// SPDX-License-Identifier: MIT
// A contact law put together from parts: what acts along the normal, and if wanted what acts along
// the tangent, what resists rolling, and what adheres.
//
//   dem::Law{dem::LinearSpringDashpot{.normal_stiffness = 1e6, .restitution = 0.9},
//            dem::LinearFriction{.tangential_stiffness = 8e5, .friction_angle = 0.3}}
//
// Each part is a policy of its own file, chosen by its type, in any order; what it must have stands
// in law_parts.hpp. A user's own stands beside ours.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/contact.hpp>
#include <silt/dem/law_parts.hpp>

#include <type_traits>

namespace silt::dem {

/// A ContactLaw of one to four parts. Those along the tangent and against rolling are told the
/// normal part's force; adhesion is not in it, so friction goes by how hard the spring presses.
template <class Normal, class Tangential = NoPart, class Rolling = NoPart, class Adhesion = NoPart>
class Law {
  static_assert(detail::IsNormal<Normal>::value,
                "silt::dem::Law: no part has a normal_force(contact) or normal_force(contact, "
                "memory) that gives a NormalForce (see silt/dem/law_parts.hpp)");

  template <class Part>
  static constexpr bool has = !std::is_same_v<Part, NoPart>;
  template <class C, class... Parts>
  static constexpr bool any_has_history =
      (HasHistory<Parts, C::dimension, typename C::Real> || ...);
  template <class C>
  static constexpr bool has_history = any_has_history<C, Normal, Tangential, Rolling, Adhesion>;

 public:
  Normal normal;
  [[no_unique_address]] Tangential tangential;
  [[no_unique_address]] Rolling rolling;
  [[no_unique_address]] Adhesion adhesion;

  /// The parts, in any order.
  template <class... Parts>
  Law(const Parts&... parts)
      : normal(detail::pick<Normal>(parts...)),
        tangential(detail::pick<Tangential>(parts...)),
        rolling(detail::pick<Rolling>(parts...)),
        adhesion(detail::pick<Adhesion>(parts...)) {
    static_assert(sizeof...(Parts) == 1 + has<Tangential> + has<Rolling> + has<Adhesion>,
                  "silt::dem::Law: a part is neither normal, tangential, rolling nor adhesion, or "
                  "there are two of a kind (see silt/dem/law_parts.hpp)");
  }

  /// What the parts remember, side by side.
  template <int Dim, class Real>
  struct History {
    template <class Part, int place>
    using Of = typename detail::PartHistory<Part, Dim, Real, place>::type;

    [[no_unique_address]] Of<Tangential, 1> tangential{};
    [[no_unique_address]] Of<Rolling, 2> rolling{};
    [[no_unique_address]] Of<Normal, 0> normal{};
    [[no_unique_address]] Of<Adhesion, 3> adhesion{};
  };

  /// Throws if a parameter of a part is out of range.
  void check() const {
    const auto check_one = [](const auto& part) {
      if constexpr (requires { part.check(); }) part.check();
    };
    check_one(normal);
    check_one(tangential);
    check_one(rolling);
    check_one(adhesion);
  }

  /// Gives ForceComponents, or LoadComponents if one of the parts resists rolling.
  template <class C>
    requires(!has_history<C>)
  auto components(const C& contact) const {
    History<C::dimension, typename C::Real> nothing;
    return answer_of_parts(contact, nothing);
  }
  template <class C, class M>
    requires(has_history<C>)
  auto components(const C& contact, M& history) const {
    return answer_of_parts(contact, history);
  }

  /// Of the springs of all parts; known if each tells its own.
  template <class C>
    requires detail::GivesStiffness<Normal, C> && detail::GivesStiffness<Tangential, C> &&
             detail::GivesStiffness<Rolling, C>
  Stiffness stiffness(const C& contact) const {
    Stiffness all = normal.stiffness(contact);
    if constexpr (has<Tangential>) all = tangential.stiffness(contact, all);
    if constexpr (has<Rolling>) all = rolling.stiffness(contact, all);
    return all;
  }

  /// Of parts that do not tell theirs, 0.
  template <class C, class M>
  ElasticEnergies elastic_energies(const C& contact, const M& history) const {
    if constexpr (has_history<C>) {
      return energies_of_parts(contact, history);
    } else {
      return energies_of_parts(contact, History<C::dimension, typename C::Real>{});
    }
  }
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return elastic_energies(contact, history).sum();
  }

  /// Part by part, as each says.
  static Law mix(const Law& a, const Law& b)
    requires detail::Mixes<Normal> && detail::Mixes<Tangential> && detail::Mixes<Rolling> &&
             detail::Mixes<Adhesion>
  {
    const auto mix_one = []<class Part>(const Part& of_a, const Part& of_b) {
      if constexpr (has<Part>) {
        return Part::mix(of_a, of_b);
      } else {
        return Part{};
      }
    };
    Law law = a;
    law.normal = mix_one(a.normal, b.normal);
    law.tangential = mix_one(a.tangential, b.tangential);
    law.rolling = mix_one(a.rolling, b.rolling);
    law.adhesion = mix_one(a.adhesion, b.adhesion);
    return law;
  }

 private:
  template <class C, class M>
  [[gnu::always_inline]] auto answer_of_parts(const C& contact, M& history) const {
    using Real = typename C::Real;
    constexpr int Dim = C::dimension;
    std::conditional_t<has<Rolling>, LoadComponents<Dim, Real>, ForceComponents<Dim, Real>> answer;

    const NormalForce<C> n = detail::recalling<Normal, C>(
        history.normal, [&](auto&... own) { return normal.normal_force(contact, own...); });
    answer.normal_spring = n.spring;
    answer.normal_dashpot = n.dashpot;
    answer.plastic = n.plastic;
    if constexpr (has<Adhesion>) {
      answer.adhesion = detail::recalling<Adhesion, C>(
          history.adhesion, [&](auto&... own) { return adhesion.adhesion_force(contact, own...); });
    }
    if constexpr (has<Tangential>) {
      const TangentialForce<C> t = detail::recalling<Tangential, C>(
          history.tangential,
          [&](auto&... own) { return tangential.tangential_force(contact, n, own...); });
      answer.tangential_spring = t.spring;
      answer.tangential_dashpot = t.dashpot;
      answer.friction = t.friction;
    }
    if constexpr (has<Rolling>) {
      const RollingCouple<C> r = detail::recalling<Rolling, C>(
          history.rolling, [&](auto&... own) { return rolling.rolling_couple(contact, n, own...); });
      answer.rolling_spring = r.spring;
      answer.rolling_dashpot = r.dashpot;
      answer.rolling_friction = r.friction;
    }
    return answer;
  }

  template <class C, class M>
  ElasticEnergies energies_of_parts(const C& contact, const M& history) const {
    return {.normal = energy_of(normal, contact, history.normal),
            .tangential = energy_of(tangential, contact, history.tangential),
            .rolling = energy_of(rolling, contact, history.rolling),
            .adhesion = energy_of(adhesion, contact, history.adhesion)};
  }

  template <class Part, class C, class M>
  static double energy_of(const Part& part, const C& contact, const M& history) {
    return detail::recalling<Part, C>(history, [&](const auto&... own) {
      if constexpr (requires { part.elastic_energy(contact, own...); }) {
        return double(part.elastic_energy(contact, own...));
      } else {
        return 0.0;
      }
    });
  }
};

template <class... Parts>
Law(const Parts&...)
    -> Law<typename detail::FirstOf<detail::IsNormal, Parts...>::type,
           typename detail::FirstOf<detail::IsTangential, Parts...>::type,
           typename detail::FirstOf<detail::IsRolling, Parts...>::type,
           typename detail::FirstOf<detail::IsAdhesion, Parts...>::type>;

}  // namespace silt::dem
