// SPDX-License-Identifier: MIT
// Settings of a flow.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/cases.hpp>

#include <functional>
#include <limits>

namespace silt::mps {

/// Settings of a flow; the parameters of a policy are in the member of its type.
template <int Dim, class Scheme>
struct FlowSettings {
  double spacing = 0;        ///< particle spacing l0 [m], above 0
  double density = 1000;     ///< ρ [kg/m³]
  double viscosity = 1e-6;   ///< kinematic ν [m²/s]
  Vec<Dim> gravity = -9.81 * Vec<Dim>::Unit(Dim - 1);  ///< F [m/s²]
  double radius = 3.1;            ///< re/l0 of n, free surface, gradient and divergence [-]
  double laplacian_radius = 3.1;  ///< re/l0 of the Laplacian [-]
  double courant = 0.2;           ///< Δt ≤ courant l0 / maximum speed [-]
  double speed_scale = 0;  ///< expected speed, e.g. √(g H) [m/s]: Δt ≤ courant l0 / speed_scale
  double max_growth = 1.2;  ///< Δt ≤ max_growth × previous Δt [-], at least 1
  double max_time_step = std::numeric_limits<double>::infinity();  ///< [s]
  bool clip_negative_pressure = true;  ///< P ← max(P, 0): no tensile stress in the fluid
  typename Scheme::Source source = {};
  typename Scheme::Surface surface = {};
  typename Scheme::Collision collision = {};
  typename Scheme::Shifting shifting = {};
  /// Acceleration in addition to gravity [m/s²] at x [m] and time t [s]; called from several
  /// threads, on which the result must not depend. None if empty.
  std::function<Vec<Dim>(const Vec<Dim>& x, double t)> body_force = {};

  /// Throws if a setting is out of range.
  void check() const {
    require_positive("FlowSettings: spacing", spacing);
    require_positive("FlowSettings: density", density);
    require_not_negative("FlowSettings: viscosity", viscosity);
    require_finite("FlowSettings: gravity", gravity);
    // At a radius of 1, the kernel is zero at the nearest neighbours.
    require_above("FlowSettings: radius", radius, {1 + 1e-9, 10});
    require_above("FlowSettings: laplacian_radius", laplacian_radius, {1 + 1e-9, 10});
    // TimeStep::begin() rejects steps in which a particle moves by more than a spacing.
    require_above("FlowSettings: courant", courant, {0, 1});
    require_not_negative("FlowSettings: speed_scale", speed_scale);
    if (!(max_growth >= 1)) {
      fail("FlowSettings: max_growth = " + to_text(max_growth) +
           " would only let the time step shrink; give a value of at least 1");
    }
    if (!(max_time_step > 0)) {
      fail("FlowSettings: max_time_step = " + to_text(max_time_step) +
           " s must be positive; give a value above 0");
    }
    source.check();
    surface.check();
    collision.check();
    shifting.check();
    if (collision.reach() > radius) {
      fail("Collision: distance = " + to_text(collision.reach()) +
           " spacings exceeds FlowSettings: radius = " + to_text(radius) +
           "; decrease the distance or increase the radius");
    }
  }
};

}  // namespace silt::mps
