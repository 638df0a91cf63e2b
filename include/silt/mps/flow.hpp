// SPDX-License-Identifier: MIT
// The interaction of MPS, [HwangLeePark2010]: predictor, collision, pressure, corrector.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/linear/linear_system.hpp>
#include <silt/mps/arrangement.hpp>
#include <silt/mps/cases.hpp>
#include <silt/mps/corrected_gradient.hpp>
#include <silt/mps/flow_energy.hpp>
#include <silt/mps/flow_seconds.hpp>
#include <silt/mps/flow_settings.hpp>
#include <silt/mps/fluid.hpp>
#include <silt/mps/neighbourhood.hpp>
#include <silt/mps/operators.hpp>
#include <silt/mps/pressure.hpp>
#include <silt/mps/time_step.hpp>
#include <silt/mps/walls.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <type_traits>
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
    stencil_ = Stencil({.spacing = settings_.spacing, .radius = settings_.radius});
    laplacian_ = LaplacianStencil(
        {.spacing = settings_.spacing, .radius = settings_.laplacian_radius});
    gravity_ = settings_.gravity.template cast<Real>();
    energy_ = EnergyAccount<Dim, Real>(
        {.mass = settings_.density * std::pow(settings_.spacing, Dim), .gravity = gravity_});
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
  const auto& stencil() const noexcept { return stencil_; }
  /// Wall-clock time by stage.
  const FlowSeconds& seconds() const noexcept { return seconds_; }
  double seconds_in_pressure() const noexcept { return seconds_.pressure; }  ///< [s], wall time

  /// Interaction range: the larger of the two effective radii [m].
  template <FluidParticles P>
  Real reach(const P&) const {
    return std::max(stencil_.re, laplacian_.re);
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
    find_neighbours(particles, search);
    if (is_first) {
      check_spacing(particles, neighbourhood_, stencil_);
      check_periodic_lattice(particles, neighbourhood_, stencil_);
    }
    const Real dt = Real(time_step);
    const Real nu = Real(settings_.viscosity);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    if constexpr (needs_density_rate<typename Scheme::Source>()) {
      previous_velocity_.assign(particles[velocity].begin(), particles[velocity].end());
    }
    find_forces(particles);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = dt * force(i);
      if (nu > 0) change += (dt * nu) * laplacian(laplacian_neighbourhood(), laplacian_, i, u);
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
    const auto& model = settings_.collision;
    const Real reach = Real(model.reach() * settings_.spacing);
    if (!(reach > 0)) return;
    find_neighbours_of_moved(particles, search);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    const auto kinds = particles.with_ghosts(kind);
    // Weights decrease with the distance; the factor is a margin for round-off.
    const float min_weight = static_cast<float>(stencil_.weight(reach)) * (1 - 0x1p-16f);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = Vec::Zero();
      Vec by_walls = Vec::Zero();
      neighbourhood_.for_each_closer(i, reach, min_weight, [&](Index j, const Vec& r_ij, Real r) {
        CollidingPair<Dim, Real> pair{.r_ij = r_ij,
                                      .r = r,
                                      .u_ij = u[j] - u[i],
                                      .wall = kinds[j] != Kind::fluid,
                                      .spacing = Real(settings_.spacing),
                                      .time_step = Real(time_step)};
        if (Scheme::Walls::smooth && pair.wall) {
          const Vec& normal = normals_[particles.owner(j)];
          if (kinds[j] == Kind::dummy || !project_onto_normal(pair, normal)) return;
          // Several particles form one wall: only the largest change along each normal is used.
          const Vec by_wall = model.velocity_change(pair);
          by_walls += std::max(Real(0), normal.dot(by_wall - by_walls)) * normal;
          return;
        }
        change += model.velocity_change(pair);
      });
      change_[i] = change + by_walls;
    });
    apply_change(particles, changes_.collision);
  }

  /// Number density, free surface, source, ∇²P = source, and u' = −(Δt/ρ) ∇P      (9), (16), (11)
  /// Throws if the solve does not converge.
  template <FluidParticles P, class S>
  SolveReport project(P& particles, const S& search, double time_step) {
    find_neighbours_of_moved(particles, search);
    const ScopedTimer in_pressure(seconds_.pressure);
    find_density_and_surface(particles);
    assemble(particles, time_step);
    solve(particles);
    check_solve(particles);
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
    energy_.end(particles, changes_, forces_, time_step);
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
    archive.within("time_step", [&] { time_step_.transfer(archive); });
    archive.within("energy", [&] { energy_.transfer(archive); });
  }

 private:
  using Stencil = mps::Stencil<Dim, Real, typename Scheme::Kernel>;
  using LaplacianKernel =
      typename Scheme::Laplacian::template Weights<typename Scheme::Kernel, Dim>;
  using LaplacianStencil = mps::Stencil<Dim, Real, LaplacianKernel>;

  template <class P, class F>
  static void for_each_of_fluid(const P& particles, F&& f) {
    for_each(particles.size(), [&f, kinds = particles[kind]](Index i) {
      if (kinds[i] == Kind::fluid) f(i);
    });
  }

  double viscous() const { return viscous_limit(laplacian_, settings_.viscosity); }

  template <class P, class S>
  void find_neighbours(const P& particles, const S& search) {
    const ScopedTimer in_neighbours(seconds_.neighbours);
    neighbourhood_.find(particles, search, stencil_);
    if (!shares_neighbourhood()) laplacian_neighbourhood_.find(particles, search, laplacian_);
    if constexpr (Scheme::Walls::smooth) normals_.find(particles, neighbourhood_, stencil_);
  }

  template <class P, class S>
  void find_neighbours_of_moved(const P& particles, const S& search) {
    if (!neighbourhood_.is_current(particles)) find_neighbours(particles, search);
  }

  // The Laplacian has the weights and radius of the other operators.
  bool shares_neighbourhood() const {
    return std::is_same_v<Stencil, LaplacianStencil> && stencil_.re == laplacian_.re;
  }
  const auto& laplacian_neighbourhood() const {
    return shares_neighbourhood() ? neighbourhood_ : laplacian_neighbourhood_;
  }

  // F at each particle, if there is a body force.
  template <class P>
  void find_forces(const P& particles) {
    forces_.clear();
    if (!settings_.body_force) return;
    forces_.resize(particles.size());
    const auto x = particles[position];
    for_each(particles.size(), [&](Index i) {
      forces_[i] = gravity_ + settings_.body_force(x[i].template cast<double>(), time_)
                                  .template cast<Real>();
    });
  }
  Vec force(Index i) const { return forces_.empty() ? gravity_ : forces_[i]; }

  // Projects a pair with a wall particle onto the wall's normal. False if the fluid particle is
  // behind the wall, or laterally closer to another wall particle.
  bool project_onto_normal(CollidingPair<Dim, Real>& pair, const Vec& normal) const {
    const Vec along = normal.dot(pair.r_ij) * normal;
    const Real across2 = (pair.r_ij - along).squaredNorm();
    if (across2 > Real(0.2501) * (Dim - 1) * squared(pair.spacing)) return false;
    if (!(normal.dot(pair.r_ij) < 0)) return false;
    pair.r_ij = along;
    pair.r = along.norm();
    pair.u_ij = normal.dot(pair.u_ij) * normal;
    return true;
  }

  // Adds change_ to the velocities, and stores it as the change by a stage for the energy balance.
  template <class P>
  void apply_change(P& particles, std::vector<Vec>& by_stage) {
    const auto u = particles[velocity];
    for_each_of_fluid(particles, [&](Index i) { u[i] += change_[i]; });
    by_stage.swap(change_);
  }

  // Values of owned particles, accessible by the index of a ghost too.
  template <class P>
  struct OwnerValues {
    const P& particles;
    const std::vector<Vec>& values;
    const Vec& operator[](Index j) const { return values[particles.owner(j)]; }
  };

  // n_i (5), the free surface (13), (17), and the particles with a pressure.
  template <class P>
  void find_density_and_surface(P& particles) {
    const auto n = particles[number_density];
    const auto on_surface = particles[surface];
    const auto kinds = particles.with_ghosts(kind);
    has_pressure_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      n[i] = neighbourhood_.density(i);
      const LocalDensity local_density{
          .density = double(n[i] / stencil_.n0),
          .neighbours = double(neighbourhood_[i].size()) / double(stencil_.neighbours)};
      has_pressure_[i] = kinds[i] != Kind::dummy;
      if constexpr (SurfaceByDensity<typename Scheme::Surface>) {
        on_surface[i] = settings_.surface.is_on_surface(local_density);
      } else {
        const SurfaceScale<Real> scale{.spacing = stencil_.spacing, .n0 = stencil_.n0};
        const auto for_each_around = [&](auto&& f) {
          for_each_weighted(neighbourhood_, i, stencil_,
                            [&](Index j, const Vec& r_ij, Real w, Real) {
            f(r_ij, w, kinds[i] != Kind::fluid || kinds[j] == Kind::fluid);
          });
        };
        on_surface[i] = kinds[i] != Kind::dummy &&
                        settings_.surface.template is_on_surface<Dim, Real>(local_density, scale,
                                                                            for_each_around);
      }
      if (!Scheme::Walls::smooth || kinds[i] != Kind::wall) return;
      const bool is_wet = any_weighted(neighbourhood_, i, stencil_,
                                       [&](Index j, Real) { return kinds[j] == Kind::fluid; });
      on_surface[i] |= !is_wet;
      has_pressure_[i] = !on_surface[i];
    });
    if constexpr (balances_forces<typename Scheme::Source>() || Scheme::Shifting::shifts) {
      near_boundary_.resize(particles.size());
      for_each(particles.size(), [&](Index i) {
        if (kinds[i] == Kind::dummy) return;
        const auto is_boundary = [&](Index j, Real) {
          const Index owner = particles.owner(j);
          return on_surface[owner] || !has_pressure_[owner];
        };
        near_boundary_[i] =
            on_surface[i] || any_weighted(neighbourhood_, i, stencil_, is_boundary);
      });
    }
  }

  // ∇²P = source      (9), (16)
  template <class P>
  void assemble(P& particles, double time_step) {
    using Source = typename Scheme::Source;
    const ScopedTimer in_assembly(seconds_.assembly);
    particles.refresh_ghosts(velocity);
    const auto kinds = particles.with_ghosts(kind);
    auto u = particles.with_ghosts(velocity);
    const auto n = particles[number_density];
    if constexpr (balances_forces<Source>()) {
      particles.refresh_ghosts(pressure);  // of the previous step
      balanced_velocity_.assign(u.begin(), u.end());
      for_each(u.size(), [&](Index j) {
        if (kinds[j] != Kind::fluid) {
          balanced_velocity_[j] += Real(time_step) * force(particles.owner(j));
        }
      });
    }
    const auto has_pressure = [&](Index i) { return has_pressure_[i] != 0; };
    const auto source = [&](Index i) {
      SourceTerms terms{.density = settings_.density, .time_step = time_step};
      terms.compression = double((n[i] - stencil_.n0) / stencil_.n0);
      if constexpr (balances_forces<Source>()) {
        terms.divergence = double(divergence_of(particles, i, balanced_velocity_));
        terms.near_boundary = near_boundary_[i] != 0;
        terms.asymmetry = double(asymmetry(particles, i));
      } else if constexpr (Source::needs_divergence) {
        terms.divergence = double(divergence_of(particles, i, u));
      }
      if constexpr (needs_density_rate<Source>()) {
        terms.density_rate = double(density_rate(neighbourhood_, stencil_, i, u));
        terms.last_density_rate = double(density_rate(
            neighbourhood_, stencil_, i, OwnerValues<P>{particles, previous_velocity_}));
      }
      return settings_.source.value(terms);
    };
    equation_.assemble(particles, laplacian_neighbourhood(), laplacian_, source,
                       has_pressure);
  }

  template <class P, class U>
  Real divergence_of(const P& particles, Index i, const U& u) const {
    if constexpr (Scheme::Walls::smooth) {
      return divergence_at_smooth_walls(particles, neighbourhood_, normals_, stencil_, i, u);
    } else {
      return divergence(neighbourhood_, stencil_, i, u);
    }
  }

  // The Laplacian of a linear pressure, which is not zero where neighbours are missing on one side;
  // see BalancedSource.
  template <class P>
  Real asymmetry(const P& particles, Index i) const {
    const Vec gradient = pressure_gradient<CorrectedGradient>(particles, i);
    const Vec weight = Real(settings_.density) * force(i);
    Real sum = 0;
    for_each_weighted(laplacian_neighbourhood(), i, laplacian_,
                      [&](Index j, const Vec& r_ij, Real w, Real) {
      const bool has_pressure = has_pressure_[particles.owner(j)];
      sum += w * r_ij.dot(has_pressure ? gradient : Vec(gradient - weight));
    });
    return 2 * Dim / (laplacian_.lambda * laplacian_.n0) * sum;
  }

  // <∇P>_i over the neighbours with pressure.
  template <class Gradient, class P>
  Vec pressure_gradient(const P& particles, Index i) const {
    const auto p = particles.with_ghosts(pressure);
    return Gradient::evaluate(stencil_, p[i], [&](auto&& f) {
      for_each_weighted(neighbourhood_, i, stencil_,
                        [&](Index j, const Vec& r_ij, Real w, Real w_r2) {
        if (has_pressure_[particles.owner(j)]) f(p[j], r_ij, w, w_r2);
      });
    });
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
      change_[i] = factor * pressure_gradient<typename Scheme::Gradient>(particles, i);
    });
  }

  // The shift of each fluid particle.
  template <class P>
  void find_shifts(const P& particles, Real dt) {
    const auto u = particles.with_ghosts(velocity);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      ShiftInput<Dim, Real> input{.near_boundary = near_boundary_[i] != 0,
                                  .spacing = Real(settings_.spacing),
                                  .time_step = dt};
      for_each_weighted(neighbourhood_, i, stencil_,
                        [&](Index j, const Vec& r_ij, Real, Real w_r2) {
        input.concentration_gradient += (stencil_.spacing * w_r2 / stencil_.n0) * r_ij;
        input.max_relative_speed = std::max(input.max_relative_speed, (u[j] - u[i]).norm());
      });
      change_[i] = settings_.shifting.displacement(input);
    });
  }

  template <class P>
  void check_solve(const P& particles) const {
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
    fail("mps::Flow: the pressure solve did not converge: residual " + to_text(report_.residual) +
         " after " + std::to_string(report_.iterations) + " iterations for " +
         std::to_string(report_.unknowns) +
         " unknowns; decrease the time step, or increase max_iterations or tolerance");
  }

  Settings settings_;
  Solver solver_;
  Stencil stencil_;
  LaplacianStencil laplacian_;
  Neighbourhood<Dim, Real> neighbourhood_;            // within stencil_
  Neighbourhood<Dim, Real> laplacian_neighbourhood_;  // within laplacian_, if it differs
  Vec gravity_ = Vec::Zero();
  PressureEquation equation_;
  SolveReport report_;
  FlowSeconds seconds_;
  TimeStep time_step_;
  EnergyAccount<Dim, Real> energy_;
  WallNormals<Dim, Real> normals_;
  std::vector<std::uint8_t> has_pressure_;   // unknown, or P = 0 on the free surface
  std::vector<std::uint8_t> near_boundary_;  // see SourceTerms
  std::vector<Vec> forces_;             // F at each particle; empty if there is no body force
  std::vector<Vec> balanced_velocity_;  // u*, but Δt F for walls and dummies; with ghosts
  std::vector<Vec> previous_velocity_;  // u before the predictor
  double time_ = 0;
  std::vector<Vec> change_;              // of the velocities, by the current stage of the step
  StepChanges<Vec> changes_;             // of the velocities, by stage
  std::vector<Vec> advection_velocity_;  // u* of advect(); empty if the particles were not moved
};

}  // namespace silt::mps
