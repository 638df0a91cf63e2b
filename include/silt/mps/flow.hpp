// SPDX-License-Identifier: MIT
// The interaction of MPS, [HwangLeePark2010]: predictor, collision, pressure, corrector.
#pragma once

#include <silt/core/concepts.hpp>
#include <silt/core/error.hpp>
#include <silt/core/linear_system.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/cases.hpp>
#include <silt/mps/flow_energy.hpp>
#include <silt/mps/corrected_gradient.hpp>
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

/// Incompressible flow under a Scheme, such as a column of Table 1, in Dim dimensions, with pressure
/// by Solver.
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
    laplacian_ = LaplacianStencil(
        {.spacing = settings_.spacing, .radius = settings_.laplacian_radius});
    gravity_ = settings_.gravity.template cast<Real>();
    energy_ = EnergyAccount<Dim, Real>(
        {.mass = settings_.density * std::pow(settings_.spacing, Dim), .gravity = gravity_});
  }

  const Settings& settings() const noexcept { return settings_; }
  /// Iterations and residual of the last pressure solve.
  const SolveReport& last_solve() const noexcept { return report_; }
  /// Of the fluid after the last step, and where it went since the first.
  const FlowEnergy& energy() const noexcept { return energy_.energy(); }
  /// Of the fluid now, before a first step.
  template <FluidParticles P>
  FlowEnergy energy_of(const P& particles) const {
    return energy_.of(particles);
  }
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

  /// What the next time step must not exceed [s].
  template <FluidParticles P>
  TimeStepLimits time_step_limits(const P& particles) const {
    return time_step_.limits(particles, settings_, {.viscous = viscous(), .time = time_});
  }
  template <FluidParticles P>
  double time_step(const P& particles) const {
    return time_step_limits(particles).smallest();
  }

  /// The time of the positions [s], which FlowSettings::body_force is asked for.
  void set_time(double time) { time_ = time; }

  /// u* = u + Δt (ν∇²u + F)      (8)
  /// Throws if Δt is beyond stability: a particle passing a spacing, or the viscous limit.
  template <FluidParticles P, class S>
  void predict(P& particles, const S& search, double time_step) {
    time_step_.begin(particles, settings_, {.viscous = viscous(), .time = time_}, time_step);
    energy_.begin(particles);
    by_.clear();
    find_neighbours(particles, search);
    const Real dt = Real(time_step);
    const Real nu = Real(settings_.viscosity);
    particles.refresh_ghosts(velocity);
    const auto u = particles.with_ghosts(velocity);
    if constexpr (needs_density_rate<typename Scheme::Source>()) before_.assign(particles[velocity].begin(), particles[velocity].end());
    find_forces(particles);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      Vec change = dt * force(i);
      if (nu > 0) change += (dt * nu) * laplacian(around_laplacian(), laplacian_, i, u);
      change_[i] = change;
    });
    apply_change(particles, by_.predictor);
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

  /// Pairs that are too close exchange momentum; every pair sees the velocities before.
  template <FluidParticles P, class S>
  void collide(P& particles, const S& search, double time_step) {
    const auto& model = settings_.collision;
    const Real reach = Real(model.reach() * settings_.spacing);
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
      Vec by_walls = Vec::Zero();
      around_.for_each_closer(i, reach, least, [&](Index j, const Vec& r_ij, Real r) {
        CollidingPair<Dim, Real> pair{.r_ij = r_ij,
                                  .r = r,
                                  .u_ij = u[j] - u[i],
                                  .wall = kinds[j] != Kind::fluid,
                                  .spacing = Real(settings_.spacing),
                                  .time_step = Real(time_step)};
        if (Scheme::Walls::smooth && pair.wall) {
          const Vec& normal = normals_[particles.owner(j)];
          if (kinds[j] == Kind::dummy || !faces(pair, normal)) return;
          // Several particles are one wall: along each normal the largest counts.
          const Vec impulse = model.impulse(pair);
          by_walls += std::max(Real(0), normal.dot(impulse - by_walls)) * normal;
          return;
        }
        change += model.impulse(pair);
      });
      change_[i] = change + by_walls;
    });
    apply_change(particles, by_.collision);
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
    refuse_failed(particles);
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
    apply_change(particles, by_.pressure);
    const auto u = particles[velocity];
    const auto x = particles[position];
    if constexpr (Scheme::Shifting::shifts) {
      particles.refresh_ghosts(velocity);
      find_shifts(particles, dt);
      for_each_of_fluid(particles, [&](Index i) { x[i] += change_[i]; });
      by_.shift.swap(change_);
    }
    for_each_of_fluid(particles, [&](Index i) {
      x[i] += dt * (moved_with_.empty() ? u[i] : Vec(u[i] - moved_with_[i]));
    });
    energy_.end(particles, by_, forces_, time_step);
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
  using LaplacianStencil =
      mps::Stencil<Dim, Real, typename Scheme::Laplacian::template Weights<typename Scheme::Kernel, Dim>>;

  template <class P, class F>
  static void for_each_of_fluid(const P& particles, F&& f) {
    for_each(particles.size(), [&f, kinds = particles[kind]](Index i) {
      if (kinds[i] == Kind::fluid) f(i);
    });
  }

  double viscous() const { return viscous_limit(laplacian_, settings_.viscosity); }

  template <class P, class S>
  void find_neighbours(const P& particles, const S& search) {
    const Timed in_neighbours(seconds_.neighbours);
    around_.find(particles, search, stencil_);
    if (!one_neighbourhood()) around_laplacian_.find(particles, search, laplacian_);
    if constexpr (Scheme::Walls::smooth) normals_.find(particles, around_, stencil_);
  }

  template <class P, class S>
  void find_neighbours_of_moved(const P& particles, const S& search) {
    if (!around_.is_of(particles)) find_neighbours(particles, search);
  }

  // The Laplacian's weights and radius are those of the other operators.
  bool one_neighbourhood() const {
    return std::is_same_v<Stencil, LaplacianStencil> && stencil_.re == laplacian_.re;
  }
  const auto& around_laplacian() const {
    return one_neighbourhood() ? around_ : around_laplacian_;
  }

  // F at all that carries pressure, where it is not gravity alone.
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

  // Turns a pair with a wall particle into one along the wall's normal; false where it lies beside,
  // farther than the middle between wall particles, or behind.
  bool faces(CollidingPair<Dim, Real>& pair, const Vec& normal) const {
    const Vec along = normal.dot(pair.r_ij) * normal;
    const Real beside2 = (pair.r_ij - along).squaredNorm();
    if (beside2 > Real(0.2501) * (Dim - 1) * squared(pair.spacing)) return false;
    if (!(normal.dot(pair.r_ij) < 0)) return false;
    pair.r_ij = along;
    pair.r = along.norm();
    pair.u_ij = normal.dot(pair.u_ij) * normal;
    return true;
  }

  // Adds the change that a part of the step made to the velocities, and keeps it for the energies.
  template <class P>
  void apply_change(P& particles, std::vector<Vec>& part) {
    const auto u = particles[velocity];
    for_each_of_fluid(particles, [&](Index i) { u[i] += change_[i]; });
    part.swap(change_);
  }

  // Values of owned particles, asked for by ghosts as well.
  template <class P>
  struct OfOwners {
    const P& particles;
    const std::vector<Vec>& values;
    const Vec& operator[](Index j) const { return values[particles.owner(j)]; }
  };

  // n_i (5), the free surface (13), (17), and who carries pressure.
  template <class P>
  void find_density_and_surface(P& particles) {
    const auto n = particles[number_density];
    const auto on_surface = particles[surface];
    const auto kinds = particles.with_ghosts(kind);
    carries_pressure_.resize(particles.size());
    for_each(particles.size(), [&](Index i) {
      n[i] = around_.density(i);
      const LocalDensity local_density{.density = double(n[i] / stencil_.n0),
                              .neighbours = double(around_[i].size()) / double(stencil_.neighbours)};
      carries_pressure_[i] = kinds[i] != Kind::dummy;
      if constexpr (SurfaceByDensity<typename Scheme::Surface>) {
        on_surface[i] = settings_.surface.is_on_surface(local_density);
      } else {
        const SurfaceScale<Real> scale{.spacing = stencil_.spacing, .n0 = stencil_.n0};
        on_surface[i] = kinds[i] != Kind::dummy &&
                        settings_.surface.template is_on_surface<Dim, Real>(local_density, scale, [&](auto&& f) {
          for_each_weighted(around_, i, stencil_, [&](Index j, const Vec& r_ij, Real w, Real) {
            f(r_ij, w, kinds[i] != Kind::fluid || kinds[j] == Kind::fluid);
          });
        });
      }
      if (!Scheme::Walls::smooth || kinds[i] != Kind::wall) return;
      const bool is_wet = any_weighted(around_, i, stencil_,
                                       [&](Index j, Real) { return kinds[j] == Kind::fluid; });
      on_surface[i] |= !is_wet;
      carries_pressure_[i] = !on_surface[i];
    });
    if constexpr (balances_forces<typename Scheme::Source>() || Scheme::Shifting::shifts) {
      at_edge_.resize(particles.size());
      for_each(particles.size(), [&](Index i) {
        if (kinds[i] == Kind::dummy) return;
        at_edge_[i] = on_surface[i] || any_weighted(around_, i, stencil_, [&](Index j, Real) {
          const Index owner = particles.owner(j);
          return on_surface[owner] || !carries_pressure_[owner];
        });
      });
    }
  }

  // ∇²P = source      (9), (16)
  template <class P>
  void assemble(P& particles, double time_step) {
    using Source = typename Scheme::Source;
    const Timed in_assembly(seconds_.assembly);
    particles.refresh_ghosts(velocity);
    const auto kinds = particles.with_ghosts(kind);
    auto u = particles.with_ghosts(velocity);
    const auto n = particles[number_density];
    if constexpr (balances_forces<Source>()) {
      particles.refresh_ghosts(pressure);  // of the step before
      with_forced_solids_.assign(u.begin(), u.end());
      for_each(u.size(), [&](Index j) {
        if (kinds[j] != Kind::fluid) {
          with_forced_solids_[j] += Real(time_step) * force(particles.owner(j));
        }
      });
    }
    const auto carries = [&](Index i) { return carries_pressure_[i] != 0; };
    const auto source = [&](Index i) {
      SourceTerms terms{.density = settings_.density, .time_step = time_step};
      terms.compression = double((n[i] - stencil_.n0) / stencil_.n0);
      if constexpr (balances_forces<Source>()) {
        terms.divergence = double(divergence_of(particles, i, with_forced_solids_));
        terms.at_edge = at_edge_[i] != 0;
        terms.asymmetry = double(asymmetry(particles, i));
      } else if constexpr (Source::needs_divergence) {
        terms.divergence = double(divergence_of(particles, i, u));
      }
      if constexpr (needs_density_rate<Source>()) {
        terms.density_rate = double(density_rate(around_, stencil_, i, u));
        terms.last_density_rate = double(density_rate(around_, stencil_, i, OfOwners<P>{particles, before_}));
      }
      return settings_.source.value(terms);
    };
    equation_.assemble(particles, around_laplacian(), laplacian_, source, carries);
  }

  template <class P, class U>
  Real divergence_of(const P& particles, Index i, const U& u) const {
    if constexpr (Scheme::Walls::smooth) {
      return divergence_at_smooth_walls(particles, around_, normals_, stencil_, i, u);
    } else {
      return divergence(around_, stencil_, i, u);
    }
  }

  // What the Laplacian sums up of a pressure that rises linearly, by neighbours on one side only.
  template <class P>
  Real asymmetry(const P& particles, Index i) const {
    const Vec rise = pressure_gradient<CorrectedGradient>(particles, i);
    const Vec weight = Real(settings_.density) * force(i);
    Real sum = 0;
    for_each_weighted(around_laplacian(), i, laplacian_,
                      [&](Index j, const Vec& r_ij, Real w, Real) {
      const bool carries = carries_pressure_[particles.owner(j)];
      sum += w * r_ij.dot(carries ? rise : Vec(rise - weight));
    });
    return 2 * Dim / (laplacian_.lambda * laplacian_.n0) * sum;
  }

  // <∇P>_i over the neighbours with pressure.
  template <class Gradient, class P>
  Vec pressure_gradient(const P& particles, Index i) const {
    const auto p = particles.with_ghosts(pressure);
    return Gradient::evaluate(stencil_, p[i], [&](auto&& f) {
      for_each_weighted(around_, i, stencil_, [&](Index j, const Vec& r_ij, Real w, Real w_r2) {
        if (carries_pressure_[particles.owner(j)]) f(p[j], r_ij, w, w_r2);
      });
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
    const Real factor = -dt / Real(settings_.density);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      change_[i] = factor * pressure_gradient<typename Scheme::Gradient>(particles, i);
    });
  }

  // How far each fluid particle shifts beside the flow.
  template <class P>
  void find_shifts(const P& particles, Real dt) {
    const auto u = particles.with_ghosts(velocity);
    change_.resize(particles.size());
    for_each_of_fluid(particles, [&](Index i) {
      ShiftInput<Dim, Real> shift_input{.at_edge = at_edge_[i] != 0,
                                   .spacing = Real(settings_.spacing),
                                   .time_step = dt};
      for_each_weighted(around_, i, stencil_, [&](Index j, const Vec& r_ij, Real, Real w_r2) {
        shift_input.towards += (stencil_.spacing * w_r2 / stencil_.n0) * r_ij;
        shift_input.speed = std::max(shift_input.speed, (u[j] - u[i]).norm());
      });
      change_[i] = settings_.shifting.displacement(shift_input);
    });
  }

  template <class P>
  void refuse_failed(const P& particles) const {
    if (report_.reason == SolveReport::Reason::converged ||
        report_.reason == SolveReport::Reason::nothing_to_solve) {
      return;
    }
    const auto p = particles[pressure];  // those that the solve began from
    const Index broken = first_where(p.size(), [&](Index i) { return !is_finite(p[i]); });
    if (broken != no_index) {
      fail("mps::Flow: the pressure " + to_text(double(p[broken])) +
               " Pa is not finite; give the particle one",
           {.particle = broken, .id = particles.id(broken)});
    }
    fail("mps::Flow: the pressure solve stopped at a residual of " + to_text(report_.residual) +
         " after " + std::to_string(report_.iterations) + " iterations over " +
         std::to_string(report_.unknowns) +
         " unknowns; lower the time step, or allow more iterations or a larger tolerance");
  }

  Settings settings_;
  Solver solver_;
  Stencil stencil_;
  LaplacianStencil laplacian_;
  Neighbourhood<Dim, Real> around_;            // within the stencil
  Neighbourhood<Dim, Real> around_laplacian_;  // of the Laplacian, where its radius is another
  Vec gravity_ = Vec::Zero();
  PressureEquation equation_;
  SolveReport report_;
  FlowSeconds seconds_;
  TimeStep time_step_;
  EnergyAccount<Dim, Real> energy_;
  WallNormals<Dim, Real> normals_;
  std::vector<std::uint8_t> carries_pressure_;  // an unknown, or P = 0 on the surface
  std::vector<Vec> forces_;    // F at each particle, where it is not gravity alone
  std::vector<std::uint8_t> at_edge_;           // see SourceTerms
  std::vector<Vec> with_forced_solids_;  // u*, that of solids being Δt F, with ghosts
  std::vector<Vec> before_;    // u before the predictor
  double time_ = 0;
  std::vector<Vec> change_;      // of the fluid's velocity, by the part of the step under way
  StepChanges<Vec> by_;          // by its parts so far
  std::vector<Vec> moved_with_;  // velocity the predictor moved each particle with, if it did
};

}  // namespace silt::mps
