// SPDX-License-Identifier: MIT
// A contact law composed of components: one for the normal force and, optionally, one each for the
// tangential force, the rolling resistance and the adhesion.
//
//   dem::Law{dem::LinearSpringDashpot{.normal_stiffness = 1e6, .restitution = 0.9},
//            dem::LinearFriction{.tangential_stiffness = 8e5, .friction_angle = 0.3}}
//
// Components are given in any order and distinguished by their functions (see law_components.hpp).
// User-defined components can be combined with those of Silt.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/law_components.hpp>

#include <type_traits>

namespace silt::dem {

/// A ContactLaw of one to four components. The tangential and rolling components receive the normal
/// component's force. That force excludes adhesion: the friction limit depends on the spring alone.
template <class Normal, class Tangential = NoComponent, class Rolling = NoComponent,
          class Adhesion = NoComponent>
class Law {
  static_assert(detail::IsNormal<Normal>::value,
                "silt::dem::Law: no component has a normal_force(contact) or "
                "normal_force(contact, history) that returns a NormalForce "
                "(see silt/dem/law/law_components.hpp)");

  static_assert(
      !(HasMaxGap<Normal> && HasMaxGap<Adhesion>),
      "silt::dem::Law: the normal and the adhesion component both have max_gap(); a contact "
      "has a neck or a bridge, not both");

  template <class Component>
  static constexpr bool has = !std::is_same_v<Component, NoComponent>;
  template <class C, class... Components>
  static constexpr bool any_has_history =
      (HasHistory<Components, C::dimension, typename C::Real> || ...);
  static constexpr bool lasts = HasMaxGap<Normal> || HasMaxGap<Adhesion>;
  template <class C>
  static constexpr bool has_history = any_has_history<C, Normal, Tangential, Rolling, Adhesion>;

 public:
  Normal normal;
  [[no_unique_address]] Tangential tangential;
  [[no_unique_address]] Rolling rolling;
  [[no_unique_address]] Adhesion adhesion;

  /// The components, in any order.
  template <class... Components>
  Law(const Components&... components)
      : normal(detail::pick<Normal>(components...)),
        tangential(detail::pick<Tangential>(components...)),
        rolling(detail::pick<Rolling>(components...)),
        adhesion(detail::pick<Adhesion>(components...)) {
    static_assert(sizeof...(Components) == 1 + has<Tangential> + has<Rolling> + has<Adhesion>,
                  "silt::dem::Law: a component is neither normal, tangential, rolling nor "
                  "adhesion, or there are two of a kind (see silt/dem/law/law_components.hpp)");
  }

  /// The histories of all components; empty for those that have none. `Of` is the type of one, and
  /// there are `normal`, `tangential`, `rolling` and `adhesion`.
  template <int Dim, class Real>
  struct History {
    template <class Component, int slot>
    using Of = typename detail::ComponentHistory<Component, Dim, Real, slot>::type;

    [[no_unique_address]] Of<Tangential, 1> tangential{};
    [[no_unique_address]] Of<Rolling, 2> rolling{};
    [[no_unique_address]] Of<Normal, 0> normal{};
    [[no_unique_address]] Of<Adhesion, 3> adhesion{};

    template <class Archive>
    void transfer(Archive& archive) {
      archive("tangential", tangential);
      archive("rolling", rolling);
      archive("normal", normal);
      archive("adhesion", adhesion);
    }
  };

  /// Throws if a parameter of a component is out of range.
  void check() const {
    const auto check_one = [](const auto& component) {
      if constexpr (requires { component.check(); }) component.check();
    };
    check_one(normal);
    check_one(tangential);
    check_one(rolling);
    check_one(adhesion);
  }

  /// Returns ForceComponents, or LoadComponents if there is a rolling component.
  template <class C>
    requires(!has_history<C>)
  auto components(const C& contact) const {
    History<C::dimension, typename C::Real> nothing;
    return evaluate_components(contact, nothing);
  }
  template <class C, class M>
    requires(has_history<C>)
  auto components(const C& contact, M& history) const {
    return evaluate_components(contact, history);
  }

  /// See ContactLaw; of the component that has one.
  template <class Real>
  Real max_gap(const Real& effective_radius) const
    requires lasts
  {
    if constexpr (HasMaxGap<Normal>) {
      return normal.max_gap(effective_radius);
    } else {
      return adhesion.max_gap(effective_radius);
    }
  }

  /// Stiffness of all springs; available if every component provides its own.
  template <class C>
    requires detail::GivesStiffness<Normal, C> && detail::GivesStiffness<Tangential, C> &&
             detail::GivesStiffness<Rolling, C>
  Stiffness stiffness(const C& contact) const {
    Stiffness all = normal.stiffness(seen_by<Normal>(contact));
    [[maybe_unused]] const auto& touching = seen_by<NoComponent>(contact);
    if constexpr (has<Tangential>) all = tangential.stiffness(touching, all);
    if constexpr (has<Rolling>) all = rolling.stiffness(touching, all);
    return all;
  }

  /// All components but that of adhesion have elastic_energy().
  template <class C>
  static constexpr bool knows_springs =
      detail::GivesElasticEnergy<Normal, C> && detail::GivesElasticEnergy<Tangential, C> &&
      detail::GivesElasticEnergy<Rolling, C>;

  /// 0 for components without elastic_energy().
  template <class C, class M>
  ElasticEnergies elastic_energies(const C& contact, const M& history) const {
    if constexpr (has_history<C>) {
      return energies_of_components(contact, history);
    } else {
      return energies_of_components(contact, History<C::dimension, typename C::Real>{});
    }
  }
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return elastic_energies(contact, history).sum();
  }

  /// Mixes each pair of components with their own mix().
  static Law mix(const Law& a, const Law& b)
    requires detail::Mixes<Normal> && detail::Mixes<Tangential> && detail::Mixes<Rolling> &&
             detail::Mixes<Adhesion>
  {
    const auto mix_one = []<class Component>(const Component& of_a, const Component& of_b) {
      if constexpr (has<Component>) {
        return Component::mix(of_a, of_b);
      } else {
        return Component{};
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
  // The contact as this component gets it.
  template <class Component, class C>
  static decltype(auto) seen_by(const C& contact) {
    return detail::contact_without_gap < !lasts || HasMaxGap < Component >> (contact);
  }

  template <class C, class M>
  [[gnu::always_inline]] auto evaluate_components(const C& contact, M& history) const {
    using Real = typename C::Real;
    constexpr int Dim = C::dimension;
    std::conditional_t<has<Rolling>, LoadComponents<Dim, Real>, ForceComponents<Dim, Real>> result;

    const NormalForce<C> n = detail::with_history<Normal, C>(history.normal, [&](auto&... own) {
      return normal.normal_force(seen_by<Normal>(contact), own...);
    });
    result.normal_spring = n.spring;
    result.normal_dashpot = n.dashpot;
    result.plastic = n.plastic;
    result.adhesion = n.adhesion;
    if constexpr (has<Adhesion>) {
      result.adhesion =
          n.adhesion + detail::with_history<Adhesion, C>(history.adhesion, [&](auto&... own) {
            return adhesion.adhesion_force(seen_by<Adhesion>(contact), own...);
          });
    }
    [[maybe_unused]] const auto& touching = seen_by<NoComponent>(contact);
    if constexpr (has<Tangential>) {
      const TangentialForce<C> t = detail::with_history<Tangential, C>(
          history.tangential,
          [&](auto&... own) { return tangential.tangential_force(touching, n, own...); });
      result.tangential_spring = t.spring;
      result.tangential_dashpot = t.dashpot;
      result.friction = t.friction;
    }
    if constexpr (has<Rolling>) {
      const RollingCouple<C> r = detail::with_history<Rolling, C>(
          history.rolling,
          [&](auto&... own) { return rolling.rolling_couple(touching, n, own...); });
      result.rolling_spring = r.spring;
      result.rolling_dashpot = r.dashpot;
      result.rolling_friction = r.friction;
    }
    return result;
  }

  template <class C, class M>
  ElasticEnergies energies_of_components(const C& contact, const M& history) const {
    ElasticEnergies energies{.normal = energy_of(normal, contact, history.normal),
                             .tangential = energy_of(tangential, contact, history.tangential),
                             .rolling = energy_of(rolling, contact, history.rolling),
                             .adhesion = adhesion_energies(contact, history)};
    if constexpr (lasts) {
      C last = contact;
      last.overlap = -max_gap(contact.effective_radius);
      if (contact.overlap < 0) {
        energies.at_end =
            energy_of(normal, last, history.normal) + adhesion_energies(last, history);
      }
    }
    return energies;
  }

  // With the part of the normal component that is attraction.
  template <class C, class M>
  double adhesion_energies(const C& contact, const M& history) const {
    double energy = energy_of(adhesion, contact, history.adhesion);
    if constexpr (requires { normal.adhesion_energy(contact, history.normal); }) {
      energy += double(normal.adhesion_energy(contact, history.normal));
    }
    return energy;
  }

  template <class Component, class C, class M>
  static double energy_of(const Component& component, const C& contact, const M& history) {
    return detail::with_history<Component, C>(history, [&](const auto&... own) {
      if constexpr (requires { component.elastic_energy(contact, own...); }) {
        return double(component.elastic_energy(seen_by<Component>(contact), own...));
      } else {
        return 0.0;
      }
    });
  }
};

template <class... Components>
Law(const Components&...)
    -> Law<typename detail::FirstOf<detail::IsNormal, Components...>::type,
           typename detail::FirstOf<detail::IsTangential, Components...>::type,
           typename detail::FirstOf<detail::IsRolling, Components...>::type,
           typename detail::FirstOf<detail::IsAdhesion, Components...>::type>;

}  // namespace silt::dem
