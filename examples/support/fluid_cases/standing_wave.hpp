// SPDX-License-Identifier: MIT
// A standing wave of small amplitude on water of finite depth, periodic along x (J. Lighthill, Waves
// in Fluids, 1978).
#pragma once

#include "bodies.hpp"
#include "fluid_case.hpp"
#include "oscillation.hpp"

#include <numbers>

namespace fluid_cases {

struct StandingWave {
  double length = 1;       ///< λ [m]
  double depth = 0.5;      ///< d [m]
  double amplitude = 0.02; ///< a [m]
  double gravity = 9.81;   ///< g [m/s²]

  double wave_number() const { return 2 * std::numbers::pi / length; }
  /// ω² = g k tanh(k d) [1/s²].
  double frequency() const {
    return std::sqrt(gravity * wave_number() * std::tanh(wave_number() * depth));
  }
  double period() const { return 2 * std::numbers::pi / frequency(); }
  /// Velocity when the surface is flat; x from a later crest, y above the floor.
  Vec<2> velocity_at(const Vec<2>& x) const {
    const double k = wave_number();
    const double scale = amplitude * gravity * k / frequency() / std::cosh(k * depth);
    return {-scale * std::cosh(k * x[1]) * std::sin(k * x[0]),
            scale * std::sinh(k * x[1]) * std::cos(k * x[0])};
  }
  double elevation(double time) const { return amplitude * std::sin(frequency() * time); }
};

/// `along` particles per wavelength, for ten periods.
inline FluidCase standing_wave(int along) {
  const StandingWave exact;
  const double l0 = exact.length / along;
  constexpr int layers = 5;
  Box<2> box{.lower = {0, -layers * l0}, .upper = {exact.length, exact.depth}};
  Box<2> space = box;
  space.periodic = {true, false};
  space.upper[1] = 3 * exact.depth;
  FluidCase flow{.name = "standing_wave", .spacing = l0};
  flow.start = mps::Fluid<2>(space);
  for (const auto& x : lattice<2>(box, l0)) {
    if (x[1] < 0) {
      flow.wall_particles.push_back({x, x[1] > -l0 ? mps::Kind::wall : mps::Kind::dummy});
      continue;
    }
    const Index i = mps::add_particle(flow.start, x, mps::Kind::fluid);
    flow.start[velocity][i] = exact.velocity_at(x);
  }
  flow.walls = polyline({{-exact.length, 0}, {2 * exact.length, 0}});
  flow.viscosity = 1e-6;
  flow.gravity = {0, -exact.gravity};
  flow.speed_scale = std::sqrt(exact.gravity * exact.depth);
  flow.until = 10.3 * exact.period();
  flow.note_every = exact.period() / 100;
  flow.names = {"t", "elevation", "elevation_exact", "energy", "mean_height"};
  flow.note = [=](const mps::Fluid<2>& fluid, double time) -> std::vector<double> {
    // ∫∫ cos(k x) dx dy over the fluid below d + η cos(k x) is η λ/2.
    double sum = 0, energy = 0, height = 0, number = 0;
    for (Index i = 0; i < fluid.size(); ++i) {
      if (fluid[mps::kind][i] != mps::Kind::fluid) continue;
      sum += std::cos(exact.wave_number() * fluid[position][i][0]);
      energy += fluid[velocity][i].squaredNorm() / 2;
      height += fluid[position][i][1];
      number += 1;
    }
    return {time, 2 * l0 * l0 / exact.length * sum, exact.elevation(time), energy / number,
            height / number};
  };
  flow.findings = [=](const History& history) -> std::vector<Finding> {
    const auto& t = history["t"];
    const auto& eta = history["elevation"];
    const auto max_within = [&](double from) {
      double highest = 0;
      for (Index k = 0; k < t.size(); ++k) {
        const double periods = t[k] / exact.period();
        if (periods >= from && periods < from + 1) highest = std::max(highest, std::abs(eta[k]));
      }
      return highest / exact.amplitude;
    };
    return {{"period, mean of ten [s]", exact.period(), mean_period(zero_crossings(t, eta), 10),
             0.02},
            {"amplitude in the first period [a]", 1, max_within(0), 0.1},
            {"amplitude in the tenth period [a]", 1, max_within(9), stated}};
  };
  return flow;
}

}  // namespace fluid_cases
