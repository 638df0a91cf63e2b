// SPDX-License-Identifier: MIT
// One type for the contact laws of grains in a fluid, which Python chooses: to compile these with
// each law would take three times as long.
#pragma once

#include <silt/core/types.hpp>
#include <silt/dem/law/contact.hpp>
#include <silt/dem/law/cundall_strack.hpp>

#include "any_simulation.hpp"

#include <variant>

namespace silt::python {

/// Has the bits of the law that it is made from. Evaluates both of its laws and takes one: a branch
/// would keep the compiler from evaluating several contacts at once.
class AnyLaw {
 public:
  explicit AnyLaw(const ContactLaw& law) : is_elastic_(std::holds_alternative<HertzMindlin>(law)) {
    if (const auto* elastic = std::get_if<HertzMindlin>(&law)) elastic_ = *elastic;
    if (const auto* springs = std::get_if<dem::CundallStrack>(&law)) springs_ = *springs;
    if (const auto* linear = std::get_if<LinearLaw>(&law)) {
      // The same formulas.
      springs_ = {.normal_stiffness = linear->normal.normal_stiffness,
                  .tangential_stiffness = linear->tangential.tangential_stiffness,
                  .restitution = linear->normal.restitution,
                  .friction_angle = linear->tangential.friction_angle};
    }
  }

  /// That of HertzMindlin has room for that of each.
  template <int Dim, class Real>
  using History = HertzMindlin::History<Dim, Real>;

  template <class C, class M>
  auto components(const C& contact, M& history) const {
    auto of_springs = history_of_springs<C>(history);
    auto result = springs_.components(contact, of_springs);
    const auto elastic = elastic_.components(contact, history);
    const auto take = [&](auto& to, const auto& from) { to = choose(is_elastic_, from, to); };
    const auto take_vector = [&](auto& to, const auto& from) {
      for (int k = 0; k < C::dimension; ++k) take(to[k], from[k]);
    };
    take(result.normal_spring, elastic.normal_spring);
    take(result.normal_dashpot, elastic.normal_dashpot);
    take_vector(result.tangential_spring, elastic.tangential_spring);
    take_vector(result.tangential_dashpot, elastic.tangential_dashpot);
    take(result.friction, elastic.friction);
    take(of_springs.approach_speed, history.normal.approach_speed);
    take_vector(of_springs.tangential_force, history.tangential.force);
    history.normal.approach_speed = of_springs.approach_speed;
    history.tangential.force = of_springs.tangential_force;
    return result;
  }
  template <class C>
  dem::Stiffness stiffness(const C& contact) const {
    return is_elastic_ ? elastic_.stiffness(contact) : springs_.stiffness(contact);
  }
  template <class C, class M>
  dem::ElasticEnergies elastic_energies(const C& contact, const M& history) const {
    return is_elastic_ ? elastic_.elastic_energies(contact, history)
                       : springs_.elastic_energies(contact, history_of_springs<C>(history));
  }
  template <class C, class M>
  double elastic_energy(const C& contact, const M& history) const {
    return elastic_energies(contact, history).sum();
  }

 private:
  template <class C, class M>
  static auto history_of_springs(const M& history) {
    dem::OverlapForm::History<C::dimension, typename C::Real> own;
    own.approach_speed = history.normal.approach_speed;
    own.tangential_force = history.tangential.force;
    return own;
  }

  bool is_elastic_;
  // The one that is not taken has numbers that are in range.
  dem::CundallStrack springs_{.normal_stiffness = 1, .tangential_stiffness = 1};
  HertzMindlin elastic_{dem::Hertz{.elastic = {.young_modulus = 1, .poisson_ratio = 0}},
                        dem::Mindlin{.elastic = {.young_modulus = 1, .poisson_ratio = 0}}};
};

}  // namespace silt::python
