// SPDX-License-Identifier: MIT
// Whether a step of a flow gave speeds or energies that nothing had: see core/watch.hpp.
#pragma once

#include <silt/core/error.hpp>
#include <silt/core/parallel.hpp>
#include <silt/core/processes.hpp>
#include <silt/core/types.hpp>
#include <silt/mps/fluid/body_force.hpp>
#include <silt/mps/fluid/fluid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace silt::mps {

/// What the fluid has had so far. The pressure may concentrate it in single particles, as in the jets
/// of impacts, but not tenfold.
template <int Dim, class Real>
class FlowWatch {
 public:
  using Vec = silt::Vec<Dim, Real>;

  /// Before a step of dt [s] changes any velocity; kinetic [J] is the energy of the fluid then,
  /// speed_of_walls [m/s] that of the fastest wall without particles.
  template <FluidParticles P>
  void begin(const P& particles, const BodyForce<Dim, Real>& force, double dt, double kinetic,
             double speed_of_walls = 0) {
    const auto x = particles[position];
    const auto kinds = particles[kind];
    const Vec g = force.gravity();
    const auto largest_of_fluid = [&](const auto& value) {
      constexpr double none = -std::numeric_limits<double>::max();
      return largest(x.size(), none,
                     [&](Index i) { return kinds[i] == Kind::fluid ? double(value(i)) : none; });
    };
    // In a periodic box, a fall has no end.
    Vec endless = Vec::Zero();
    for (int axis = 0; axis < Dim; ++axis) {
      if (particles.box().periodic[std::size_t(axis)]) endless[axis] = g[axis];
    }
    const auto [fastest, highest, minus_lowest, largest_further] = silt::detail::largest_of_all(
        particles,
        std::array{fastest_of(particles), largest_of_fluid([&](Index i) { return -g.dot(x[i]); }),
                   largest_of_fluid([&](Index i) { return g.dot(x[i]); }),
                   largest_of_fluid([&](Index i) { return Vec(force[i] - g + endless).norm(); })});
    // Faster than after the last step: a speed that was set, or of a wall.
    now_.given_speed = std::max(now_.given_speed, speed_of_walls);
    speed_of_walls_ = speed_of_walls;
    if (fastest > now_.fastest) now_.given_speed = std::max(now_.given_speed, fastest);
    now_.highest_potential = std::max(now_.highest_potential, highest);
    now_.lowest_potential = std::min(now_.lowest_potential, -minus_lowest);
    const double further = std::max(0.0, largest_further);
    now_.speed_of_forces += dt * further;
    kinetic_ = kinetic;
    speed_of_step_ = dt * (further + double(g.norm()));
  }
  /// After it.
  template <FluidParticles P>
  void end(const P& particles) {
    now_.fastest = silt::detail::largest_of_all(particles, std::array{fastest_of(particles)})[0];
  }

  /// Throws if a particle is more than ten times faster than the fluid was at first, or would be after
  /// its deepest fall and with the forces so far; or if, between walls at rest, the kinetic energy
  /// [J] is more than ten times what there was before the step and what the forces give in it. mass
  /// [kg] is that of a particle, dt [s] the step.
  template <FluidParticles P, class Settings>
  void check(const P& particles, const Settings& settings, double kinetic, double mass,
             double dt) const {
    constexpr double factor = 10;
    constexpr const char* advice =
        "reduce the Courant number, let particles be kept apart, or check walls that are thinner "
        "than the effective radius";
    const double fall = std::max(0.0, now_.highest_potential - now_.lowest_potential);
    const double usual =
        std::max(settings.speed_scale, std::sqrt(squared(now_.given_speed) + 2 * fall) +
                                           now_.speed_of_forces + speed_of_step_);
    const double noise = 1e-3 * settings.spacing / dt;  // of fluid at rest [m/s]
    const double disorder = 0.1 * settings.spacing / dt;  // that the pressure resolves [m/s]
    const auto u = particles[velocity];
    if (now_.fastest > factor * (usual + noise)) {
      const Index i =
          first_where(u.size(), [&](Index k) { return double(u[k].norm()) >= now_.fastest; });
      if (i == no_index) return;  // it is one of another process
      fail({"mps::Flow: velocity = ", to_text(Vec(u[i])), " m/s is more than ten times ", usual,
            " m/s, the speed of the fluid at first and of its deepest fall; ", advice},
           {.particle = i, .id = particles.id(i)});
    }
    const auto kinds = particles[kind];
    const Index moving_wall = first_where(
        u.size(), [&](Index i) { return kinds[i] != Kind::fluid && !(u[i].norm() == 0); });
    const auto [number, moving_walls] = silt::detail::sum_of_all(
        particles, std::array{double(count(particles, Kind::fluid)),
                              moving_wall == no_index ? 0.0 : 1.0});
    const double there =
        kinetic_ + 0.5 * mass * number *
                       (squared(speed_of_step_) + squared(disorder) + squared(speed_of_walls_));
    if (moving_walls == 0 && kinetic > factor * there) {
      fail({"mps::Flow: the kinetic energy after the step, ", kinetic,
            " J, is more than ten times that before it and of the forces in it, ", there, " J; ",
            advice});
    }
  }

  template <class Archive>
  void transfer(Archive& archive) {
    archive("given_speed", now_.given_speed);
    archive("highest_potential", now_.highest_potential);
    archive("lowest_potential", now_.lowest_potential);
    archive("speed_of_forces", now_.speed_of_forces);
    archive("fastest", now_.fastest);
  }

 private:
  struct State {
    double given_speed = 0;  // the fastest at first, or set between steps [m/s]
    // Per mass, −g·x, where its deepest fall would begin and end [m²/s²].
    double highest_potential = -std::numeric_limits<double>::max();
    double lowest_potential = std::numeric_limits<double>::max();
    double speed_of_forces = 0;  // ∫ |F| dt without gravity [m/s]
    double fastest = 0;          // after the last step [m/s]
  };

  template <class P>
  static double fastest_of(const P& particles) {
    const auto u = particles[velocity];
    return largest(u.size(), 0.0, [&](Index i) { return double(u[i].norm()); });
  }

  State now_;
  double kinetic_ = 0;        // before the step [J]
  double speed_of_step_ = 0;  // |F| dt [m/s]
  double speed_of_walls_ = 0;  // [m/s]
};

}  // namespace silt::mps
