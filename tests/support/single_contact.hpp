// SPDX-License-Identifier: MIT
// One contact by itself, without grains, search or simulation: a law and two bodies that it pushes
// apart.
#pragma once

#include <silt/dem/contact.hpp>

#include <algorithm>

namespace silt::test {

/// Two bodies that meet head on.
struct HeadOn {
  double mass = 1;      ///< m* [kg]
  double radius = 0.1;  ///< R* [m]
  double speed = 1;     ///< at which they approach [m/s]
  double time_step = 0;  ///< [s]
  double phase = 0.5;   ///< where within a step they touch [-]
};

struct Impact {
  double restitution = 0;
  double deepest = 0;    ///< [m]
  double strongest = 0;  ///< force [N]
  double pushed = 0;     ///< time during which the force was not 0 [s]
  double plastic = 0;    ///< loss that the law tells [J]
};

/// Leapfrog through one impact; the bodies fly freely before and after.
template <int Dim, class Real, class Law>
Impact collide(const Law& law, const HeadOn& bodies) {
  dem::Contact<Dim, Real> contact;
  contact.normal = Vec<Dim, Real>::Unit(0);
  contact.effective_mass = Real(bodies.mass);
  contact.effective_radius = Real(bodies.radius);
  contact.time_step = Real(bodies.time_step);
  const double dt = bodies.time_step;
  double v = bodies.speed;
  double overlap = v * dt * bodies.phase;
  typename Law::template History<Dim, Real> history{};
  Impact impact;
  for (int step = 0; step < 1000000 && overlap > 0; ++step) {
    contact.overlap = Real(overlap);
    contact.relative_velocity = Real(-v) * contact.normal;
    const auto parts = law.components(contact, history);
    const double F = double(parts.force(contact.normal)[0]);
    v -= F / bodies.mass * dt;
    impact.deepest = std::max(impact.deepest, overlap);
    impact.strongest = std::max(impact.strongest, F);
    if (F != 0) impact.pushed += dt;
    impact.plastic += double(parts.plastic);
    overlap += v * dt;
  }
  impact.restitution = -v / bodies.speed;
  return impact;
}

}  // namespace silt::test
