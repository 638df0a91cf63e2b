// SPDX-License-Identifier: MIT
// The interaction of MPS, [HwangLeePark2010]: predictor, collision, pressure, corrector.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/cases.hpp>
#include <silt/mps/flow_seconds.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/pressure.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace silt::mps {

/// Incompressible flow under one column of Table 1, in Dim dimensions, with pressure by Solver.
template <class Scheme, int Dim, class RealType, LinearSolver Solver>
class BasicFlow {
 public:
  using Real = RealType;
  using Vec = silt::Vec<Dim, Real>;
  using Settings = FlowSettings<Dim, Scheme>;
  static constexpr bool needs_moved_particles = Scheme::Source::needs_moved_particles;

  /// Throws if a number is out of range.
  explicit BasicFlow(const Settings& settings, Solver solver = {})
      : settings_(settings), solver_(std::move(solver)) {
    settings_.check();
    solver_.check();
    stencil_ = Stencil({.spacing = settings_.spacing, .radius = settings_.radius});
    laplacian_ = Stencil({.spacing = settings_.spacing, .radius = settings_.laplacian_radius});
    gravity_ = settings_.gravity.template cast<Real>();
  }

  const Settings& settings() const noexcept { return settings_; }
  /// Iterations and residual of the last pressure solve.
  const SolveReport& last_solve() const noexcept { return report_; }
  /// The stencil of density, gradient and divergence.
  const auto& stencil() const noexcept { return stencil_; }
  /// Where the time went so far.
  const FlowSeconds& seconds() const noexcept { return seconds_; }
  double seconds_in_pressure() const noexcept { return seconds_.pressure; }  ///< [s], wall time

  /// The larger of the two radii [m].
  template <FluidParticles P>
  Real reach(const P&) const {
    return std::max(stencil_.re, laplacian_.re);
  }

  /// Courant limit of the fastest particle, of the speed scale and of a fall from rest, and the
  /// viscous limit [s].
  template <FluidParticles P>
  double time_step(const P& particles) const {
    const double way = settings_.courant * settings_.spacing;
    const double speed = std::max(fastest(particles), settings_.speed_scale);
    double dt = settings_.largest_time_step;
    if (speed > 0) dt = std::min(dt, way / speed);
    const double pull = settings_.gravity.norm();
    if (pull > 0) dt = std::min(dt, std::sqrt(way / pull));
    if (settings_.viscosity > 0) dt = std::min(dt, viscous_limit());
    return dt;
  }

  /// u* = u + Δt (ν∇²u + F)      (8)
  /// Throws if Δt is beyond stability: a particle passing a spacing, or the viscous limit.
  template <FluidParticles P, class S>
  void predict(P& particles, const S& search, double time_step) {
    check_stability(particles, time_step);
    find_neighbours(particles, search);
    const Real dt = Real(time_step);
    const Real nu = Real(settings_.viscosity);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = dt * gravity_;
      if (nu > 0) change += (dt * nu) * laplacian(around_laplacian(), laplacian_, i, u);
      change_[i] = change;
    });
    apply_change(particles);
    moved_with_.clear();
  }

  /// r* = r + Δt u*: the original order moves particles before the pressure.
  template <FluidParticles P>
  void advect(P& particles, double time_step) {
    const Real dt = Real(time_step);
    const auto u = particles[velocity];
    const auto x = particles[position];
    moved_with_.assign(u.begin(), u.end());
    for_each_of_fluid(particles, [&](Index i) { x[i] += dt * u[i]; });
  }

  /// Approaching pairs closer than a l0 exchange momentum; every pair sees the velocities before.
  template <FluidParticles P, class S>
  void collide(P& particles, const S& search, double) {
    const auto& model = settings_.collision;
    const Real reach = Real(model.distance * settings_.spacing);
    if (!(reach > 0)) return;
    find_neighbours_of_moved(particles, search);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    const auto kinds = particles.with_ghosts(kind);
    // Weights fall with the distance; rounding must not lose anybody.
    const float least = static_cast<float>(stencil_.weight(reach)) * (1 - 0x1p-16f);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = Vec::Zero();
      around_.for_each_closer(i, reach, least, [&](Index j, const Vec& r_ij, Real r) {
        change += model.impulse(r_ij, r, Vec(u[j] - u[i]), kinds[j] != Kind::fluid);
      });
      change_[i] = change;
    });
    apply_change(particles);
  }

  /// Number density, free surface, source, ∇²P = source, and u' = −(Δt/ρ) ∇P      (9), (16), (11)
  /// Throws if the solve does not converge.
  template <FluidParticles P, class S>
  SolveReport project(P& particles, const S& search, double time_step) {
    find_neighbours_of_moved(particles, search);
    const Timed in_pressure(seconds_.pressure);
    find_density_and_surface(particles);
    assemble(particles, time_step);
    solve(particles);
    refuse_failed(report_);
    if (settings_.clip_negative_pressure) {
      const auto p = particles[pressure];
      for_each(particles.size(), [&](Index i) { p[i] = std::max(p[i], Real(0)); });
    }
    find_pressure_change(particles, Real(time_step));
    return report_;
  }

  /// u = u* + u';  r = r + Δt u, or r* + Δt u' where the particles have moved with u*.
  template <FluidParticles P>
  void correct(P& particles, double time_step) {
    const Real dt = Real(time_step);
    apply_change(particles);
    const auto u = particles[velocity];
    const auto x = particles[position];
    for_each_of_fluid(particles, [&](Index i) {
      x[i] += dt * (moved_with_.empty() ? u[i] : Vec(u[i] - moved_with_[i]));
    });
  }

 private:
  using Stencil = mps::Stencil<Dim, Real, typename Scheme::Kernel>;

  template <class P, class F>
  static void for_each_of_fluid(const P& particles, F&& f) {
    for_each(particles.size(), [&f, kinds = particles[kind]](Index i) {
      if (kinds[i] == Kind::fluid) f(i);
    });
  }

  template <class P>
  static double fastest(const P& particles) {
    const auto u = particles[velocity];
    return std::sqrt(largest(u.size(), 0.0, [&](Index i) { return double(u[i].squaredNorm()); }));
  }

  // The explicit viscous term is stable while Δt ν times its largest eigenvalue, twice the row's
  // sum 2d/λ, stays below 2; half of that is taken.
  double viscous_limit() const {
    return double(laplacian_.lambda) / (4 * Dim * settings_.viscosity);
  }

  template <class P>
  void check_stability(const P& particles, double dt) const {
    if (settings_.viscosity > 0 && dt > 2 * viscous_limit()) {
      fail("mps::Flow: time_step = " + to_text(dt) + " s exceeds the viscous limit " +
           to_text(2 * viscous_limit()) + " s; lower it");
    }
    const auto u = particles[velocity];
    const Index broken = first_where(u.size(), [&](Index i) {
      return double(u[i].norm()) * dt > settings_.spacing;
    });
    if (broken != nowhere) {
      const double speed = double(u[broken].norm());
      fail("mps::Flow: time_step = " + to_text(dt) + " s moves a particle of " + to_text(speed) +
               " m/s by more than the spacing; take at most " +
               to_text(settings_.courant * settings_.spacing / speed) + " s",
           {.particle = broken, .id = particles.id(broken)});
    }
  }

  template <class P, class S>
  void find_neighbours(const P& particles, const S& search) {
    const Timed in_neighbours(seconds_.neighbours);
    around_.find(particles, search, stencil_);
    if (stencil_.re != laplacian_.re) around_laplacian_.find(particles, search, laplacian_);
  }

  template <class P, class S>
  void find_neighbours_of_moved(const P& particles, const S& search) {
    if (!around_.is_of(particles)) find_neighbours(particles, search);
  }

  const auto& around_laplacian() const {
    return stencil_.re == laplacian_.re ? around_ : around_laplacian_;
  }

  template <class P>
  void apply_change(P& particles) {
    const auto u = particles[velocity];
    for_each_of_fluid(particles, [&](Index i) { u[i] += change_[i]; });
  }

  // n_i (5) and the free surface (13), (17).
  template <class P>
  void find_density_and_surface(P& particles) {
    const auto n = particles[number_density];
    const auto on_surface = particles[surface];
    for_each(particles.size(), [&](Index i) {
      n[i] = around_.density(i);
      on_surface[i] = settings_.surface.holds({.density = double(n[i] / stencil_.n0),
                                               .neighbours = double(around_[i].size()) /
                                                             double(stencil_.neighbours)});
    });
  }

  // ∇²P = source      (9), (16)
  template <class P>
  void assemble(P& particles, double time_step) {
    const Timed in_assembly(seconds_.assembly);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    const auto n = particles[number_density];
    equation_.assemble(particles, around_laplacian(), laplacian_, [&](Index i) {
      SourceTerms terms{.density = settings_.density, .time_step = time_step};
      terms.compression = double((n[i] - stencil_.n0) / stencil_.n0);
      if constexpr (Scheme::Source::needs_divergence) {
        terms.divergence = double(divergence(around_, stencil_, i, u));
      }
      return settings_.source.value(terms);
    });
  }

  template <class P>
  void solve(P& particles) {
    const Timed in_solve(seconds_.solve);
    report_ = equation_.solve(particles, solver_);
  }

  // u' = −(Δt/ρ) ∇P      (11)
  template <class P>
  void find_pressure_change(P& particles, Real dt) {
    particles.refresh_ghosts(pressure);
    const auto p = particles.with_ghosts(pressure);
    const auto kinds = particles.with_ghosts(kind);
    const Real factor = -dt / Real(settings_.density);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      change_[i] = factor * Scheme::Gradient::at(stencil_, p[i], [&](auto&& f) {
        for_each_weighted(around_, i, stencil_, [&](Index j, const Vec& r_ij, Real w, Real w_r2) {
          if (kinds[j] != Kind::dummy) f(p[j], r_ij, w, w_r2);
        });
      });
    });
  }

  void refuse_failed(const SolveReport& report) const {
    if (report.reason == SolveReport::Reason::converged ||
        report.reason == SolveReport::Reason::nothing_to_solve) {
      return;
    }
    fail("mps::Flow: the pressure solve stopped at a residual of " + to_text(report.residual) +
         " after " + std::to_string(report.iterations) + " iterations over " +
         std::to_string(report.unknowns) +
         " unknowns; lower the time step, or allow more iterations or a larger tolerance");
  }

  Settings settings_;
  Solver solver_;
  Stencil stencil_;
  Stencil laplacian_;
  Neighbourhood<Dim, Real> around_;            // within the stencil
  Neighbourhood<Dim, Real> around_laplacian_;  // of the Laplacian, where its radius is another
  Vec gravity_ = Vec::Zero();
  PressureEquation equation_;
  SolveReport report_;
  FlowSeconds seconds_;
  std::vector<Vec> change_;      // of the fluid's velocity, by the part of the step under way
  std::vector<Vec> moved_with_;  // velocity the predictor moved each particle with, if it did
};

}  // namespace silt::mps
