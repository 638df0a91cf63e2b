// SPDX-License-Identifier: MIT
// The forces of a fluid on grains in it: −V ∇P, drag, added mass and lift.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/fields.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/transfer.hpp>
#include <silt/core/types.hpp>
#include <silt/core/vectors.hpp>
#include <silt/coupled/drag.hpp>
#include <silt/coupled/grains_in_fluid.hpp>
#include <silt/coupled/work_on_grains.hpp>
#include <silt/dem/setup/grains.hpp>

#include <utility>
#include <vector>

namespace silt::coupled {

/// Of what the fluid does to grains besides drag.
struct FluidForceCoefficients {
  double added_mass = 0;  ///< Cₘ; 1/2 of a sphere, 1 of a disc [-]
  double lift = 0;  ///< C_L; 1/2 of a sphere in a weak shear without viscosity [Auton1987] [-]
};

/// Adds −V ∇P, and the drag β (u' − v') of velocities at the end of the step, which is stable at
/// any time step, with the added mass M = Cₘ ρ V and the lift L = C_L ρ V (u − v) × ω:
///
///   m (v' − v) = Δt (F + L + β (u' − v')) + M ((u' − u) − (v' − v))
///   u' − u = Δt (a − D β (u' − v'))
///
/// F are all other forces: this part is the last one of Forces. a is the acceleration of the fluid
/// around the grain without the drag, D its mobility. u, ω, a, D and ε are those that Coupled has
/// set; V is the immersed volume. β and L are those of v and of u with the impulses before the
/// step.
template <DragLaw Drag>
class FluidForces {
 public:
  /// The drag law with its parameters. Throws if a coefficient is not between 0 and 100.
  explicit FluidForces(Drag drag, const FluidForceCoefficients& coefficients = {})
      : drag_(std::move(drag)), coefficients_(coefficients) {
    constexpr Range plausible{0, 100};
    require_between("FluidForces: added_mass", coefficients.added_mass, plausible);
    require_between("FluidForces: lift", coefficients.lift, plausible);
  }
  // A copy is a trial, of which Leapfrog makes one in its first step: its impulses do not count.
  FluidForces(const FluidForces& other)
      : drag_(other.drag_),
        coefficients_(other.coefficients_),
        fluid_(other.fluid_),
        last_time_step_(other.last_time_step_),
        acted_for_(other.acted_for_),
        saved_(other.saved_),
        work_(other.work_),
        saved_work_(other.saved_work_) {}
  FluidForces(FluidForces&&) = default;
  FluidForces& operator=(const FluidForces& other) { return *this = FluidForces(other); }
  FluidForces& operator=(FluidForces&&) = default;
  ~FluidForces() = default;

  const Drag& drag() const noexcept { return drag_; }
  const FluidForceCoefficients& coefficients() const noexcept { return coefficients_; }

  /// What all of the fluid has in common.
  struct Fluid {
    double density = 0;    ///< ρ [kg/m³]
    double viscosity = 0;  ///< μ = ρ ν [Pa s]
  };
  /// From now on, impulses and work are summed.
  void begin(const Fluid& fluid) {
    fluid_ = fluid;
    counts_ = true;
    acted_for_ = 0;
    work_ = {};
  }
  /// Since then, if Leapfrog has no damping.
  const WorkOnGrains& work() const noexcept { return work_; }
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
  void save() noexcept {
    saved_ = acted_for_;
    saved_work_ = work_;
  }
  void restore() noexcept {
    acted_for_ = saved_;
    work_ = saved_work_;
  }
  /// Called by Leapfrog, see DependsOnLastTimeStep.
  void set_last_time_step(double dt) { last_time_step_ = dt; }

  /// For a checkpoint, see core/transfer.hpp: what identifies the law, by β in some conditions.
  template <class Archive>
  void transfer(Archive& archive) {
    std::vector<double> betas;
    for (const double fluid_fraction : {0.45, 0.7, 0.95}) {
      for (const double speed : {1e-4, 1e-2, 1.0}) {
        const double beta = drag_.coefficient({.diameter = 1e-2,
                                               .fluid_fraction = fluid_fraction,
                                               .speed = speed,
                                               .density = 1000,
                                               .viscosity = 1e-3});
        betas.push_back(is_finite(beta) ? beta : -1);
      }
    }
    archive.setup("forces", std::vector<SetupPart>{
                                {"FluidForces::drag", betas},
                                {"FluidForceCoefficients::added_mass", {coefficients_.added_mass}},
                                {"FluidForceCoefficients::lift", {coefficients_.lift}}});
  }

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
    const Real added_mass = Real(coefficients_.added_mass * fluid_.density);
    const Real lift = Real(coefficients_.lift * fluid_.density);
    const auto u = std::as_const(grains)[fluid_velocity];
    const auto a = std::as_const(grains)[fluid_acceleration];
    const auto vorticity = std::as_const(grains)[fluid_vorticity];
    const auto immersed = std::as_const(grains)[immersion];
    const auto share = std::as_const(grains)[fluid_share];
    const auto of_pressure = std::as_const(grains)[pressure_force];
    const auto mobility = std::as_const(grains)[fluid_mobility];
    const auto v = std::as_const(grains)[velocity];
    const auto m = std::as_const(grains)[mass];
    const auto R = std::as_const(grains)[radius];
    const auto impulse = grains[exchanged_impulse];
    const auto F = grains[force];
    const auto act_on = [&](Index i) {
      const Vec others = F[i];
      Vec exchanged = Vec::Zero(), change = kick / m[i] * others;
      // In a snapshot before the first step, the fluid around grains is not known.
      const bool acts = immersed[i] > 0 && share[i] > 0;
      if (acts) {
        F[i] += of_pressure[i];
        const Vec relative = u[i] + end * a[i] - mobility[i] * impulse[i] - v[i];
        // In each step: with that of the flow's whole step, light grains swing about their speed.
        const Real beta = Real(coefficient(2 * double(R[i]), double(share[i]),
                                           double(relative.norm()), double(immersed[i])));
        const Real volume = immersed[i] * Real(dem::volume_of<P::dimension>(double(R[i])));
        const Real M = added_mass * volume, inert = m[i] + M, moved = (1 - M * mobility[i]) / inert;
        const Vec further = M * a[i] - lift * volume * cross(vorticity[i], relative);
        const Vec drag = beta / (1 + kick * beta * (moved + mobility[i])) *
                         (relative - kick / inert * (F[i] + further));
        const Vec acceleration = (F[i] + further) / inert + moved * drag;
        change = kick * acceleration;
        exchanged = further + (1 - M * mobility[i]) * drag - M * acceleration;
        F[i] += exchanged;
        if (counts_) impulse[i] += kick * exchanged;
      }
      const Vec mean = v[i] + change / 2;
      WorkOnGrains work;
      work.by_pressure = acts ? double(kick * of_pressure[i].dot(mean)) : 0;
      work.by_exchange = double(kick * exchanged.dot(mean));
      work.by_others = double(kick * others.dot(mean));
      work.add_motion(double(kick * m[i]), mean);
      return work;
    };
    works_.resize((grains.size() + range_size - 1) / range_size);
    for_each_range(grains.size(), [&](Index first, Index last) {
      pass.before(first, last);
      WorkOnGrains work;
      for (Index i = first; i < last; ++i) work += act_on(i);
      pass.after(first, last);
      works_[first / range_size] = work;
    });
    for (const WorkOnGrains& each : works_) work_ += each;
    acted_for_ += double(kick);
  }

 private:
  Drag drag_;
  FluidForceCoefficients coefficients_;
  Fluid fluid_;
  double last_time_step_ = 0;
  double acted_for_ = 0;
  double saved_ = 0;
  WorkOnGrains work_, saved_work_;
  Buffer<WorkOnGrains> works_;  // of each range of grains, in a step
  bool counts_ = false;
};

}  // namespace silt::coupled
