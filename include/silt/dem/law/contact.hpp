// SPDX-License-Identifier: MIT
// The input and output of a contact law: geometry and motion of one contact, forces and couples.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/function_ref.hpp>
#include <silt/core/types.hpp>

#include <concepts>
#include <string>
#include <string_view>

namespace silt::dem {

/// Contact of grain i with grain j or a wall; vectors are those for i.
template <int Dim, class RealType>
struct Contact {
  static constexpr int dimension = Dim;
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using AngularVec = silt::AngularVec<Dim, Real>;

  Vec normal = Vec::Zero();             ///< unit vector from j to i; −e of [SahChoi2004] (3)
  Real overlap = 0;  ///< δ = R_i + R_j − |x_j − x_i| [m], above 0; may tend to 0;
                     ///< below 0 for a law with max_gap() only
  Vec relative_velocity = Vec::Zero();  ///< of i's surface relative to j's at the contact point,
                                        ///< (5) [m/s]
  AngularVec relative_spin = zero_of<AngularVec>();  ///< ω_i − ω_j, for laws with a couple [1/s]
  Real effective_mass = 0;    ///< m* = m_i m_j / (m_i + m_j); at a wall m_i [kg]
  Real effective_radius = 0;  ///< R* = R_i R_j / (R_i + R_j); at a wall R_i [m]
  /// Δt since the last evaluation [s]; 0 at time 0, when nothing has slipped: do not divide by it.
  Real time_step = 0;
  Real first_time_step = 0;  ///< at time 0, Δt of the first step; else 0 [s]

  /// v_n of (6): positive while the two approach [m/s].
  Real approach_speed() const { return -relative_velocity.dot(normal); }
  /// v_s t of (7) [m/s].
  Vec tangential_velocity() const { return relative_velocity + approach_speed() * normal; }
  /// Δt for which the force acts, if the step is as long as the last one [s].
  Real kick() const { return time_step + first_time_step; }
};

/// Springs of a contact, for the stable time step; all finite and not negative.
struct Stiffness {
  double normal = 0;      ///< k_n [N/m]
  double tangential = 0;  ///< k_s [N/m]
  double beta = 0;  ///< ratio of dashpot to spring c/k of both [s], for dashpots that use v^{N−½}
  double rolling = 0;          ///< couple per relative rotation, in any direction [N m/rad]
  double rolling_dashpot = 0;  ///< couple per relative spin, in any direction [N m s]
  double contact_radius = 0;   ///< of the contact area, see NormalForce [m]
};

namespace detail {
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_stiffness(
    const char* member, double value, const char* unit, FunctionRef<std::string()> contact,
    const Where& where) {
  fail({"dem::Contacts: stiffness(contact).", member, " = ", value, " ", unit,
        ", which the law returned for ", contact(),
        ", must be finite and not negative; correct the law"},
       where);
}
}  // namespace detail

/// Throws unless all members of a stiffness are finite and not negative. contact() describes the
/// contact for which the law returned it.
// Inlined, because it checks every contact of a new list.
[[gnu::always_inline]] inline void check_stiffness(const Stiffness& k,
                                                   FunctionRef<std::string()> contact,
                                                   const Where& where = {}) {
  const auto check = [&](const char* member, double value, const char* unit) {
    if (value >= 0 && is_finite(value)) return;
    detail::refuse_stiffness(member, value, unit, contact, where);
  };
  check("normal", k.normal, "N/m");
  check("tangential", k.tangential, "N/m");
  check("beta", k.beta, "s");
  check("rolling", k.rolling, "N m/rad");
  check("rolling_dashpot", k.rolling_dashpot, "N m s");
}

/// Energy stored in the springs of a contact, all in [J].
struct ElasticEnergies {
  double normal = 0;
  double tangential = 0;
  double rolling = 0;   ///< and twisting
  double adhesion = 0;  ///< minus the work needed to separate the two; above 0 in a gap
  double at_end = 0;    ///< of a contact in a gap: normal and adhesion when it ends, which is then
                        ///< lost; not in the sum

  /// Energy of all springs [J].
  double sum() const { return normal + tangential + rolling + adhesion; }
  ElasticEnergies& operator+=(const ElasticEnergies& more) {
    normal += more.normal;
    tangential += more.tangential;
    rolling += more.rolling;
    adhesion += more.adhesion;
    at_end += more.at_end;
    return *this;
  }
};

/// Throws unless a parameter, such as a stiffness, is from 1e-100 to 1e100 in its unit, so that the
/// product of two neither overflows nor underflows.
[[gnu::noinline]] inline void check_magnitude(std::string_view name, double value) {
  require_positive(name, value);
  require_between(name, value, {1e-100, 1e100});
}
/// The same, but the value may also be 0. Throws unless it is one of these.
[[gnu::noinline]] inline void check_magnitude_or_zero(std::string_view name, double value) {
  require_not_negative(name, value);
  if (value > 0) check_magnitude(name, value);
}

/// Stiffness between two materials, in the unit of both, such as [N/m]. k is the stiffness of a
/// pair of equal grains, so the spring of one grain has 2 k, and those of two grains act in series.
inline double in_series(double a, double b) { return a + b > 0 ? 2 * a * b / (a + b) : 0; }

/// The components of the force on i, for the energy ledger.
template <int Dim, class RealType>
struct ForceComponents {
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  Real normal_spring = 0;                ///< along the normal, positive if repulsive [N]
  Real normal_dashpot = 0;               ///< along the normal, positive if repulsive [N]
  Real adhesion = 0;                     ///< along the normal, negative if attractive [N]
  Vec tangential_spring = Vec::Zero();   ///< [N]
  Vec tangential_dashpot = Vec::Zero();  ///< [N]
  Real plastic = 0;   ///< energy dissipated in this step by a yielding spring [J]
  Real friction = 0;  ///< energy dissipated in this step by the slider [J]

  /// The force on i for the unit vector of its contact, its normal [N].
  Vec force(const Vec& normal) const {
    return (normal_spring + normal_dashpot + adhesion) * normal + tangential_spring +
           tangential_dashpot;
  }
};

/// ForceComponents and the couple on i, in addition to the moment of the force; the opposite couple
/// acts on j. In 3D its component along the normal resists twisting, the rest rolling.
template <int Dim, class RealType>
struct LoadComponents : ForceComponents<Dim, RealType> {
  using AngularVec = silt::AngularVec<Dim, RealType>;

  AngularVec rolling_spring = zero_of<AngularVec>();   ///< [N m]
  AngularVec rolling_dashpot = zero_of<AngularVec>();  ///< [N m]
  RealType rolling_friction = 0;  ///< energy dissipated in this step by the sliders [J]

  /// The couple on i [N m].
  AngularVec couple() const { return rolling_spring + rolling_dashpot; }
};

namespace detail {
/// law.force(contact) or law.components(contact), with the history as second argument if there is
/// one.
template <class L, class C, class... History>
concept Evaluates = requires(const L law, const C contact, History... history) {
  { law.force(contact, history...) } -> std::convertible_to<typename C::Vec>;
} || requires(const L law, const C contact, History... history) {
  {
    law.components(contact, history...)
  } -> std::derived_from<ForceComponents<C::dimension, typename C::Real>>;
};

template <class L, class C, class Components>
concept Returns =
    requires(const L law, const C contact) {
      { law.components(contact) } -> std::derived_from<Components>;
    } || requires(const L law, const C contact,
                  typename L::template History<C::dimension, typename C::Real> history) {
      { law.components(contact, history) } -> std::derived_from<Components>;
    };
}  // namespace detail

/// A law that returns its force by components: components(contact) or components(contact, history)
/// → ForceComponents, or LoadComponents if there is also a couple.
template <class L, int Dim, class Real>
concept GivesComponents = detail::Returns<L, Contact<Dim, Real>, ForceComponents<Dim, Real>>;

/// The law returns a couple in addition to its force.
template <class L, int Dim, class Real>
concept GivesCouple = detail::Returns<L, Contact<Dim, Real>, LoadComponents<Dim, Real>>;

/// A law without history: the force on i [N] depends on the contact only; as one vector or by
/// components.
template <class L, int Dim, class Real>
concept LawWithoutHistory = detail::Evaluates<L, Contact<Dim, Real>>;

/// A law with history: a L::History<Dim, Real> is kept while the contact lasts; it begins as
/// History{}.
template <class L, int Dim, class Real>
concept LawWithHistory =
    detail::Evaluates<L, Contact<Dim, Real>, typename L::template History<Dim, Real>>;

/// A struct with `force(contact)` or `force(contact, history)`, or `components` instead of `force`.
/// The function is const and has no side effects: when several contacts are evaluated at once, it
/// may also be called for a pair that does not touch. Overlap and normal are then arbitrary, and
/// the result is discarded. Optional members:
///
///   check()                  throws if a parameter is out of range
///   stiffness(contact)       → Stiffness; provides the default and the stable time step
///   elastic_energy(contact, history)     → [J], stored in the springs
///   elastic_energies(contact, history)   → ElasticEnergies, the same by components; with
///                            components(), a step in which contacts give far more is refused, see
///                            ContactSettings::max_energy_gain
///   max_gap(effective_radius)            → the gap [m] at which a contact that has begun ends; a
///                            function of R* without a maximum between its ends. Without it
///                            contacts end at zero overlap, where they begin in any case
///   mix(a, b)  (static)      → the law between two materials
template <class L, int Dim, class Real>
concept ContactLaw = LawWithoutHistory<L, Dim, Real> || LawWithHistory<L, Dim, Real>;

/// A law whose contacts last beyond zero overlap, as a neck or a liquid bridge does.
template <class L, int Dim, class Real>
concept LastsBeyondTouch = LawWithHistory<L, Dim, Real> && requires(const L law, const Real R) {
  { law.max_gap(R) } -> std::convertible_to<Real>;
};

/// The result of a law for one contact: a force, or its components. There is one history or none.
template <class Law, class C, class... History>
auto evaluate_law(const Law& law, const C& contact, History&... history) {
  if constexpr (requires { law.components(contact, history...); }) {
    return law.components(contact, history...);
  } else {
    return typename C::Vec(law.force(contact, history...));
  }
}

/// The force on i [N] from the result of a law for a contact with this normal.
template <int Dim, class Real>
Vec<Dim, Real> force_of(const Vec<Dim, Real>& answer, const Vec<Dim, Real>&) {
  return answer;
}
template <int Dim, class Real>
Vec<Dim, Real> force_of(const ForceComponents<Dim, Real>& answer, const Vec<Dim, Real>& normal) {
  return answer.force(normal);
}

/// The couple on i [N m], in addition to the moment of the force; 0 if the law has none.
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

/// History of a law without history.
struct NoHistory {};

}  // namespace silt::dem
