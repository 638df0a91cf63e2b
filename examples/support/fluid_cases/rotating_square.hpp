// SPDX-License-Identifier: MIT
// A square of fluid that rotates in empty space: its pressure is negative everywhere inside
// (Colagrossi 2005; Le Touzé et al., Int. J. Numer. Meth. Fluids 73, 2013).
#pragma once

#include "bodies.hpp"
#include "fluid_case.hpp"

#include <numbers>

namespace fluid_cases {

/// Initially u = ω y, v = −ω x in a square of side L around the origin.
struct RotatingSquare {
  double side = 1;  ///< L [m]
  double omega = 1; ///< ω [1/s]

  /// Initial pressure [Pa]: ∇²P = 2 ρ ω², P = 0 on the sides, as a double Fourier series.
  double pressure_at(const Vec<2>& x) const {
    using std::numbers::pi;
    const double k = pi / side;
    double sum = 0;
    for (int m = 1; m < 200; m += 2) {
      for (int n = 1; n < 200; n += 2) {
        sum += -32 * omega * omega / (m * n * pi * pi * k * k * (m * m + n * n)) *
               std::sin(m * k * (x[0] + side / 2)) * std::sin(n * k * (x[1] + side / 2));
      }
    }
    return density * sum;
  }
};

/// `along` particles per side, for one revolution of a rigid body.
inline FluidCase rotating_square(int along) {
  const RotatingSquare exact;
  const double l0 = exact.side / along;
  const double half = exact.side / 2;
  const auto everywhere = [](const Vec<2>&) { return true; };
  const auto spin = [](const mps::Fluid<2>& fluid) {
    return mean_over(fluid,
                     [&](Index i) { return cross(fluid[position][i], fluid[velocity][i]); });
  };
  FluidCase flow{.name = "rotating_square", .spacing = l0};
  flow.start = fluid_where({.lower = {-half, -half}, .upper = {half, half}}, l0, {}, everywhere,
                           [&](const Vec<2>& x) {
                             return Vec<2>(exact.omega * x[1], -exact.omega * x[0]);
                           });
  flow.speed_scale = exact.omega * exact.side / std::sqrt(2.0);
  flow.clip_negative_pressure = false;
  flow.until = 2 * std::numbers::pi / exact.omega;
  flow.note_every = flow.until / 400;
  flow.names = {"t", "angular_momentum", "energy", "whole", "pressure_centre", "x_most"};
  const double spin0 = spin(flow.start);
  const auto energy = [](const mps::Fluid<2>& fluid) {
    return mean_over(fluid, [&](Index i) { return fluid[velocity][i].squaredNorm(); });
  };
  const double energy0 = energy(flow.start);
  flow.note = [=](const mps::Fluid<2>& fluid, double time) -> std::vector<double> {
    double centre = 0, farthest = 0;
    int near = 0;
    for (Index i = 0; i < fluid.size(); ++i) {
      const double r = fluid[position][i].norm();
      farthest = std::max(farthest, r);
      if (r < 2 * l0) centre += fluid[mps::pressure][i], ++near;
    }
    return {time, spin(fluid) / spin0, energy(fluid) / energy0, largest_body(fluid, 2 * l0),
            near > 0 ? centre / near / density : 0, farthest};
  };
  flow.findings = [=](const History& history) -> std::vector<Finding> {
    // The pressure lags behind the motion by a step, so the first hundredth of a turn is excluded.
    double centre = 0, whole_at_two = 0;
    int rows = 0;
    for (Index k = 0; k < history["t"].size(); ++k) {
      const double turned = exact.omega * history["t"][k];
      if (turned <= 2) whole_at_two = history["whole"][k];
      if (turned < 0.05 || turned > 0.15) continue;
      centre += history["pressure_centre"][k], ++rows;
    }
    return {{"pressure at the centre at first [ρ ω² L²]", exact.pressure_at({0, 0}) / density,
             centre / rows, 0.05},
            {"angular momentum after a turn, over that at first", 1,
             history["angular_momentum"].back(), 0.01},
            {"kinetic energy after a turn, over that at first", 1, history["energy"].back(), stated},
            {"share of the fluid in one body at ω t = 2", 1, whole_at_two, stated},
            {"share of the fluid in one body after a turn", 1, history["whole"].back(), stated}};
  };
  return flow;
}

}  // namespace fluid_cases
