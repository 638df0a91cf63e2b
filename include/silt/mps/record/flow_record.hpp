// SPDX-License-Identifier: MIT
// What a flow keeps from step to step.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/mps/fluid/body_force.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/step_changes.hpp>
#include <silt/mps/record/flow_energy.hpp>
#include <silt/mps/record/flow_watch.hpp>
#include <silt/mps/record/momentum_changes.hpp>
#include <silt/mps/record/time_step.hpp>
#include <silt/mps/wall/walls.hpp>

#include <cmath>

namespace silt::mps {

/// The last time step, the energies, and the speeds and heights that the fluid has had: they limit
/// the next step, and tell whether it went wrong. They are all that a checkpoint has of a flow
/// besides its settings. And the changes of momentum of the last step. In each step, begin_step(),
/// begin_changes(), find_momentum_changes() and end_step() are called in this order.
template <int Dim, class RealType>
class FlowRecord {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;

  /// `laplacian` is the stencil of the viscous term.
  template <class Settings, class Stencil>
  FlowRecord(const Settings& settings, const Stencil& laplacian)
      : viscous_limit_(viscous_limit(laplacian, settings.viscosity)),
        now_{.time_step = {},
             .energy = EnergyAccount<Dim, Real>(
                 {.mass = settings.density * std::pow(settings.spacing, Dim),
                  .gravity = settings.gravity.template cast<Real>()}),
             .watch = {}} {}

  /// Of the fluid after the last step, and the work since the first one.
  const FlowEnergy& energy() const noexcept { return now_.energy.energy(); }
  /// Kinetic and potential energy of the particles; no work.
  template <FluidParticles P>
  FlowEnergy energy_of(const P& particles) const {
    return now_.energy.of(particles);
  }
  /// Whether no step was begun before the present one, also in the run from which a checkpoint was
  /// read.
  bool is_first_step() const noexcept { return is_first_step_; }

  /// Those of the last step; empty if it was before a checkpoint was read.
  const Buffer<MomentumChange<Dim>>& momentum_changes() const noexcept {
    return momentum_changes_.all();
  }

  /// Time of the positions before the next step [s].
  void set_time(double time) noexcept { time_ = time; }
  /// Time of the positions [s].
  double time() const noexcept { return time_; }

  /// Limits of the next time step [s].
  template <FluidParticles P, class Settings>
  TimeStepLimits time_step_limits(const P& particles, const Settings& settings) const {
    return now_.time_step.limits(particles, settings, {.viscous = viscous_limit_, .time = time_});
  }

  /// Throws if the time step [s] is unstable: see TimeStep::begin().
  template <FluidParticles P, class Settings>
  void begin_step(const P& particles, const Settings& settings, double time_step) {
    is_first_step_ = now_.time_step.is_first();
    now_.time_step.begin(particles, settings, {.viscous = viscous_limit_, .time = time_},
                         time_step);
    now_.energy.begin(particles);
  }
  /// Before the step of this length [s] changes any velocity. The speed is that of the fastest wall
  /// [m/s].
  template <FluidParticles P>
  void begin_changes(const P& particles, const BodyForce<Dim, Real>& force, double time_step,
                     double speed_of_walls) {
    now_.watch.begin(particles, force, time_step, energy().kinetic, speed_of_walls);
  }
  /// With walls of faces, when these changes of the velocities are known, and before the particles are
  /// moved with them.
  template <FluidParticles P, class Operators>
  void find_momentum_changes(const P& particles, const Operators& operators,
                             const StepChanges<Vec>& changes) {
    if constexpr (AddsImages<typename Operators::Walls>) {
      momentum_changes_.find(particles, changes, operators.bulk_volumes());
    }
  }
  /// The work of the pressure on walls that move, in the step [J]; rise as in PressureRise.
  template <class Step, class Walls, class Rise>
  [[gnu::cold]] void find_work_of_walls(const Step& step, const Walls& walls, const Rise& rise) {
    work_of_walls_ = 0;
    if constexpr (MovesWalls<Walls>) {
      if (!walls.move()) return;
      const auto& particles = step.particles;
      const auto p = particles.with_ghosts(pressure);
      const double power = silt::detail::sum_of_all(
          particles, ordered_sum(particles.size(), 0.0,
                                 [&](Index i) { return walls.power(step.at(i), p, rise); }));
      const double volume = now_.energy.mass() / step.settings.density;
      work_of_walls_ = power * volume * step.time_step;
    }
  }
  /// After it made all changes and moved the particles.
  template <FluidParticles P>
  void end_step(const P& particles, const StepChanges<Vec>& changes,
                const BodyForce<Dim, Real>& force, double time_step) {
    now_.energy.end(particles, changes, force.values(), work_of_walls_, time_step);
    now_.watch.end(particles);
  }

  /// Throws if a particle moved by more than a spacing in the step.
  template <FluidParticles P, class Settings>
  void check_moves(const P& particles, const Settings& settings, const FinishedStep& step) const {
    now_.time_step.end(particles, settings, step);
  }
  /// Throws if the fluid gained speed or energy that nothing had: see FlowWatch.
  template <FluidParticles P, class Settings>
  void check_gains(const P& particles, const Settings& settings, const FinishedStep& step) const {
    now_.watch.check(particles, settings, energy().kinetic, now_.energy.mass(), step.time_step);
  }

  void save() noexcept {
    saved_ = now_;
    momentum_changes_.save();
  }
  void restore() noexcept {
    now_ = saved_;
    momentum_changes_.restore();
  }
  template <class Archive>
  void transfer(Archive& archive) {
    archive.within("time_step", [&] { now_.time_step.transfer(archive); });
    archive.within("energy", [&] { now_.energy.transfer(archive); });
    archive.within("watch", [&] { now_.watch.transfer(archive); });
    if constexpr (Archive::reads) momentum_changes_.clear();
  }

 private:
  struct State {
    TimeStep time_step;
    EnergyAccount<Dim, Real> energy;
    FlowWatch<Dim, Real> watch;
  };

  double viscous_limit_;  // of the time step [s]
  double time_ = 0;
  bool is_first_step_ = false;
  double work_of_walls_ = 0;  // in the step [J]
  State now_;
  State saved_;
  MomentumChanges<Dim> momentum_changes_;
};

}  // namespace silt::mps
