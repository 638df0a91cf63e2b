// SPDX-License-Identifier: MIT
// Settings of a flow.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/policy/outer_surface.hpp>
#include <silt/mps/scheme/scheme.hpp>

#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

namespace silt::mps {

/// Settings of a flow with the policies of a scheme. The constructor of the flow throws if one is
/// out of its range. All numbers are finite unless noted.
template <int Dim, class Scheme>
struct FlowSettings {
  static_assert(check_scheme<Scheme>());

  /// Particle spacing l0 [m], above 0. It must be the spacing at which the particles were created:
  /// the first step throws if it obviously is not. A periodic side must be an integer number of
  /// spacings long: the first step throws if a lattice of fluid does not fit.
  double spacing = 0;
  double density = 1000;    ///< ρ [kg/m³], above 0
  double viscosity = 1e-6;  ///< kinematic ν [m²/s], at least 0
  Vec<Dim> gravity = -9.81 * Vec<Dim>::Unit(Dim - 1);  ///< F [m/s²], along −y in 2D, −z in 3D
  /// re/l0 of n, free surface, gradient and divergence [-], above 1 and at most 10.
  double radius = 3.1;
  double laplacian_radius = 3.1;  ///< re/l0 of the Laplacian [-], above 1 and at most 10
  /// C [-]: Δt ≤ C l0 / maximum speed; above 0 and at most 1. A particle must not move by more than
  /// a spacing in a step; the references give no limit.
  double courant = 0.2;
  /// Expected speed, e.g. √(g H) [m/s], at least 0: Δt ≤ courant l0 / speed_scale.
  double speed_scale = 0;
  double max_growth = 1.2;  ///< Δt ≤ max_growth × previous Δt [-], at least 1; infinity: no limit
  double max_time_step = std::numeric_limits<double>::infinity();  ///< [s], above 0, or infinite
  bool clip_negative_pressure = true;  ///< P ← max(P, 0): no tensile stress in the fluid
  /// The policies with the scheme's parameters. A policy that is given here has the defaults of its
  /// own type, not the scheme's parameters.
  SourceOf<Scheme> source = Scheme{}.source;           ///< source term of the pressure equation
  SurfaceOf<Scheme> surface = Scheme{}.surface;        ///< criterion of the free surface
  CollisionOf<Scheme> collision = Scheme{}.collision;  ///< its reach is at most `radius`
  ShiftingOf<Scheme> shifting = Scheme{}.shifting;     ///< keeps particles evenly spaced
  FrictionOf<Scheme> friction = Scheme{}.friction;     ///< between particles
  WallStressOf<Scheme> wall_stress = Scheme{}.wall_stress;  ///< by the viscosity
  KernelOf<Scheme> kernel = Scheme{}.kernel;           ///< weights of the neighbours
  GradientOf<Scheme> gradient = Scheme{}.gradient;     ///< of the pressure
  WallsOf<Scheme> walls = Scheme{}.walls;              ///< how fluid and walls interact
  LaplacianOf<Scheme> laplacian = Scheme{}.laplacian;  ///< weights of the Laplacian
  /// Acceleration in addition to gravity [m/s²] at x [m] and time t [s]; called from several
  /// threads, on which the result must not depend. None if empty.
  std::function<Vec<Dim>(const Vec<Dim>& x, double t)> body_force = {};
  /// Pressure on the free surface [Pa] at x [m] and time t [s], such as that of openings, see
  /// PressureOpening; called like body_force. 0 if empty. It needs a scheme with an OuterSurface.
  /// Of a flow that it drives, speed_scale is √(2 p/ρ).
  std::function<double(const Vec<Dim>& x, double t)> surface_pressure = {};

  /// By what a checkpoint recognises another flow.
  std::vector<SetupPart> setup() const {
    std::vector<SetupPart> parts{{"FlowSettings::spacing", {spacing}},
                                 {"FlowSettings::density", {density}},
                                 {"FlowSettings::viscosity", {viscosity}},
                                 {"FlowSettings::gravity", {gravity.begin(), gravity.end()}},
                                 {"FlowSettings::radius", {radius, laplacian_radius}}};
    if constexpr (requires { walls.checksum(); }) {
      // Numbers that the tolerance tells apart.
      const std::uint64_t sum = walls.checksum();
      parts.push_back(
          {"FlowSettings::walls", {double(sum & 0xffffff), double(sum >> 24 & 0xffffff)}});
    }
    return parts;
  }

  /// Throws if a setting or a parameter of a policy is out of range, or if collisions reach farther
  /// than `radius`. body_force is checked in each step.
  void check() const {
    require_positive("FlowSettings: spacing", spacing);
    require_positive("FlowSettings: density", density);
    // 1/l0² is the scale of weights in single precision, the mass of a particle that of energies.
    const double mass = density * std::pow(spacing, Dim);
    if (spacing < 1e-12 || spacing > 1e12 || mass < 1e-200 || mass > 1e200) {
      fail({"FlowSettings: spacing = ", spacing, " m and density = ", density,
            " kg/m³ give weights and masses that underflow or overflow; use other units"});
    }
    require_not_negative("FlowSettings: viscosity", viscosity);
    require_finite("FlowSettings: gravity", gravity);
    if (!is_finite(gravity.squaredNorm())) {
      fail({"FlowSettings: gravity = ", to_text(gravity),
            " m/s² has a square that overflows; use other units"});
    }
    // At a radius of 1, the kernel is zero at the nearest neighbours.
    require_above("FlowSettings: radius", radius, {1 + 1e-9, 10});
    require_above("FlowSettings: laplacian_radius", laplacian_radius, {1 + 1e-9, 10});
    // TimeStep::begin() rejects steps in which a particle moves by more than a spacing.
    require_above("FlowSettings: courant", courant, {0, 1});
    require_not_negative("FlowSettings: speed_scale", speed_scale);
    if (!(max_growth >= 1)) {
      fail({"FlowSettings: max_growth = ", max_growth,
            " would only allow the time step to decrease; give a value of at least 1"});
    }
    if (!(max_time_step > 0)) {
      fail({"FlowSettings: max_time_step = ", max_time_step,
            " s must be positive; give a value above 0"});
    }
    if (surface_pressure && !HasOuterSurface<SurfaceOf<Scheme>>) {
      fail(
          "FlowSettings: surface_pressure is set, but the scheme has P = 0 at the particles of the "
          "free "
          "surface; use one with an OuterSurface, such as mps::Recommended");
    }
    const auto check = [](const auto& policy) {
      if constexpr (requires { policy.check(); }) policy.check();
    };
    check(source), check(collision), check(kernel), check(surface);
    check(gradient), check(walls), check(shifting), check(friction), check(wall_stress), check(laplacian);
    if (collision.reach() > radius) {
      fail({"Collision: distance = ", collision.reach(),
            " spacings exceeds FlowSettings: radius = ", radius,
            "; decrease the distance or increase the radius"});
    }
  }
};

}  // namespace silt::mps
