// SPDX-License-Identifier: MIT
// The forces of a fluid on grains in it: −V ∇P, and drag.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/types.hpp>
#include <silt/coupled/drag.hpp>
#include <silt/coupled/grains_in_fluid.hpp>

#include <utility>

namespace silt::coupled {

/// Adds −V ∇P and the drag β (u' − v') of velocities at the end of the step, which is stable at any
/// time step:
///
///   m (v' − v) = Δt (F + β (u' − v')),   u' − u = Δt (a − D β (u' − v'))
///
/// F are all other forces: this part is the last one of Forces. a is the acceleration of the fluid
/// around the grain without the drag, D its mobility. u, a, D and ε are those that Coupled has set.
template <DragLaw Drag>
class FluidForces {
 public:
  /// The drag law with its parameters.
  explicit FluidForces(Drag drag) : drag_(std::move(drag)) {}
  // A copy is a trial, of which Leapfrog makes one in its first step: its impulses do not count.
  FluidForces(const FluidForces& other)
      : drag_(other.drag_),
        fluid_(other.fluid_),
        last_time_step_(other.last_time_step_),
        acted_for_(other.acted_for_),
        saved_(other.saved_) {}
  FluidForces(FluidForces&&) = default;
  FluidForces& operator=(const FluidForces& other) { return *this = FluidForces(other); }
  FluidForces& operator=(FluidForces&&) = default;
  ~FluidForces() = default;

  const Drag& drag() const noexcept { return drag_; }

  /// What all of the fluid has in common.
  struct Fluid {
    double density = 0;    ///< ρ [kg/m³]
    double viscosity = 0;  ///< μ = ρ ν [Pa s]
  };
  /// From now on, impulses are summed.
  void begin(const Fluid& fluid) {
    fluid_ = fluid;
    counts_ = true;
    acted_for_ = 0;
  }
  /// For how long forces have acted since then [s]: velocities are those at half steps.
  double acted_for() const noexcept { return acted_for_; }
  /// β of a grain [kg/s], with the share χ of it that is in the fluid.
  double coefficient(double diameter, double fluid_fraction, double speed, double immersed) const {
    return immersed * drag_.coefficient({.diameter = diameter,
                                         .fluid_fraction = fluid_fraction,
                                         .speed = speed,
                                         .density = fluid_.density,
                                         .viscosity = fluid_.viscosity});
  }
  /// A step that fails has not acted.
  void save() noexcept { saved_ = acted_for_; }
  void restore() noexcept { acted_for_ = saved_; }
  /// Called by Leapfrog, see DependsOnLastTimeStep.
  void set_last_time_step(double dt) { last_time_step_ = dt; }

  template <class P>
  typename P::Real reach(const P&) const {
    return 0;
  }
  template <class P>
  bool needs_search(const P&) const {
    return false;
  }

  template <class P>
  static constexpr void explain() {
    static_assert(ParticlesInFluid<P>,
                  "silt::coupled::FluidForces: the grains lack a field; use "
                  "coupled::GrainsInFluid<Dim>");
    static_assert(
        !ParticleSet<P> || holds_in_dimension<Drag, P::dimension>(),
        "silt::coupled::FluidForces: this drag law is of spheres, in 3D; in 2D, pass one of "
        "your own, per metre of depth, or NoDrag");
  }

  template <class P, class S>
    requires ParticlesInFluid<P>
  void accelerate(P& grains, S&, double dt, const Pass& pass = {}) {
    using Real = typename P::Real;
    using Vec = typename P::Vec;
    // Leapfrog changes velocities by the force times the time between the half steps.
    const Real kick = Real(last_time_step_ > 0 ? (last_time_step_ + dt) / 2 : dt);
    const Real end = Real(acted_for_) + kick;
    const auto u = std::as_const(grains)[fluid_velocity];
    const auto a = std::as_const(grains)[fluid_acceleration];
    const auto share = std::as_const(grains)[fluid_share];
    const auto immersed = std::as_const(grains)[immersion];
    const auto of_pressure = std::as_const(grains)[pressure_force];
    const auto mobility = std::as_const(grains)[fluid_mobility];
    const auto v = std::as_const(grains)[velocity];
    const auto m = std::as_const(grains)[mass];
    const auto R = std::as_const(grains)[radius];
    const auto impulse = grains[drag_impulse];
    const auto F = grains[force];
    for_each_in_pass(grains.size(), pass, [&](Index i) {
      if (!(immersed[i] > 0)) return;
      F[i] += of_pressure[i];
      const Vec relative = u[i] + end * a[i] - mobility[i] * impulse[i] - v[i];
      const Real beta = Real(coefficient(2 * double(R[i]), double(share[i]),
                                         double(relative.norm()), double(immersed[i])));
      const Vec drag =
          beta / (1 + kick * beta * (1 / m[i] + mobility[i])) * (relative - kick / m[i] * F[i]);
      F[i] += drag;
      if (counts_) impulse[i] += kick * drag;
    });
    acted_for_ += double(kick);
  }

 private:
  Drag drag_;
  Fluid fluid_;
  double last_time_step_ = 0;
  double acted_for_ = 0;
  double saved_ = 0;
  bool counts_ = false;
};

}  // namespace silt::coupled
