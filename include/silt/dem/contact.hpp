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

  Vec normal = Vec::Zero();  ///< unit vector, points the way i is pushed; −e of [SahChoi2004] (3)
  Real overlap = 0;  ///< δ = R_i + R_j − |x_j − x_i| [m], above 0; may tend to 0
  Vec relative_velocity = Vec::Zero();  ///< of i's surface against j's at the contact point, (5) [m/s]
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
  double beta = 0;        ///< dashpot over spring c/k [s], of a dashpot that sees v^{N−½}
};

/// A law without memory: force on i [N] from the contact alone.
template <class L, int Dim, class Real>
concept LawWithoutMemory = requires(const L law, const Contact<Dim, Real> contact) {
  { law.force(contact) } -> std::convertible_to<Vec<Dim, Real>>;
};

/// A law with memory: L::Memory<Dim, Real> lives as long as the contact, and starts as Memory{}.
template <class L, int Dim, class Real>
concept LawWithMemory = requires(const L law, const Contact<Dim, Real> contact,
                                 typename L::template Memory<Dim, Real> memory) {
  { law.force(contact, memory) } -> std::convertible_to<Vec<Dim, Real>>;
};

/// A struct with one `force(contact)` or `force(contact, memory)`, both const and without side
/// effects: it may also be asked beside others about a pair that does not touch, whose overlap and
/// normal are then any numbers, and what it answers is dropped. It may also have
///   check()                  throws if a parameter is out of range
///   stiffness(contact)       → Stiffness: then a default and a stable time step are known
///   elastic_energy(contact, memory)   [J] stored in the springs
///   mix(a, b)  (static)      the law between two materials
template <class L, int Dim, class Real>
concept ContactLaw = LawWithoutMemory<L, Dim, Real> || LawWithMemory<L, Dim, Real>;

/// What a law without memory remembers.
struct NoMemory {};

}  // namespace silt::dem
