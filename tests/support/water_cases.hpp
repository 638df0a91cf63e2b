// SPDX-License-Identifier: MIT
// What the tests of water and its loads measure, for any scheme.
#pragma once

#include "support/water_loads.hpp"

#include <silt/core/lattice.hpp>
#include <silt/geometry/shapes.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace silt::test {

/// n/n0 of the fluid that is not on the surface.
template <class Sim>
double mean_density(const Sim& sim) {
  const auto& water = sim.particles();
  double sum = 0, number = 0;
  for (Index i = 0; i < water.size(); ++i) {
    if (water[mps::surface][i] || water[mps::kind][i] != mps::Kind::fluid) continue;
    sum += water[mps::number_density][i] / sim.interaction().stencil().n0;
    number += 1;
  }
  return sum / number;
}

template <class P>
double largest_speed(const P& particles) {
  double largest = 0;
  for (const auto& u : particles[velocity]) largest = std::max(largest, u.norm());
  return largest;
}

template <class P>
double median_speed(const P& particles) {
  std::vector<double> speeds;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] == mps::Kind::fluid) speeds.push_back(particles[velocity][i].norm());
  }
  const auto middle = speeds.begin() + std::ptrdiff_t(speeds.size() / 2);
  std::ranges::nth_element(speeds, middle);
  return *middle;
}

struct JetForce {
  double pressure;  ///< mean force of the pressures on the wall over ρ U² b
  double load;      ///< that of the wall, with walls of faces
  double momentum;  ///< that of the change of momentum
  double rise;      ///< largest, of the energy
};

/// A jet 0.1 m wide at 2 m/s against a wall, without gravity, while it is steady, begun off the lattice
/// by a jitter [spacings].
template <class Scheme = WaterScheme>
JetForce jet_force(double l0, double jitter = 0) {
  constexpr double U = 2, b = 0.1, side = 1.2;
  const Box<2> room{.lower = {0, 0}, .upper = {side, side}};
  const WaterScene scene{.spacing = l0,
                         .water = {{{side / 2, (side - b) / 2}, {side, (side + b) / 2}}},
                         .velocity = {U, 0},
                         .walls = faces_of(room),
                         .room = {room},
                         .gravity = {0, 0},
                         .jitter = jitter};
  auto sim = scene.simulation<Scheme>();
  double pressure = 0, load = 0, span = 0, first = 0, last = 0;
  const double rise = run_water(sim, 0.12, [&](const auto& water, double dt) {
    last = horizontal_momentum(water, scene.mass());
    if (sim.time() < 0.06) return void(first = last);
    pressure += dt * pressure_load_on(water, {side, 0, side, -1}, l0);
    load += dt * load_on(sim, {side, 0, side, -1});
    span += dt;
  });
  const double force = 1000 * U * U * b * span;
  return {pressure / force, load / force, (first - last) / force, rise};
}

struct ImpactOfADam {
  /// Of the pressures on the right wall from what the change of momentum leaves for it, in windows of
  /// 0.1 s from 0.4 s.
  std::vector<double> deviations;
  std::vector<double> loads;       ///< of the right wall in these windows, with walls of faces [N s/m]
  double rise;                     ///< largest, of the energy
  Index lost;                      ///< particles behind walls at the end
};

/// A dam break of 0.4 m × 0.8 m against a wall at 1.6 m, begun off the lattice by a jitter [spacings].
template <class Scheme = WaterScheme>
ImpactOfADam impact_of_a_dam(double l0, double until, double jitter = 0) {
  const WaterScene scene{.spacing = l0,
                         .water = {{{0, 0}, {0.4, 0.8}}},
                         .walls = polyline({{0, 3}, {0, 0}, {1.6, 0}, {1.6, 3}}),
                         .room = {{{0, 0}, {1.6, 3}}},
                         .speed_scale = 2.8,
                         .jitter = jitter};
  auto sim = scene.simulation<Scheme>();
  ImpactOfADam found{};
  double pressure = 0, left = 0, load = 0, momentum = 0, end = 0.4;
  found.rise = run_water(sim, until, [&](const auto& water, double dt) {
    pressure += dt * pressure_load_on(water, {1.6, 0, 1.6, -1}, l0);
    load += dt * load_on(sim, {1.6, 0, 3, -1});
    left += dt * pressure_load_on(water, {0, 0, 1, 1}, l0);
    if (sim.time() < end) return;
    const double now = horizontal_momentum(water, scene.mass());
    if (end > 0.45) {
      found.deviations.push_back(pressure / (momentum - now + left) - 1);
      found.loads.push_back(load);
    }
    momentum = now, pressure = load = left = 0, end += 0.1;
  });
  const auto& water = sim.particles();
  for (Index i = 0; i < water.size(); ++i) {
    const auto& x = water[position][i];
    if (water[mps::kind][i] != mps::Kind::fluid) continue;
    if (x[0] < 0 || x[0] > 1.6 || x[1] < 0) ++found.lost;
  }
  return found;
}

struct LoadOfAnObstacle {
  std::vector<double> rows;  ///< pressure on the face over that of the water beside it, from below
  double impact;             ///< deviation of pressures from momentum, 0.45 to 0.6 s
  double later;              ///< the same, 0.6 to 1.2 s
  double rise;               ///< largest, of the energy
};

/// A block of 0.16 m in the way of a dam break. From 0.8 s on, water is before it and above.
template <class Scheme = WaterScheme>
LoadOfAnObstacle load_of_an_obstacle(double l0) {
  constexpr double face = 2.4, back = 2.56, end = 3.2, top = 0.16;
  const WaterScene scene{
      .spacing = l0,
      .water = {{{0, 0}, {1.2, 0.56}}},
      .walls = polyline({{0, 2}, {0, 0}, {face, 0}, {face, top}, {back, top}, {back, 0}, {end, 0},
                         {end, 2}}),
      .room = {{{0, 0}, {face, 2}}, {{0, top}, {end, 2}}, {{back, 0}, {end, 2}}},
      .speed_scale = 2.4};
  auto sim = scene.simulation<Scheme>();
  const auto rows = static_cast<std::size_t>(std::lround(top / l0));
  std::vector<double> on_face(rows, 0), beside(rows, 0);
  // The fluid that is still behind loads the left wall.
  double load = 0, left = 0, momentum = 0, end_of_window = 0.45;
  std::vector<double> deviations;
  const double rise = run_water(sim, 1.2, [&](const auto& water, double dt) {
    load += dt * (pressure_load_on(water, {face, 0, top, -1}, l0) -
                  pressure_load_on(water, {back, 0, top, 1}, l0) +
                  pressure_load_on(water, {end, 0, 1.6, -1}, l0));
    left += dt * pressure_load_on(water, {0, 0, 0.8, 1}, l0);
    if (sim.time() >= end_of_window) {
      const double now = horizontal_momentum(water, scene.mass());
      deviations.push_back(load / (momentum - now + left) - 1);
      momentum = now, load = left = 0;
      end_of_window = deviations.size() == 1 ? 0.6 : 1.2;
    }
    if (sim.time() < 0.8) return;
    for (std::size_t k = 0; k < rows; ++k) {
      const double y = double(k) * l0;
      on_face[k] += dt * pressure_on(water, {face, y, y + l0, -1}, l0);
      const Vec<2> in_fluid{face - l0 / 2, y + l0 / 2};
      double sum = 0, number = 0;
      for (Index i = 0; i < water.size(); ++i) {
        if ((water[position][i] - in_fluid).cwiseAbs().maxCoeff() > 0.75 * l0) continue;
        if (water[mps::kind][i] != mps::Kind::fluid) continue;
        sum += water[mps::pressure][i], number += 1;
      }
      if (number > 0) beside[k] += dt * sum / number;
    }
  });
  LoadOfAnObstacle found{
      .rows = on_face, .impact = deviations[1], .later = deviations[2], .rise = rise};
  for (std::size_t k = 0; k < rows; ++k) found.rows[k] /= beside[k];
  return found;
}

struct SwingsOfAUTube {
  std::vector<double> maxima;  ///< of the kinetic energy, over the initial energy
  double density;              ///< mean of n/n0 at the end
  double rise;                 ///< largest, of the energy
};

/// Two shafts of 0.1 m, with water 0.26 m and 0.14 m above the channel that connects them, for 2.2 s.
template <class Scheme = WaterScheme>
SwingsOfAUTube swings_of_a_u_tube(double l0) {
  auto walls = polyline({{0, 1}, {0, 0}, {0.3, 0}, {0.3, 1}});
  for (const auto& face : polyline({{0.1, 1}, {0.1, 0.1}, {0.2, 0.1}, {0.2, 1}})) {
    walls.push_back(face);
  }
  const WaterScene scene{
      .spacing = l0,
      .water = {{{0, 0}, {0.3, 0.1}}, {{0, 0.1}, {0.1, 0.36}}, {{0.2, 0.1}, {0.3, 0.24}}},
      .walls = walls,
      .room = {{{0, 0}, {0.3, 0.1}}, {{0, 0}, {0.1, 1}}, {{0.2, 0}, {0.3, 1}}},
      .speed_scale = 1.5};
  auto sim = scene.simulation<Scheme>();
  std::vector<double> time, kinetic;
  SwingsOfAUTube found{};
  found.rise = run_water(sim, 2.2, [&](const auto&, double) {
    time.push_back(sim.time());
    kinetic.push_back(sim.interaction().energy().kinetic);
  });
  found.density = mean_density(sim);
  // Swings are half a second apart.
  constexpr double apart = 0.15;
  for (std::size_t k = 0; k < time.size(); ++k) {
    if (time[k] < apart || time[k] > time.back() - apart) continue;
    bool is_maximum = true;
    for (std::size_t m = 0; m < time.size(); ++m) {
      if (std::abs(time[m] - time[k]) < apart && kinetic[m] > kinetic[k]) is_maximum = false;
    }
    if (is_maximum) found.maxima.push_back(kinetic[k] / sim.interaction().energy().initial);
  }
  return found;
}

/// The largest speed until a time [s] of water around a block of 0.16 m × 0.2 m, 0.2 m below its
/// surface [m/s]; all of it turned by an angle.
template <class Scheme = WaterScheme>
double speed_around_a_block(double l0, double until, double angle = 0) {
  const WaterScene scene{
      .spacing = l0,
      .water = {{{0, 0}, {0.12, 0.2}}, {{0.28, 0}, {0.4, 0.2}}, {{0, 0.2}, {0.4, 0.4}}},
      .walls = polyline({{0, 0.6}, {0, 0}, {0.12, 0}, {0.12, 0.2}, {0.28, 0.2}, {0.28, 0}, {0.4, 0},
                         {0.4, 0.6}}),
      .room = {{{0, 0}, {0.12, 0.6}}, {{0.28, 0}, {0.4, 0.6}}, {{0, 0.2}, {0.4, 0.6}}},
      .angle = angle};
  auto sim = scene.simulation<Scheme>();
  double largest = 0;
  run_water(sim, until, [&](const auto& water, double) {
    largest = std::max(largest, largest_speed(water));
  });
  return largest;
}

struct RestOfATank {
  double median, largest;  ///< speeds at the end [m/s]
  double load;             ///< of a wall over ρ g H²/2
  double rise;             ///< largest, of the energy
};

/// A tank of 0.4 m × 0.4 m begun 0.2 l0 off the lattice, after 3 s.
template <class Scheme = WaterScheme>
RestOfATank rest_of_a_tank(double l0) {
  constexpr double side = 0.4;
  const WaterScene scene{.spacing = l0,
                         .water = {{{0, 0}, {side, side}}},
                         .walls = polyline({{0, 1}, {0, 0}, {side, 0}, {side, 1}}),
                         .room = {{{0, 0}, {side, 1}}},
                         .jitter = 0.2};
  auto sim = scene.simulation<Scheme>();
  const double rise = run_water(sim, 3, [](const auto&, double) {});
  const auto& water = sim.particles();
  const double load = pressure_load_on(water, {side, 0, 1.2 * side, -1}, l0);
  return {.median = median_speed(water),
          .largest = largest_speed(water),
          .load = load / (1000 * 9.81 * side * side / 2),
          .rise = rise};
}

}  // namespace silt::test
