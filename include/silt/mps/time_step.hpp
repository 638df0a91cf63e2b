// SPDX-License-Identifier: MIT
// The time step of a flow: what limits it, and what is refused.
//
//   Courant     Δt ≤ C l0 / max(|u|, speed_scale)
//   fall        Δt ≤ √(C l0 / |F|)          from rest no speed says how fast it gets; F with the
//                                           body force, where it is largest
//   viscosity   Δt ≤ λ/(4 d ν)              half of what is stable, see viscous_limit()
//   growth      Δt ≤ max_growth Δt of the step before
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace silt::mps {

/// Limits of the next time step [s], infinite where there is none.
struct TimeStepLimits {
  double courant = std::numeric_limits<double>::infinity();  ///< fastest particle, speed scale
  double fall = std::numeric_limits<double>::infinity();     ///< from rest
  double viscous = std::numeric_limits<double>::infinity();
  double growth = std::numeric_limits<double>::infinity();   ///< over the step before
  double largest = std::numeric_limits<double>::infinity();  ///< the user's

  double smallest() const { return std::min({courant, fall, viscous, growth, largest}); }
};

/// λ/(4 d ν) [s]: the explicit viscous term is stable while Δt ν times its largest eigenvalue, at
/// most twice the row's sum 2d/λ, stays below 2; half of that is taken.
template <class Stencil>
double viscous_limit(const Stencil& laplacian, double viscosity) {
  if (!(viscosity > 0)) return std::numeric_limits<double>::infinity();
  return double(laplacian.lambda) / (4 * Stencil::dimension * viscosity);
}

/// Chooses the time step of a flow, from FlowSettings and the limit of its viscosity, and refuses
/// one that is beyond stability. It remembers the step before.
class TimeStep {
 public:
  /// What a flow knows beside its settings [s].
  struct Given {
    double viscous;  ///< viscous_limit()
    double time;     ///< for which the body force is asked
  };

  template <FluidParticles P, class Settings>
  TimeStepLimits limits(const P& particles, const Settings& settings, const Given& given) const {
    TimeStepLimits limits{.viscous = given.viscous, .largest = settings.max_time_step};
    const auto u = particles[velocity];
    const double fastest = std::sqrt(
        largest(u.size(), 0.0, [&](Index i) { return double(u[i].squaredNorm()); }));
    const double speed = std::max(fastest, settings.speed_scale);
    const double way = settings.courant * settings.spacing;
    const double pull = largest_force(particles, settings, given.time);
    if (speed > 0) limits.courant = way / speed;
    if (pull > 0) limits.fall = std::sqrt(way / pull);
    if (last_ > 0) limits.growth = settings.max_growth * last_;
    return limits;
  }

  /// Notes dt [s] as that of the step under way. Throws if it is beyond stability: if a particle
  /// passes a spacing, by its velocity or by falling, or dt exceeds twice the viscous limit. Growth
  /// is limited only where the flow itself chooses.
  template <FluidParticles P, class Settings>
  void begin(const P& particles, const Settings& settings, const Given& given, double dt) {
    if (dt > 2 * given.viscous) {
      fail("mps::Flow: time_step = " + to_text(dt) + " s exceeds the viscous limit " +
           to_text(2 * given.viscous) + " s; lower it");
    }
    const auto u = particles[velocity];
    const Index broken = first_where(u.size(), [&](Index i) {
      return !(double(u[i].norm()) * dt <= settings.spacing);  // so that a NaN is one
    });
    if (broken != no_index) refuse(particles, settings, broken, dt);
    const double pull = largest_force(particles, settings, given.time);
    if (dt * dt * pull > settings.spacing) {
      fail("mps::Flow: time_step = " + to_text(dt) + " s lets a particle fall by more than the "
           "spacing from rest; take at most " +
           to_text(std::sqrt(settings.courant * settings.spacing / pull)) + " s");
    }
    last_ = dt;
  }

  void save() noexcept { saved_ = last_; }
  void restore() noexcept { last_ = saved_; }
  template <class Archive>
  void transfer(Archive& archive) {
    archive("last_time_step", last_);
  }

 private:
  // |F| [m/s²]
  template <class P, class Settings>
  static double largest_force(const P& particles, const Settings& settings, double time) {
    if (!settings.body_force) return settings.gravity.norm();
    const auto x = particles[position];
    const auto kinds = particles[kind];
    return largest(particles.size(), 0.0, [&](Index i) {
      if (kinds[i] != Kind::fluid) return 0.0;
      const auto force = settings.body_force(x[i].template cast<double>(), time);
      return double((settings.gravity + force).norm());
    });
  }

  template <class P, class Settings>
  [[noreturn]] static void refuse(const P& particles, const Settings& settings, Index broken,
                                  double dt) {
    const Where where{.particle = broken, .id = particles.id(broken)};
    const auto u = particles[velocity][broken];
    const double speed = double(u.norm());
    if (!is_finite(speed)) {
      fail("mps::Flow: the velocity " + to_text(u) + " m/s is not finite; give the particle one",
           where);
    }
    fail("mps::Flow: time_step = " + to_text(dt) + " s moves a particle of " + to_text(speed) +
             " m/s by more than the spacing; take at most " +
             to_text(settings.courant * settings.spacing / speed) + " s",
         where);
  }

  double last_ = 0;   // [s]; 0 before the first
  double saved_ = 0;
};

}  // namespace silt::mps
