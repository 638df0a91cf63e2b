// SPDX-License-Identifier: MIT
// The terms of the energy ledger: what stores energy, what does work, and where it is lost.
#pragma once

#include <silt/dem/contact.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace silt::dem {

/// At one time, all in [J].
struct Energies {
  double kinetic = 0;     ///< Σ ½ m v²
  double rotational = 0;  ///< Σ ½ I ω²
  double potential = 0;   ///< −Σ m g·x, zero at the origin; jumps when grains go round a period
                          ///< along g
  ElasticEnergies elastic{};  ///< in the springs of contacts

  double sum() const { return kinetic + rotational + potential + elastic.sum(); }
};

/// Done on the grains, by what did it; below 0: taken from them. All in [J].
struct Works {
  double normal_spring = 0;
  double tangential_spring = 0;
  double rolling_spring = 0;  ///< and twisting
  double adhesion = 0;
  double normal_dashpot = 0;
  double tangential_dashpot = 0;
  double rolling_dashpot = 0;
  double contact = 0;  ///< of a law that does not tell its force by parts: all of it
  double walls = 0;    ///< by walls that move
  double gravity = 0;
  double damping = 0;  ///< of the integrator: global damping
  double on_escape = 0;  ///< by grains that were removed in the step, on those that stayed
  double other = 0;    ///< by forces that the ledger does not know

  double springs() const { return normal_spring + tangential_spring + rolling_spring + adhesion; }
  double sum() const {
    double sum = 0;
    for_each([&](double Works::* term) { sum += this->*term; });
    return sum;
  }
  /// max |term|
  double largest() const {
    double most = 0;
    for_each([&](double Works::* term) { most = std::max(most, std::abs(this->*term)); });
    return most;
  }
  /// Adds `share` times others.
  void add(const Works& others, double share) {
    for_each([&](double Works::* term) { this->*term += share * (others.*term); });
  }

  /// f(pointer to member) for every term.
  template <class F>
  static void for_each(F&& f) {
    for (double Works::* const term :
         {&Works::normal_spring, &Works::tangential_spring, &Works::rolling_spring,
          &Works::adhesion, &Works::normal_dashpot, &Works::tangential_dashpot,
          &Works::rolling_dashpot, &Works::contact, &Works::walls, &Works::gravity,
          &Works::damping, &Works::on_escape, &Works::other}) {
      f(term);
    }
  }
};

/// Of the energy in springs, what they do not give back. All in [J], not below 0.
struct Losses {
  double friction = 0;          ///< by the slider along the tangent
  double rolling_friction = 0;  ///< by the sliders of rolling and twisting
  double plastic = 0;           ///< by normal springs that yield
  double opened = 0;  ///< what tangential and rolling springs held when their contact ended

  double sum() const { return friction + rolling_friction + plastic + opened; }
  Losses& operator+=(const Losses& more) {
    friction += more.friction;
    rolling_friction += more.rolling_friction;
    plastic += more.plastic;
    opened += more.opened;
    return *this;
  }
};

}  // namespace silt::dem
