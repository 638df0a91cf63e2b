// SPDX-License-Identifier: MIT
// The interaction of MPS, [HwangLeePark2010]: predictor, collision, pressure, corrector, in the
// order of SemiImplicit.
#pragma once

#include <silt/core/buffer.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/fluid/body_force.hpp>
#include <silt/mps/fluid/fluid.hpp>
#include <silt/mps/fluid/mixture.hpp>
#include <silt/mps/fluid/step_changes.hpp>
#include <silt/mps/policy/friction.hpp>
#include <silt/mps/pressure/flow_pressure.hpp>
#include <silt/mps/pressure/pressure_rise.hpp>
#include <silt/mps/record/flow_energy.hpp>
#include <silt/mps/record/flow_record.hpp>
#include <silt/mps/record/flow_seconds.hpp>
#include <silt/mps/record/momentum_changes.hpp>
#include <silt/mps/record/time_step.hpp>
#include <silt/mps/scheme/flow_settings.hpp>
#include <silt/mps/scheme/scheme.hpp>
#include <silt/mps/setup/arrangement.hpp>
#include <silt/mps/step/advection.hpp>
#include <silt/mps/step/moves_before_walls.hpp>
#include <silt/mps/view/close_pairs.hpp>
#include <silt/mps/view/flow_operators.hpp>
#include <silt/mps/view/particle_view.hpp>

#include <string>
#include <utility>

namespace silt::mps {

/// Incompressible flow in Dim dimensions [HwangLeePark2010] with the policies of a Scheme, such as
/// mps::Case10; Solver solves the pressure equation.
template <class Scheme, int Dim, class RealType, LinearSolver Solver>
class BasicFlow {
  static_assert(check_scheme<Scheme>());

 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Settings = FlowSettings<Dim, Scheme>;
  /// Its state is that of the fluid as a whole.
  static constexpr bool remembers_particles = false;
  static constexpr bool needs_moved_particles = SourceOf<Scheme>::needs_moved_particles;

  /// Throws if a setting, also of the solver, is out of range.
  explicit BasicFlow(const Settings& settings, Solver solver = {})
      : settings_(checked(settings)),
        operators_(settings_),
        force_(settings_.gravity.template cast<Real>()),
        friction_(settings_.friction),
        pressure_(settings_.source, std::move(solver)),
        record_(settings_, operators_.laplacian_stencil()) {}

  const Settings& settings() const noexcept { return settings_; }
  /// Iterations and residual of the last pressure solve.
  const SolveReport& last_solve() const noexcept { return pressure_.report(); }
  /// Energy after the last step, and the work since the first step.
  const FlowEnergy& energy() const noexcept { return record_.energy(); }
  /// Kinetic and potential energy of the particles, also before the first step.
  template <FluidParticles P>
  FlowEnergy energy_of(const P& particles) const {
    return record_.energy_of(particles);
  }
  /// The stencil of density, gradient and divergence.
  const auto& stencil() const noexcept { return operators_.stencil(); }
  /// Wall-clock time by stage.
  const FlowSeconds& seconds() const noexcept { return seconds_; }
  /// The walls as the flow sees them.
  const auto& walls() const noexcept { return operators_.walls(); }
  /// Those of the last step with walls of faces, for WallLoad; otherwise empty.
  const Buffer<MomentumChange<Dim>>& momentum_changes() const noexcept {
    return record_.momentum_changes();
  }
  /// Force [N] and torque [N m] of the fluid on each group of walls that moves, then on each body,
  /// in the last step, whose length is given [s]: see WallMover::loads(). In 2D per metre of depth.
  template <FluidParticles P>
  auto loads_on_moving_walls(const P& particles, double time_step) const {
    return walls().loads_on_moving(particles, momentum_changes(), settings_, time_step);
  }
  double seconds_in_pressure() const noexcept { return seconds_.pressure; }  ///< [s], wall time

  /// Interaction range: the larger of the two effective radii [m].
  template <FluidParticles P>
  Real reach(const P&) const {
    return operators_.reach();
  }

  /// How far particles are moved before their neighbours are found again [m], see check_step().
  double max_move_within_step() const noexcept {
    return needs_moved_particles ? settings_.spacing : 0;
  }

  /// Adds the work of each particle in units of that of a dummy, which has no neighbours, see
  /// mpi/work.hpp. Returns false, and adds nothing, if neighbours are not known.
  template <FluidParticles P>
  bool add_work(const P& particles, std::span<double> work) const {
    const auto& neighbours = operators_.neighbourhood();
    if (!neighbours.has_rows_of(particles)) return false;
    for (Index i = 0; i < work.size(); ++i) work[i] += double(neighbours[i].size());
    return true;
  }

  /// Limits of the next time step [s]. Throws if a velocity is not finite, or if walls would need endless
  /// steps.
  template <FluidParticles P>
  TimeStepLimits time_step_limits(const P& particles) const {
    TimeStepLimits limits = record_.time_step_limits(particles, settings_);
    limits.walls = operators_.longest_step(record_.time(), settings_.courant * settings_.spacing);
    limits.check_walls();
    return limits;
  }
  template <FluidParticles P>
  double time_step(const P& particles) const {
    return time_step_limits(particles).smallest();
  }

  /// What makes the time step as short as it is.
  template <FluidParticles P>
  [[gnu::cold]] std::string limit_of_time_step(const P& particles) const {
    return "mps::Flow: " + time_step_limits(particles).name_of_smallest();
  }

  /// Sets the time of the positions [s], at which FlowSettings::body_force is evaluated.
  void set_time(double time) { record_.set_time(time); }

  /// u* = u + Δt (ν∇²u + F)      (8), with the stress of walls, and friction
  /// Throws if Δt is unstable: see TimeStep::begin(). The first step throws if the particles do not
  /// fit the spacing, or the walls do not hold them: see mps/setup/arrangement.hpp.
  template <FluidParticles P, class S>
  void predict(P& particles, const S& search, double time_step) {
    static_assert(P::dimension == Dim, "mps::Flow: the particles have another dimension");
    begin_step(particles, search, time_step);
    const auto step = view(particles, time_step);
    pressure_.begin(step);
    const Real dt = Real(time_step);
    const double nu = settings_.viscosity;
    find_changes(particles, changes_.predictor, [&](Index i) -> Vec {
      Vec change = dt * force_[i];
      if (nu > 0) change += settings_.wall_stress.velocity_change(step.at(i), nu);
      return change;
    });
    if constexpr (needs_wall_stress) {
      if (nu > 0) {
        find_changes(particles, changes_.wall_stress, [&](Index i) -> Vec {
          if (!operators_.walls().are_near(i)) return Vec::Zero();
          return part_of_walls(step.at(i), nu, Vec(changes_.predictor[i] - dt * force_[i]));
        });
      }
    }
    if constexpr (HasFriction<FrictionOf<Scheme>>) {
      find_friction(friction_, step, changes_.friction);
      apply_changes(changes_.friction, particles, velocity);
    }
    apply_changes(changes_.predictor, particles, velocity);
  }

  /// r* = r + Δt u*, for sources that need moved particles: the original MPS.
  template <FluidParticles P>
  void advect(P& particles, double time_step) {
    advection_.move(particles, Real(time_step));
  }

  /// Collisions of close pairs, all computed from the velocities before the collisions.
  template <FluidParticles P, class S>
  void collide(P& particles, const S& search, double time_step) {
    if (!(settings_.collision.reach() > 0)) return;
    timed(seconds_.neighbours, [&] { operators_.find_if_moved(particles, search); });
    particles.refresh_ghosts(velocity);
    const CloseRange<Real> range(operators_.stencil(), settings_, time_step);
    find_changes(particles, changes_.collision, [&](Index i) -> Vec {
      const ClosePairs pairs(particles, operators_, range, i);
      return operators_.walls().velocity_change(pairs, settings_.collision);
    });
    apply_changes(changes_.collision, particles, velocity);
  }

  /// Number density, free surface, source, ∇²P = source, and u' = −(Δt/ρ) ∇P      (9), (16), (11)
  /// With bodies that an impact gives other velocities, once more with these. Throws if the solve does
  /// not converge.
  template <FluidParticles P, class S>
  SolveReport project(P& particles, const S& search, double time_step) {
    timed(seconds_.neighbours, [&] { operators_.find_if_moved(particles, search); });
    const ScopedTimer in_pressure(seconds_.pressure);
    const auto step = view(particles, time_step);
    do {
      pressure_.find_boundary(particles, operators_, settings_.surface);  // n (5), (13), (17)
      particles.refresh_ghosts(velocity);
      particles.refresh_ghosts(pressure);  // of the previous step
      operators_.continue_flow(particles);
      const PressureRise rise(step);
      pressure_.solve(particles, step, rise, record_.time(), seconds_);
      record_.find_work_of_walls(step, operators_.walls(), rise);
      const MovesBeforeWalls moves(step, advection_);
      const Real factor = -Real(time_step) / Real(settings_.density);
      find_changes(particles, changes_.pressure, [&](Index i) -> Vec {
        return moves.change(i, factor * step.at(i).pressure_gradient(settings_.gradient, rise));
      });
      record_.find_momentum_changes(particles, operators_, changes_);
    } while (operators_.change_velocities(particles, search, record_.momentum_changes(), settings_,
                                          record_.time(), time_step));
    return pressure_.report();
  }

  /// u = u* + u';  r = r + Δt u, or r* + Δt u' if the particles were moved with u*.
  template <FluidParticles P>
  void correct(P& particles, double time_step) {
    apply_changes(changes_.pressure, particles, velocity);
    if constexpr (ParticlesInMixture<P>) {
      const Real per_change = -Real(settings_.density / time_step);
      const auto gradient = particles[pressure_gradient];
      for_each_of_fluid(particles,
                        [&](Index i) { gradient[i] = per_change * changes_.pressure[i]; });
    }
    if constexpr (Displaces<ShiftingOf<Scheme>>) {
      particles.refresh_ghosts(velocity);
      const auto step = view(particles, time_step);
      const MovesBeforeWalls moves(step, advection_);
      find_changes(particles, changes_.shift, [&](Index i) -> Vec {
        return moves.shift(i, settings_.shifting.displacement(step.at(i)));
      });
      apply_changes(changes_.shift, particles, position);
    }
    advection_.move_rest(particles, Real(time_step));
    record_.end_step(particles, changes_, force_, time_step);
    operators_.end_step(particles, record_.momentum_changes(), settings_, record_.time(),
                        time_step);
  }

  /// Throws if a particle moved by more than a spacing in the step, or went through a wall that
  /// hides neighbours, or if the fluid gained speed or energy that nothing had: see FlowWatch. Called
  /// by Simulation.
  template <FluidParticles P>
  void check_step(const P& particles, const FinishedStep& step) const {
    record_.check_moves(particles, settings_, step);
    operators_.check_moves(particles);
    record_.check_gains(particles, settings_, step);
  }

  void save() {
    record_.save();
    operators_.save();
  }
  void restore() noexcept {
    record_.restore();
    operators_.restore();
  }
  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.setup("settings", settings_.setup());
    record_.transfer(archive);
    operators_.transfer(archive);
  }

 private:
  using Operators = FlowOperators<Scheme, Dim, Real>;

  // For the loads of walls. Along walls without friction there is none.
  static constexpr bool needs_wall_stress =
      AddsImages<typename WallsOf<Scheme>::template InFlow<Dim, Real>> &&
      !std::same_as<WallStressOf<Scheme>, FreeSlip>;

  static Settings checked(const Settings& settings) {
    settings.check();
    return settings;
  }

  // Checks the particles, and finds their neighbours and the forces on them.
  template <class P, class S>
  void begin_step(P& particles, const S& search, double time_step) {
    record_.begin_step(particles, settings_, time_step);
    changes_.clear();
    advection_.begin();
    particles.refresh_ghosts(kind);  // may have changed since the search made them
    if constexpr (ParticlesInMixture<P>) {
      particles.refresh_ghosts(fluid_fraction, fluid_fraction_rate, response);
    }
    check_positions(particles, operators_.stencil());
    operators_.begin_step(record_.time(), time_step);
    timed(seconds_.neighbours, [&] { operators_.find(particles, search); });
    if (record_.is_first_step()) check_arrangement(particles, operators_, settings_.gravity);
    particles.refresh_ghosts(velocity);
    force_.find(particles, settings_.body_force, record_.time());
    record_.begin_changes(particles, force_, time_step, operators_.max_speed_of_walls());
  }

  template <class P>
  StepView<Scheme, P> view(const P& particles, double time_step) const {
    return {particles, settings_,           operators_, pressure_.boundary(),
            force_,    pressure_.moments(), time_step,  record_.is_first_step()};
  }

  Settings settings_;
  Operators operators_;
  BodyForce<Dim, Real> force_;
  [[no_unique_address]] typename FrictionOf<Scheme>::template InFlow<Dim, Real> friction_;
  FlowPressure<Scheme, Dim, Real, Solver> pressure_;
  FlowSeconds seconds_;
  FlowRecord<Dim, Real> record_;
  Advection<Vec> advection_;
  StepChanges<Vec> changes_;
};

}  // namespace silt::mps
