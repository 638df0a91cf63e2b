// SPDX-License-Identifier: MIT
// The interaction of MPS, [HwangLeePark2010]: predictor, collision, pressure, corrector.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/arrangement.hpp>
#include <silt/mps/body_force.hpp>
#include <silt/mps/flow_collisions.hpp>
#include <silt/mps/flow_energy.hpp>
#include <silt/mps/flow_operators.hpp>
#include <silt/mps/flow_seconds.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/flow_source.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/pressure.hpp>
#include <silt/mps/pressure_boundary.hpp>
#include <silt/mps/shifting.hpp>
#include <silt/mps/time_step.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace silt::mps {

/// Incompressible flow in Dim dimensions with the policies of a Scheme, such as mps::Case10; Solver
/// solves the pressure equation.
template <class Scheme, int Dim, class RealType, LinearSolver Solver>
class BasicFlow {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Settings = FlowSettings<Dim, Scheme>;
  static constexpr bool needs_moved_particles = Scheme::Source::needs_moved_particles;

  /// Throws if a setting is out of range.
  explicit BasicFlow(const Settings& settings, Solver solver = {})
      : settings_(settings), solver_(std::move(solver)) {
    settings_.check();
    solver_.check();
    operators_ = Operators(settings_);
    const Vec gravity = settings_.gravity.template cast<Real>();
    force_ = BodyForce<Dim, Real>(gravity);
    energy_ = EnergyAccount<Dim, Real>(
        {.mass = settings_.density * std::pow(settings_.spacing, Dim), .gravity = gravity});
  }

  const Settings& settings() const noexcept { return settings_; }
  /// Iterations and residual of the last pressure solve.
  const SolveReport& last_solve() const noexcept { return report_; }
  /// Energy after the last step, and the work since the first step.
  const FlowEnergy& energy() const noexcept { return energy_.energy(); }
  /// Kinetic and potential energy of the particles, also before the first step.
  template <FluidParticles P>
  FlowEnergy energy_of(const P& particles) const {
    return energy_.of(particles);
  }
  /// The stencil of density, gradient and divergence.
  const auto& stencil() const noexcept { return operators_.stencil(); }
  /// Wall-clock time by stage.
  const FlowSeconds& seconds() const noexcept { return seconds_; }
  double seconds_in_pressure() const noexcept { return seconds_.pressure; }  ///< [s], wall time

  /// Interaction range: the larger of the two effective radii [m].
  template <FluidParticles P>
  Real reach(const P&) const {
    return operators_.reach();
  }

  /// Limits of the next time step [s].
  template <FluidParticles P>
  TimeStepLimits time_step_limits(const P& particles) const {
    return time_step_.limits(particles, settings_, {.viscous = viscous(), .time = time_});
  }
  template <FluidParticles P>
  double time_step(const P& particles) const {
    return time_step_limits(particles).smallest();
  }

  /// Sets the time of the positions [s], at which FlowSettings::body_force is evaluated.
  void set_time(double time) { time_ = time; }

  /// u* = u + Δt (ν∇²u + F)      (8)
  /// Throws if Δt is unstable: see TimeStep::begin(). The first step throws if the particles do not
  /// fit the spacing: see mps/arrangement.hpp.
  template <FluidParticles P, class S>
  void predict(P& particles, const S& search, double time_step) {
    const bool is_first = time_step_.is_first();
    time_step_.begin(particles, settings_, {.viscous = viscous(), .time = time_}, time_step);
    energy_.begin(particles);
    changes_.clear();
    particles.refresh_ghosts(kind);  // may have changed since the search made them
    find_neighbours(particles, search);
    if (is_first) {
      check_spacing(particles, operators_.neighbourhood(), operators_.stencil());
      check_periodic_lattice(particles, operators_.neighbourhood(), operators_.stencil());
    }
    const Real dt = Real(time_step);
    const Real nu = Real(settings_.viscosity);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    source_.begin(particles);
    force_.find(particles, settings_.body_force, time_);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = dt * force_[i];
      if (nu > 0) change += (dt * nu) * operators_.laplacian(i, u);
      change_[i] = change;
    });
    apply_change(particles, changes_.predictor);
    advection_velocity_.clear();
  }

  /// r* = r + Δt u*, for sources that need moved particles: the original MPS.
  template <FluidParticles P>
  void advect(P& particles, double time_step) {
    const Real dt = Real(time_step);
    const auto u = particles[velocity];
    const auto x = particles[position];
    advection_velocity_.assign(u.begin(), u.end());
    for_each_of_fluid(particles, [&](Index i) { x[i] += dt * u[i]; });
  }

  /// Collisions of close pairs, all computed from the velocities before the collisions.
  template <FluidParticles P, class S>
  void collide(P& particles, const S& search, double time_step) {
    if (!(settings_.collision.reach() > 0)) return;
    find_neighbours_of_moved(particles, search);
    particles.refresh_ghosts(velocity);
    const FlowCollisions<Scheme, P> collisions(particles, operators_, settings_, time_step);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) { change_[i] = collisions.velocity_change(i); });
    apply_change(particles, changes_.collision);
  }

  /// Number density, free surface, source, ∇²P = source, and u' = −(Δt/ρ) ∇P      (9), (16), (11)
  /// Throws if the solve does not converge.
  template <FluidParticles P, class S>
  SolveReport project(P& particles, const S& search, double time_step) {
    find_neighbours_of_moved(particles, search);
    const ScopedTimer in_pressure(seconds_.pressure);
    boundary_.find(particles, operators_, settings_.surface);  // n (5), free surface (13), (17)
    assemble(particles, time_step);
    solve(particles);
    check_solve(particles, time_step);
    if (settings_.clip_negative_pressure) {
      const auto p = particles[pressure];
      for_each(particles.size(), [&](Index i) { p[i] = std::max(p[i], Real(0)); });
    }
    find_pressure_change(particles, Real(time_step));
    return report_;
  }

  /// u = u* + u';  r = r + Δt u, or r* + Δt u' if the particles were moved with u*.
  template <FluidParticles P>
  void correct(P& particles, double time_step) {
    const Real dt = Real(time_step);
    apply_change(particles, changes_.pressure);
    const auto u = particles[velocity];
    const auto x = particles[position];
    if constexpr (Scheme::Shifting::shifts) {
      particles.refresh_ghosts(velocity);
      find_shifts(particles, dt);
      for_each_of_fluid(particles, [&](Index i) { x[i] += change_[i]; });
      changes_.shift.swap(change_);
    }
    for_each_of_fluid(particles, [&](Index i) {
      x[i] += dt * (advection_velocity_.empty() ? u[i] : Vec(u[i] - advection_velocity_[i]));
    });
    energy_.end(particles, changes_, force_.values(), time_step);
  }

  /// Throws if a particle moved by more than a spacing in the step. Called by Simulation.
  template <FluidParticles P>
  void check_step(const P& particles, const FinishedStep& step) const {
    time_step_.end(particles, settings_, step);
  }

  void save() noexcept {
    time_step_.save();
    energy_.save();
  }
  void restore() noexcept {
    time_step_.restore();
    energy_.restore();
  }
  /// For a checkpoint, see core/transfer.hpp.
  template <class Archive>
  void transfer(Archive& archive) {
    archive.setup("settings", {{"FlowSettings::spacing", {settings_.spacing}},
                               {"FlowSettings::density", {settings_.density}}});
    archive.within("time_step", [&] { time_step_.transfer(archive); });
    archive.within("energy", [&] { energy_.transfer(archive); });
  }

 private:
  using Operators = FlowOperators<Scheme, Dim, Real>;

  template <class P, class F>
  static void for_each_of_fluid(const P& particles, F&& f) {
    for_each(particles.size(), [&f, kinds = particles[kind]](Index i) {
      if (kinds[i] == Kind::fluid) f(i);
    });
  }

  double viscous() const {
    return viscous_limit(operators_.laplacian_stencil(), settings_.viscosity);
  }

  template <class P, class S>
  void find_neighbours(const P& particles, const S& search) {
    const ScopedTimer in_neighbours(seconds_.neighbours);
    operators_.find(particles, search);
  }

  template <class P, class S>
  void find_neighbours_of_moved(const P& particles, const S& search) {
    if (!operators_.are_current(particles)) find_neighbours(particles, search);
  }

  // Adds change_ to the velocities, and stores it as the change by a stage for the energy balance.
  template <class P>
  void apply_change(P& particles, std::vector<Vec>& by_stage) {
    const auto u = particles[velocity];
    for_each_of_fluid(particles, [&](Index i) { u[i] += change_[i]; });
    by_stage.swap(change_);
  }

  // ∇²P = source      (9), (16)
  template <class P>
  void assemble(P& particles, double time_step) {
    const ScopedTimer in_assembly(seconds_.assembly);
    const auto source = source_.evaluator(particles, {.settings = settings_,
                                                      .operators = operators_,
                                                      .boundary = boundary_,
                                                      .force = force_,
                                                      .time_step = time_step});
    equation_.assemble(particles, operators_.laplacian_neighbourhood(),
                       operators_.laplacian_stencil(), source,
                       [&](Index i) { return boundary_.has_pressure(i); });
  }

  template <class P>
  void solve(P& particles) {
    const ScopedTimer in_solve(seconds_.solve);
    report_ = equation_.solve(particles, solver_);
  }

  // u' = −(Δt/ρ) ∇P      (11)
  template <class P>
  void find_pressure_change(P& particles, Real dt) {
    particles.refresh_ghosts(pressure);
    const Real factor = -dt / Real(settings_.density);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      change_[i] = factor * boundary_.template pressure_gradient<typename Scheme::Gradient>(
                                particles, operators_, i);
    });
  }

  // The shift of each fluid particle.
  template <class P>
  void find_shifts(const P& particles, Real dt) {
    const auto u = particles.with_ghosts(velocity);
    const auto& stencil = operators_.stencil();
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      ShiftInput<Dim, Real> input{.near_boundary = boundary_.is_near(i),
                                  .spacing = Real(settings_.spacing),
                                  .time_step = dt};
      for_each_weighted(
          operators_.neighbourhood(), i, stencil, [&](Index j, const Vec& r_ij, Real, Real w_r2) {
            input.concentration_gradient += (stencil.spacing * w_r2 / stencil.n0) * r_ij;
            input.max_relative_speed = std::max(input.max_relative_speed, (u[j] - u[i]).norm());
          });
      change_[i] = settings_.shifting.displacement(input);
    });
  }

  template <class P>
  void check_solve(const P& particles, double time_step) const {
    if (report_.reason == SolveReport::Reason::converged ||
        report_.reason == SolveReport::Reason::nothing_to_solve) {
      return;
    }
    const auto p = particles[pressure];  // the initial guess of the solve
    const Index broken = first_where(p.size(), [&](Index i) { return !is_finite(p[i]); });
    if (broken != no_index) {
      fail("mps::Flow: the pressure " + to_text(double(p[broken])) +
               " Pa is not finite; set a finite pressure",
           {.particle = broken, .id = particles.id(broken)});
    }
    if (!is_finite(report_.residual)) {
      const double highest =
          largest(p.size(), 0.0, [&](Index i) { return std::abs(double(p[i])); });
      fail(
          "mps::Flow: time_step = " + to_text(time_step) + " s and pressures of up to " +
          to_text(highest) +
          " Pa give a pressure equation that overflows; set a longer time step or lower pressures");
    }
    fail("mps::Flow: the pressure solve did not converge: residual " + to_text(report_.residual) +
         " after " + std::to_string(report_.iterations) + " iterations for " +
         std::to_string(report_.unknowns) +
         " unknowns; decrease the time step, or increase max_iterations or tolerance");
  }

  Settings settings_;
  Solver solver_;
  Operators operators_;
  BodyForce<Dim, Real> force_;
  PressureBoundary<Scheme> boundary_;
  FlowSource<Scheme, Dim, Real> source_;
  PressureEquation equation_;
  SolveReport report_;
  FlowSeconds seconds_;
  TimeStep time_step_;
  EnergyAccount<Dim, Real> energy_;
  double time_ = 0;
  std::vector<Vec> change_;              // of the velocities, by the current stage of the step
  StepChanges<Vec> changes_;             // of the velocities, by stage
  std::vector<Vec> advection_velocity_;  // u* of advect(); empty if the particles were not moved
};

}  // namespace silt::mps
