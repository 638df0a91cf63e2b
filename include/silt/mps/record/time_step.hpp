// SPDX-License-Identifier: MIT
// The time step of a flow: limits, and checks of a given step.
//
//   Courant     Δt ≤ C l0 / max(|u|, speed_scale)
//   force       Δt ≤ √(C l0 / max|F|)       for fluid at rest; F includes the body force
//   walls       Δt ≤ C l0 / max|V|, and a twentieth of their period
//   viscosity   Δt ≤ λ/(4 d ν)              half the stability limit, see viscous_limit()
//   growth      Δt ≤ max_growth × previous Δt
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/core/watch.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace silt::mps {

/// Limits of the next time step [s]; infinite if there is none.
struct TimeStepLimits {
  static constexpr double infinite = std::numeric_limits<double>::infinity();

  double courant = infinite;  ///< from the maximum speed and speed_scale
  double force = infinite;    ///< from gravity and the body force, for fluid at rest
  double viscous = infinite;  ///< from the viscosity
  double walls = infinite;    ///< from the speed and period of walls that move
  double growth = infinite;         ///< from the previous step
  double max_time_step = infinite;  ///< of FlowSettings

  /// The smallest limit [s].
  double smallest() const {
    return std::min({courant, force, viscous, walls, growth, max_time_step});
  }
  /// Throws if a wall needs steps so short that the fluid would not move in a run of any length.
  void check_walls() const {
    const double of_fluid = std::min({courant, force, viscous, max_time_step});
    constexpr double least = 1e-4;
    if (walls < least * of_fluid && is_finite(of_fluid)) fail_for_walls(of_fluid);
  }
  /// Which one is the smallest, and what to do about it.
  [[gnu::cold]] std::string name_of_smallest() const {
    const double dt = smallest();
    const std::string allow = " allows " + to_text(dt) + " s; ";
    if (dt == viscous) return "FlowSettings: viscosity" + allow + "decrease it";
    if (dt == max_time_step) return "FlowSettings: max_time_step" + allow + "increase it";
    if (dt == force) return "the acceleration by gravity and body_force" + allow + "decrease it";
    if (dt == walls)
      return "the speed or the period of a moving wall" + allow + "decrease the speed";
    if (dt == growth) return "FlowSettings: max_growth" + allow + "begin with a longer time step";
    return "the speed of the particles, or FlowSettings: speed_scale," + allow + "decrease it";
  }

 private:
  [[gnu::cold, noreturn]] void fail_for_walls(double of_fluid) const {
    fail({"mps::Flow: the speed or the period of a moving wall or a body needs time steps of ", walls,
          " s, less than a ten-thousandth of those of the fluid, ", of_fluid,
          " s; decrease its speed or frequency, and check its units"});
  }
};

/// λ/(4 d ν) [s], half the stability limit: the explicit viscous term is stable while Δt ν times
/// its largest eigenvalue, which is at most twice the row sum 2d/λ, is below 2.
template <class Stencil>
double viscous_limit(const Stencil& laplacian, double viscosity) {
  if (!(viscosity > 0)) return std::numeric_limits<double>::infinity();
  return double(laplacian.lambda) / (4 * Stencil::dimension * viscosity);
}

/// Computes the limits of the time step of a flow, and rejects unstable steps. Stores the previous
/// step.
class TimeStep {
 public:
  /// Input in addition to the settings [s].
  struct Input {
    double viscous;  ///< viscous_limit()
    double time;     ///< at which the body force is evaluated
  };

  /// The limits for the present velocities of the particles and the force on them. Throws if a
  /// velocity is not finite.
  template <FluidParticles P, class Settings>
  TimeStepLimits limits(const P& particles, const Settings& settings, const Input& input) const {
    TimeStepLimits limits{.viscous = input.viscous, .max_time_step = settings.max_time_step};
    const auto u = particles[velocity];
    const double fastest =
        std::sqrt(largest(u.size(), 0.0, [&](Index i) { return double(u[i].squaredNorm()); }));
    if (!is_finite(fastest)) {
      const auto is_broken = [&](Index i) { return !is_finite(double(u[i].squaredNorm())); };
      fail_too_fast(particles, settings, first_where(u.size(), is_broken), 0);
    }
    const double speed = std::max(fastest, settings.speed_scale);
    const double max_distance = settings.courant * settings.spacing;
    const double force = max_force(particles, settings, input.time);
    if (speed > 0) limits.courant = max_distance / speed;
    if (force > 0) limits.force = std::sqrt(max_distance / force);
    if (last_ > 0) limits.growth = settings.max_growth * last_;
    return limits;
  }

  /// Begins a step of dt [s]. Throws if it is unstable: if a particle would move by more than a
  /// spacing, because of its velocity or its acceleration from rest, or if dt exceeds twice the
  /// viscous limit. The growth limit is not enforced here.
  template <FluidParticles P, class Settings>
  void begin(const P& particles, const Settings& settings, const Input& input, double dt) {
    if (dt > 2 * input.viscous) {
      fail({"mps::Flow: time_step = ", dt, " s exceeds the viscous limit ", 2 * input.viscous,
            " s; lower it"});
    }
    const auto u = particles[velocity];
    const Index broken = first_where(u.size(), [&](Index i) {
      return !(double(u[i].norm()) * dt <= settings.spacing);  // also true for NaN
    });
    if (broken != no_index) fail_too_fast(particles, settings, broken, dt);
    const double force = max_force(particles, settings, input.time);
    if (dt * dt * force > settings.spacing) {
      fail({"mps::Flow: time_step = ", dt,
            " s moves a particle from rest by more than "
            "the spacing; use at most ",
            std::sqrt(settings.courant * settings.spacing / force), " s"});
    }
    last_ = dt;
  }

  /// Ends a step. Throws if a particle moved by more than a spacing.
  template <FluidParticles P, class Settings>
  void end(const P& particles, const Settings& settings, const FinishedStep& step) const {
    const double most = settings.spacing;
    const Index fast = find_too_far_moved(particles, step, most, [=](Index) { return most; });
    if (fast == no_index) return;
    const auto u = particles[velocity][fast];
    fail({"mps::Flow: velocity = ", to_text(typename P::Vec(u)), " m/s moved a particle by ",
          double(u.norm()) * step.time_step, " m in a step, more than the spacing ",
          settings.spacing, " m; lower the time step"},
         {.particle = fast, .id = particles.id(fast)});
  }

  /// Whether no step was begun, also in the run from which a checkpoint was read.
  bool is_first() const noexcept { return last_ == 0; }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("last_time_step", last_);
  }

 private:
  // |F| [m/s²]
  template <class P, class Settings>
  static double max_force(const P& particles, const Settings& settings, double time) {
    if (!settings.body_force) return settings.gravity.norm();
    const auto x = particles[position];
    const auto kinds = particles[kind];
    const auto force_at = [&](Index i) {
      return settings.body_force(x[i].template cast<double>(), time);
    };
    const double most = largest(particles.size(), 0.0, [&](Index i) {
      const double force = (settings.gravity + force_at(i)).norm();
      if (!is_finite(force)) return TimeStepLimits::infinite;
      return kinds[i] == Kind::fluid ? force : 0.0;
    });
    if (is_finite(most)) return most;
    const Index broken = first_where(particles.size(), [&](Index i) {
      return !is_finite((settings.gravity + force_at(i)).norm());
    });
    fail({"FlowSettings: body_force = ", to_text(force_at(broken)), " m/s² at ",
          to_text(typename P::Vec(x[broken])), " m and ", time,
          " s is not finite or its square overflows; return a finite acceleration"},
         {.particle = broken, .id = particles.id(broken)});
  }

  template <class P, class Settings>
  [[noreturn]] static void fail_too_fast(const P& particles, const Settings& settings, Index broken,
                                         double dt) {
    const Where where{.particle = broken, .id = particles.id(broken)};
    const auto u = particles[velocity][broken];
    const double speed = double(u.norm());
    if (!is_finite(speed)) {
      fail({"mps::Flow: the velocity ", to_text(u),
            " m/s is not finite or its square overflows; set a finite velocity"},
           where);
    }
    fail({"mps::Flow: time_step = ", dt, " s moves a particle of ", speed,
          " m/s by more than the spacing; use at most ",
          settings.courant * settings.spacing / speed, " s"},
         where);
  }

  double last_ = 0;  // previous step [s]; 0 before the first
};

}  // namespace silt::mps
