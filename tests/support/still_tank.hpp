// SPDX-License-Identifier: MIT
// The hydrostatic tank of [HwangLeePark2010] section 3: water at rest under gravity, with known
// pressure.
#pragma once

#include <silt/measure/wall_gauge.hpp>
#include <silt/mps.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace silt::test {

/// Pressure on the floor of the tank.
struct FloorPressure {
  double mean = 0;     // over time [Pa]
  double scatter = 0;  // standard deviation over time, divided by the mean [-]
};

/// Mean pressure on the floor, at distances of up to a quarter of the tank's length from its middle:
/// of the wall particles, or of gauges a spacing apart. A single point would not do: one particle of
/// fluid that is displaced changes the pressure near it by 4 %.
template <int Dim, class P>
double pressure_on_floor(const mps::Tank<Dim>& tank, const P& particles) {
  const double l0 = tank.spacing, most = tank.size.length / 4;
  Vec<Dim> middle = Vec<Dim>::Zero();
  middle[0] = tank.size.length / 2;
  if constexpr (Dim == 3) middle[1] = tank.size.depth / 2;
  double sum = 0;
  int number = 0;
  if (mps::count(particles, mps::Kind::wall) == 0) {
    const int n = static_cast<int>(most / l0);
    for (int y = Dim == 3 ? -n : 0; y <= (Dim == 3 ? n : 0); ++y) {
      for (int x = -n; x <= n; ++x) {
        Vec<Dim> point = middle + x * l0 * Vec<Dim>::Unit(0);
        if constexpr (Dim == 3) point[1] += y * l0;
        if ((point - middle).norm() > most) continue;
        sum += WallGauge<Dim>{point, Vec<Dim>::Unit(Dim - 1), l0}.read(particles, mps::pressure);
        ++number;
      }
    }
    return sum / number;
  }
  middle[Dim - 1] = -l0 / 2;
  for (Index i = 0; i < particles.size(); ++i) {
    if (particles[mps::kind][i] != mps::Kind::wall) continue;
    const Vec<Dim> from_middle = particles[position][i] - middle;
    if (std::abs(from_middle[Dim - 1]) > 0.25 * l0 || from_middle.norm() > most) continue;
    sum += particles[mps::pressure][i];
    ++number;
  }
  return sum / number;
}

/// Simulates the tank and averages the pressure on its floor from time `from` to `until`.
template <class Scheme, int Dim>
FloorPressure floor_pressure(const mps::Tank<Dim>& tank, double from, double until) {
  const auto made = mps::make_tank<Scheme>(tank);
  Simulation sim{made.particles, UniformGrid<Dim>{},
                 mps::Flow<Scheme, Dim>(
                     {.spacing = tank.spacing, .max_time_step = 1e-3, .walls = made.walls}),
                 SemiImplicit{}};
  double sum = 0;
  double squares = 0;
  double span = 0;
  while (sim.time() < until) {
    sim.step();
    if (sim.time() < from) continue;
    const double pressure = pressure_on_floor(tank, sim.particles());
    const double dt = sim.last_time_step();
    sum += dt * pressure;
    squares += dt * pressure * pressure;
    span += dt;
  }
  const double mean = sum / span;
  return {mean, std::sqrt(std::max(0.0, squares / span - mean * mean)) / mean};
}

}  // namespace silt::test
