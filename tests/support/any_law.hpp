// SPDX-License-Identifier: MIT
// Type erasure for contact laws, so that a test file instantiates one simulation for all of them,
// and all laws of the library with usual parameters.
#pragma once

#include <silt/dem/law/adhesion.hpp>
#include <silt/dem/law/capillary_bridge.hpp>
#include <silt/dem/law/composed_law.hpp>
#include <silt/dem/law/cundall_strack.hpp>
#include <silt/dem/law/hertz.hpp>
#include <silt/dem/law/jkr.hpp>
#include <silt/dem/law/law_history.hpp>
#include <silt/dem/law/linear_friction.hpp>
#include <silt/dem/law/linear_spring_dashpot.hpp>
#include <silt/dem/law/mindlin.hpp>
#include <silt/dem/law/mindlin_deresiewicz.hpp>
#include <silt/dem/law/plastic_cohesive.hpp>
#include <silt/dem/law/rolling_resistance.hpp>
#include <silt/dem/law/walton_braun.hpp>

#include <array>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace silt::test {

/// A law in double precision, evaluated one contact at a time.
template <int Dim>
class AnyLaw {
  using Contact = dem::Contact<Dim, double>;
  using Load = dem::LoadComponents<Dim, double>;
  static constexpr int words = 40;
  using Words = std::array<double, words>;

 public:
  /// That of the law, as numbers.
  template <int, class Real>
  struct History {
    std::array<Real, words> numbers{};

    template <class Archive>
    void transfer(Archive& archive) {
      archive("numbers", numbers);
    }
  };

  template <class Law>
    requires(!std::is_same_v<Law, AnyLaw>)
  explicit AnyLaw(const Law& law)
      : check_([law] { law.check(); }),
        components_([law](const Contact& contact, Words& numbers) {
          using OfLaw = dem::LawHistory<Law, Dim, double>;
          static_assert(OfLaw::words <= words);
          Load load;
          if constexpr (OfLaw::words == 0) {
            assign(load, law.components(contact));
          } else {
            auto own = OfLaw::from(numbers.data());
            assign(load, law.components(contact, own));
            OfLaw::put(own, numbers.data());
          }
          return load;
        }),
        energies_([law](const Contact& contact, const Words& numbers) {
          return law.elastic_energies(contact,
                                      dem::LawHistory<Law, Dim, double>::from(numbers.data()));
        }),
        stiffness_([law](const Contact& contact) { return law.stiffness(contact); }),
        max_gap_([law]([[maybe_unused]] double R) {
          if constexpr (dem::LastsBeyondTouch<Law, Dim, double>) {
            return law.max_gap(R);
          } else {
            return 0.0;
          }
        }) {}

  void check() const { check_(); }
  Load components(const Contact& contact, History<Dim, double>& history) const {
    return components_(contact, history.numbers);
  }
  dem::ElasticEnergies elastic_energies(const Contact& contact,
                                        const History<Dim, double>& history) const {
    return energies_(contact, history.numbers);
  }
  double elastic_energy(const Contact& contact, const History<Dim, double>& history) const {
    return elastic_energies(contact, history).sum();
  }
  dem::Stiffness stiffness(const Contact& contact) const { return stiffness_(contact); }
  double max_gap(double effective_radius) const { return max_gap_(effective_radius); }

 private:
  template <class Answer>
  static void assign(Load& load, const Answer& answer) {
    if constexpr (std::is_same_v<Answer, Load>) {
      load = answer;
    } else {
      static_cast<dem::ForceComponents<Dim, double>&>(load) = answer;
    }
  }

  std::function<void()> check_;
  std::function<Load(const Contact&, Words&)> components_;
  std::function<dem::ElasticEnergies(const Contact&, const Words&)> energies_;
  std::function<dem::Stiffness(const Contact&)> stiffness_;
  std::function<double(double)> max_gap_;
};

template <int Dim>
struct NamedLaw {
  std::string name;
  AnyLaw<Dim> law;
};

/// Every law and component of the library. With pebbles, all contacts last about as long.
template <int Dim>
std::vector<NamedLaw<Dim>> all_laws() {
  const dem::CundallStrack cundall_strack{.normal_stiffness = 1e6,
                                          .tangential_stiffness = 5e5,
                                          .restitution = 0.8,
                                          .friction_angle = 0.4};
  const dem::CundallStrackIncremental incremental{.normal_stiffness = 1e6,
                                                  .tangential_stiffness = 5e5,
                                                  .restitution = 0.8,
                                                  .friction_angle = 0.4};
  const dem::LinearSpringDashpot spring{.normal_stiffness = 1e6, .restitution = 0.8};
  const dem::LinearSpringDashpot limited{
      .normal_stiffness = 1e6, .restitution = 0.5, .limit_damping = true};
  const dem::WaltonBraun plastic{.loading_stiffness = 1e6, .restitution = 0.8};
  const dem::PlasticCohesive cohesive{
      .loading_stiffness = 1e6, .unloading_stiffness = 2e6, .cohesive_stiffness = 2e5};
  const dem::LinearFriction friction{.tangential_stiffness = 5e5, .friction_angle = 0.4};
  const dem::Elastic rubber{.young_modulus = 5e8, .poisson_ratio = 0.3};
  const dem::Hertz hertz{.elastic = rubber, .restitution = 0.8};
  const dem::Mindlin mindlin{.elastic = rubber, .friction_angle = 0.4};
  const dem::Mindlin displacement{
      .elastic = rubber, .friction_angle = 0.4, .keeps_displacement = true};
  const dem::MindlinDeresiewicz partial_slip{.elastic = rubber, .friction_angle = 0.4};
  const dem::Jkr jkr{.elastic = rubber, .surface_energy = 1, .restitution = 0.8};
  const dem::CapillaryBridge bridge{.surface_tension = 0.5, .contact_angle = 0.2, .volume = 1e-9};
  const dem::RollingResistance rolling{.rolling_friction = 0.2, .twisting_friction = 0.1};
  const auto law = [](const auto& any) { return AnyLaw<Dim>(any); };
  return {
      {"CundallStrack", law(cundall_strack)},
      {"CundallStrackIncremental", law(incremental)},
      {"LinearSpringDashpot", law(dem::Law{spring})},
      {"LinearSpringDashpot with limited damping and friction", law(dem::Law{limited, friction})},
      {"LinearSpringDashpot, friction and rolling resistance",
       law(dem::Law{spring, friction, rolling})},
      {"LinearSpringDashpot and cohesion",
       law(dem::Law{spring, dem::ConstantCohesion{.pull = 0.1}})},
      {"WaltonBraun and friction", law(dem::Law{plastic, friction})},
      {"PlasticCohesive and friction", law(dem::Law{cohesive, friction})},
      {"Hertz", law(dem::Law{hertz})},
      {"Hertz and Mindlin", law(dem::Law{hertz, mindlin})},
      {"Hertz and Mindlin by displacement", law(dem::Law{hertz, displacement})},
      {"Hertz, Mindlin and Deresiewicz", law(dem::Law{hertz, partial_slip})},
      {"Jkr and Mindlin", law(dem::Law{jkr, mindlin})},
      {"Hertz, Mindlin and liquid bridges", law(dem::Law{hertz, mindlin, bridge})},
      {"Hertz, Mindlin, rolling resistance and adhesion",
       law(dem::Law{hertz, mindlin, rolling, dem::DmtAdhesion{.surface_energy = 1}})},
  };
}

}  // namespace silt::test
