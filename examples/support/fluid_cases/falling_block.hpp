// SPDX-License-Identifier: MIT
// A block of fluid in free fall: its pressure stays zero, and it keeps its shape.
#pragma once

#include "bodies.hpp"
#include "fluid_case.hpp"

namespace fluid_cases {

/// `along` particles per side of 1 m, for half a second.
inline FluidCase falling_block(int along) {
  constexpr double side = 1, g = 9.81;
  const double l0 = side / along;
  FluidCase flow{.name = "falling_block", .spacing = l0};
  flow.start = fluid_where({.lower = {0, 0}, .upper = {side, side}}, l0, {},
                           [](const Vec<2>&) { return true; },
                           [](const Vec<2>&) { return Vec<2>(0, 0); });
  flow.viscosity = 1e-6;
  flow.gravity = {0, -g};
  flow.until = 0.5;
  flow.names = {"t", "fall", "fall_exact", "speed", "pressure_most", "off_lattice"};
  const std::vector<Vec<2>> first(flow.start[position].begin(), flow.start[position].end());
  flow.note = [=](const mps::Fluid<2>& fluid, double time) -> std::vector<double> {
    const auto moved = [&](Index i) {
      return Vec<2>(fluid[position][i] - first[static_cast<Index>(fluid.id(i))]);
    };
    const double fall = -mean_over(fluid, [&](Index i) { return moved(i)[1]; });
    double pressure = 0, off = 0;
    for (Index i = 0; i < fluid.size(); ++i) {
      pressure = std::max(pressure, std::abs(fluid[mps::pressure][i]));
      off = std::max(off, (moved(i) + Vec<2>(0, fall)).norm());
    }
    const double speed = -mean_over(fluid, [&](Index i) { return fluid[velocity][i][1]; });
    return {time, fall, g * time * time / 2, speed, pressure / (density * g * side), off / l0};
  };
  flow.findings = [=](const History& history) -> std::vector<Finding> {
    const auto& pressures = history["pressure_most"];
    return {{"largest pressure [ρ g L]", 0, *std::max_element(pressures.begin(), pressures.end()),
             1e-6, 1},
            {"speed after half a second [m/s]", g * history["t"].back(), history["speed"].back(),
             1e-9},
            // The scheme is of first order in time.
            {"fall after half a second [m]", history["fall_exact"].back(), history["fall"].back(),
             0.02},
            {"largest move off the lattice [l0]", 0, history["off_lattice"].back(), 1e-6, 1}};
  };
  return flow;
}

}  // namespace fluid_cases
