// SPDX-License-Identifier: MIT
// A single contact without grains, search or simulation: a law and two bodies.
#pragma once

#include <silt/dem/law/contact.hpp>

#include <algorithm>

namespace silt::test {

/// Two bodies in a head-on impact.
struct HeadOn {
  double mass = 1;      ///< m* [kg]
  double radius = 0.1;  ///< R* [m]
  double speed = 1;     ///< approach speed [m/s]
  double time_step = 0;  ///< [s]
  double phase = 0.5;   ///< fraction of a step between first contact and the next step [-]
};

struct Impact {
  double restitution = 0;
  double max_overlap = 0;  ///< [m]
  double max_force = 0;    ///< [N]
  double duration = 0;     ///< time during which the force was not 0 [s]
  double plastic = 0;    ///< plastic loss reported by the law [J]
};

/// Integrates one impact with leapfrog; no force acts before and after.
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
    const auto components = law.components(contact, history);
    const double F = double(components.force(contact.normal)[0]);
    v -= F / bodies.mass * dt;
    impact.max_overlap = std::max(impact.max_overlap, overlap);
    impact.max_force = std::max(impact.max_force, F);
    if (F != 0) impact.duration += dt;
    impact.plastic += double(components.plastic);
    overlap += v * dt;
  }
  impact.restitution = -v / bodies.speed;
  return impact;
}

}  // namespace silt::test
