// SPDX-License-Identifier: MIT
// The hydrostatic tank of [HwangLeePark2010] section 3: water at rest under gravity, with known
// pressure.
#pragma once

#include <silt/mps.hpp>

#include <cmath>
#include <utility>

namespace silt::test {

/// Pressure on the floor of the tank.
struct FloorPressure {
  double mean = 0;     // over time [Pa]
  double scatter = 0;  // standard deviation over time, divided by the mean [-]
};

/// Simulates the tank and averages the pressure of the wall particles of the floor whose distance
/// from its middle is at most a quarter of the length, from time `from` to `until`. A single point
/// would not do: one particle of fluid that is displaced changes the pressure near it by 4 %.
template <class Scheme, int Dim>
FloorPressure floor_pressure(const mps::Tank<Dim>& tank, double from, double until) {
  Simulation sim{mps::make_tank(tank), UniformGrid<Dim>{},
                 mps::Flow<Scheme, Dim>({.spacing = tank.spacing, .max_time_step = 1e-3}),
                 SemiImplicit{}};
  Vec<Dim> middle = Vec<Dim>::Zero();
  middle[0] = tank.size.length / 2;
  if constexpr (Dim == 3) middle[1] = tank.size.depth / 2;
  middle[Dim - 1] = -tank.spacing / 2;
  double sum = 0;
  double squares = 0;
  double span = 0;
  while (sim.time() < until) {
    sim.step();
    if (sim.time() < from) continue;
    const auto& particles = sim.particles();
    double pressure = 0;
    int number = 0;
    for (Index i = 0; i < particles.size(); ++i) {
      if (particles[mps::kind][i] != mps::Kind::wall) continue;
      const Vec<Dim> from_middle = particles[position][i] - middle;
      if (std::abs(from_middle[Dim - 1]) > 0.25 * tank.spacing) continue;
      if (from_middle.norm() > tank.size.length / 4) continue;
      pressure += particles[mps::pressure][i];
      ++number;
    }
    const double dt = sim.last_time_step();
    pressure /= number;
    sum += dt * pressure;
    squares += dt * pressure * pressure;
    span += dt;
  }
  const double mean = sum / span;
  return {mean, std::sqrt(squares / span - mean * mean) / mean};
}

}  // namespace silt::test
