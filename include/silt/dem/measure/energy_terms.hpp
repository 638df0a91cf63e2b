// SPDX-License-Identifier: MIT
// The terms of the energy ledger: stored energies, work and dissipation.
#pragma once

#include <silt/dem/law/contact.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace silt::dem {

/// Energies at one time, all in [J].
struct Energies {
  double kinetic = 0;     ///< Σ ½ m v²
  double rotational = 0;  ///< Σ ½ I ω²
  double potential = 0;   ///< −Σ m g·x, zero at the origin; jumps when a grain crosses a periodic
                          ///< side along g
  ElasticEnergies elastic{};  ///< in the springs of contacts

  double sum() const { return kinetic + rotational + potential + elastic.sum(); }
};

/// Work done on the grains, by mechanism; negative: energy taken from them. All in [J].
struct Work {
  double normal_spring = 0;
  double tangential_spring = 0;
  double rolling_spring = 0;  ///< and twisting
  double adhesion = 0;
  double normal_dashpot = 0;
  double tangential_dashpot = 0;
  double rolling_dashpot = 0;
  double contact = 0;  ///< all contact forces of a law without components()
  double walls = 0;    ///< by moving walls
  double gravity = 0;
  double damping = 0;         ///< by the global damping of the integrator
  double removed_grains = 0;  ///< by grains removed in the step, on the remaining ones
  double other = 0;           ///< by forces unknown to the ledger

  double springs() const { return normal_spring + tangential_spring + rolling_spring + adhesion; }
  double sum() const {
    double sum = 0;
    for_each([&](double Work::* term) { sum += this->*term; });
    return sum;
  }
  /// max |term|
  double max_term() const {
    double maximum = 0;
    for_each([&](double Work::* term) { maximum = std::max(maximum, std::abs(this->*term)); });
    return maximum;
  }
  /// Adds `share` times others.
  void add(const Work& others, double share) {
    for_each([&](double Work::* term) { this->*term += share * (others.*term); });
  }

  /// f(pointer to member) for every term.
  template <class F>
  static void for_each(F&& f) {
    for (double Work::* const term :
         {&Work::normal_spring, &Work::tangential_spring, &Work::rolling_spring, &Work::adhesion,
          &Work::normal_dashpot, &Work::tangential_dashpot, &Work::rolling_dashpot, &Work::contact,
          &Work::walls, &Work::gravity, &Work::damping, &Work::removed_grains, &Work::other}) {
      f(term);
    }
  }
};

/// Energy lost from springs. All in [J], not below 0.
struct Losses {
  double friction = 0;          ///< dissipated by tangential sliders
  double rolling_friction = 0;  ///< dissipated by the sliders of rolling and twisting
  double plastic = 0;           ///< dissipated by yielding normal springs
  double separation = 0;        ///< stored in tangential and rolling springs when contacts ended

  double sum() const { return friction + rolling_friction + plastic + separation; }
  Losses& operator+=(const Losses& more) {
    friction += more.friction;
    rolling_friction += more.rolling_friction;
    plastic += more.plastic;
    separation += more.separation;
    return *this;
  }
};

}  // namespace silt::dem
