// SPDX-License-Identifier: MIT
// What a contact law sees: the geometry and motion of one contact, and nothing of storage.
#pragma once

#include <silt/core/types.hpp>

#include <concepts>

namespace silt::dem {

/// Contact of grain i with grain j or a wall, seen from i.
template <int Dim, class RealType>
struct Contact {
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  Vec normal = Vec::Zero();  ///< unit vector, points the way i is pushed; −e of [SahChoi2004] (3)
  Real overlap = 0;  ///< δ = R_i + R_j − |x_j − x_i| [m], above 0; may tend to 0
  Vec relative_velocity = Vec::Zero();  ///< of i's surface at the contact point against j's, (5)
                                        ///< [m/s]
  AngularVec relative_spin = zero_of<AngularVec>();  ///< ω_i − ω_j, for a law that gives a couple [1/s]
  Real effective_mass = 0;    ///< m* = m_i m_j / (m_i + m_j); at a wall m_i [kg]
  Real effective_radius = 0;  ///< R* = R_i R_j / (R_i + R_j); at a wall R_i [m]
  Real time_step = 0;         ///< Δt since the contact was last looked at [s]

  /// v_n of (6): positive while the two approach [m/s].
  Real approach_speed() const { return -relative_velocity.dot(normal); }
  /// v_s t of (7) [m/s].
  Vec tangential_velocity() const { return relative_velocity + approach_speed() * normal; }
};

/// Springs of a contact, for the stable time step.
struct Stiffness {
  double normal = 0;      ///< k_n [N/m]
  double tangential = 0;  ///< k_s [N/m]
  double beta = 0;  ///< dashpot over spring c/k of these two [s], of a dashpot that sees v^{N−½}
  double rolling = 0;          ///< couple over relative turn [N m/rad], in any direction
  double rolling_dashpot = 0;  ///< couple over relative spin [N m s], likewise
};

/// Energy that the springs of a contact hold [J].
struct ElasticEnergies {
  double normal = 0;
  double tangential = 0;
  double rolling = 0;   ///< and twisting
  double adhesion = 0;  ///< below 0: what it takes to pull the two apart

  double sum() const { return normal + tangential + rolling + adhesion; }
  ElasticEnergies& operator+=(const ElasticEnergies& more) {
    normal += more.normal;
    tangential += more.tangential;
    rolling += more.rolling;
    adhesion += more.adhesion;
    return *this;
  }
};

/// Of two materials: a pair of equal grains has the stiffness k, so each grain's own spring has
/// 2 k, and two of those act in series.
inline double in_series(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

/// The force on i by the mechanisms that make it, for the energy ledger.
template <int Dim, class RealType>
struct ForceComponents {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  Real normal_spring = 0;   ///< along the normal, pushes above 0 [N]
  Real normal_dashpot = 0;  ///< likewise
  Real adhesion = 0;        ///< likewise, so below 0 where it pulls
  Vec tangential_spring = Vec::Zero();   ///< [N]
  Vec tangential_dashpot = Vec::Zero();  ///< [N]
  Real plastic = 0;   ///< lost in this step by a spring that yields [J]
  Real friction = 0;  ///< lost in this step by the slider [J]

  Vec force(const Vec& normal) const {
    return (normal_spring + normal_dashpot + adhesion) * normal + tangential_spring +
           tangential_dashpot;
  }
};

/// The same with the couple on i, beside the moment of the force; on j acts the opposite. In 3D
/// what is along the normal resists twisting, the rest rolling.
template <int Dim, class RealType>
struct LoadComponents : ForceComponents<Dim, RealType> {
  using AngularVec = silt::AngularVec<Dim, RealType>;

  AngularVec rolling_spring = zero_of<AngularVec>();   ///< [N m]
  AngularVec rolling_dashpot = zero_of<AngularVec>();  ///< [N m]
  RealType rolling_friction = 0;           ///< lost in this step by the slider [J]

  AngularVec couple() const { return rolling_spring + rolling_dashpot; }
};

namespace detail {
template <class Answer, int Dim, class Real>
concept IsComponents = std::derived_from<Answer, ForceComponents<Dim, Real>>;
}  // namespace detail

/// A law that tells the force by its parts: components(contact) or components(contact, history) gives
/// ForceComponents, or LoadComponents if it also gives a couple.
template <class L, int Dim, class Real>
concept GivesComponents =
    requires(const L law, const Contact<Dim, Real> contact) {
      { law.components(contact) } -> detail::IsComponents<Dim, Real>;
    } || requires(const L law, const Contact<Dim, Real> contact,
                  typename L::template History<Dim, Real> history) {
      { law.components(contact, history) } -> detail::IsComponents<Dim, Real>;
    };

/// A law without memory: force on i [N] from the contact alone, whole or by its parts.
template <class L, int Dim, class Real>
concept LawWithoutHistory = requires(const L law, const Contact<Dim, Real> contact) {
  { law.force(contact) } -> std::convertible_to<Vec<Dim, Real>>;
} || requires(const L law, const Contact<Dim, Real> contact) {
  { law.components(contact) } -> detail::IsComponents<Dim, Real>;
};

/// A law with memory: L::Memory<Dim, Real> lives as long as the contact, and starts as Memory{}.
template <class L, int Dim, class Real>
concept LawWithHistory = requires(const L law, const Contact<Dim, Real> contact,
                                 typename L::template History<Dim, Real> history) {
  { law.force(contact, history) } -> std::convertible_to<Vec<Dim, Real>>;
} || requires(const L law, const Contact<Dim, Real> contact,
              typename L::template History<Dim, Real> history) {
  { law.components(contact, history) } -> detail::IsComponents<Dim, Real>;
};

/// A struct with one `force(contact)` or `force(contact, history)`, or with `parts` in its place,
/// const and without side effects: it may also be asked beside others about a pair that does not
/// touch, whose overlap and normal are then any numbers, and what it answers is dropped. It may
/// also have
///   check()                  throws if a parameter is out of range
///   stiffness(contact)       → Stiffness: then a default and a stable time step are known
///   elastic_energy(contact, history)   [J] stored in the springs
///   elastic_energies(contact, history)    → ElasticEnergies: the same by mechanisms
///   mix(a, b)  (static)      the law between two materials
template <class L, int Dim, class Real>
concept ContactLaw = LawWithoutHistory<L, Dim, Real> || LawWithHistory<L, Dim, Real>;

/// What a law answers about one contact: a force, or parts of one. The memory is none or one.
template <class Law, class C, class... History>
auto evaluate_law(const Law& law, const C& contact, History&... history) {
  if constexpr (requires { law.components(contact, history...); }) {
    return law.components(contact, history...);
  } else {
    return typename C::Vec(law.force(contact, history...));
  }
}

/// The force on i [N] in what a law answered about a contact of this normal.
template <int Dim, class Real>
Vec<Dim, Real> force_of(const Vec<Dim, Real>& answer, const Vec<Dim, Real>&) {
  return answer;
}
template <int Dim, class Real>
Vec<Dim, Real> force_of(const ForceComponents<Dim, Real>& answer, const Vec<Dim, Real>& normal) {
  return answer.force(normal);
}

/// The couple on i [N m], beside the moment of the force; 0 if the law gives none.
template <int Dim, class Real>
AngularVec<Dim, Real> couple_of(const Vec<Dim, Real>&) {
  return zero_of<AngularVec<Dim, Real>>();
}
template <int Dim, class Real>
AngularVec<Dim, Real> couple_of(const ForceComponents<Dim, Real>&) {
  return zero_of<AngularVec<Dim, Real>>();
}
template <int Dim, class Real>
AngularVec<Dim, Real> couple_of(const LoadComponents<Dim, Real>& answer) {
  return answer.couple();
}

/// The law gives a couple beside its force.
template <class L, int Dim, class Real>
concept GivesCouple =
    requires(const L law, const Contact<Dim, Real> contact) {
      { law.components(contact) } -> std::derived_from<LoadComponents<Dim, Real>>;
    } || requires(const L law, const Contact<Dim, Real> contact,
                  typename L::template History<Dim, Real> history) {
      { law.components(contact, history) } -> std::derived_from<LoadComponents<Dim, Real>>;
    };

/// What a law without memory remembers.
struct NoHistory {};

}  // namespace silt::dem
