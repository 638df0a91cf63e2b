// SPDX-License-Identifier: MIT
// Taylor–Green vortices in a periodic square: an exact solution of the Navier–Stokes equations that
// decays by viscosity only (G.I. Taylor, A.E. Green, Proc. R. Soc. A 158, 1937).
#pragma once

#include "bodies.hpp"
#include "fluid_case.hpp"
#include "oscillation.hpp"

#include <numbers>

namespace fluid_cases {

/// In a square of side L, with the initial maximum speed U.
struct TaylorGreen {
  double side = 1;       ///< L [m]
  double speed = 1;      ///< U [m/s]
  double reynolds = 100; ///< Re = U L/ν [-]

  /// Rate b [1/s] of the velocity's decay exp(b t).
  double decay() const {
    using std::numbers::pi;
    return -8 * pi * pi * speed / (reynolds * side);
  }
  Vec<2> velocity_at(const Vec<2>& x, double time) const {
    const double k = 2 * std::numbers::pi / side;
    const double u = speed * std::exp(decay() * time);
    return {-u * std::cos(k * x[0]) * std::sin(k * x[1]),
            u * std::sin(k * x[0]) * std::cos(k * x[1])};
  }
};

/// `along` particles per side, until t U/L = 1.
inline FluidCase taylor_green(int along) {
  const TaylorGreen exact;
  const double l0 = exact.side / along;
  const Box<2> box{.lower = {0, 0}, .upper = {exact.side, exact.side}, .periodic = {true, true}};
  const auto everywhere = [](const Vec<2>&) { return true; };
  const auto rms = [](const mps::Fluid<2>& fluid) {
    return std::sqrt(mean_over(fluid, [&](Index i) { return fluid[velocity][i].squaredNorm(); }));
  };
  FluidCase flow{.name = "taylor_green", .spacing = l0};
  flow.start = fluid_where(box, l0, box, everywhere,
                           [&](const Vec<2>& x) { return exact.velocity_at(x, 0); });
  flow.has_surface = false;
  flow.viscosity = exact.speed * exact.side / exact.reynolds;
  flow.speed_scale = exact.speed;
  flow.until = exact.side / exact.speed;
  flow.note_every = flow.until / 100;
  flow.names = {"t", "speed", "speed_exact", "velocity_error", "gap", "least_density"};
  const double n0 = mps::lattice_values<2, mps::CubicKernel>(3.1).n0;
  const double rms0 = rms(flow.start);
  flow.note = [=](const mps::Fluid<2>& fluid, double time) -> std::vector<double> {
    const double decayed = std::exp(exact.decay() * time);
    const double error = mean_over(fluid, [&](Index i) {
      return (fluid[velocity][i] - exact.velocity_at(fluid[position][i], time)).squaredNorm();
    });
    const auto n = fluid[mps::number_density];
    return {time, rms(fluid) / rms0, decayed, std::sqrt(error) / (rms0 * decayed),
            largest_gap(fluid, l0) / l0,
            time > 0 ? *std::min_element(n.begin(), n.end()) / n0 : 1};
  };
  flow.findings = [=](const History& history) -> std::vector<Finding> {
    std::vector<double> logarithm;
    for (const double value : history["speed"]) logarithm.push_back(std::log(value));
    const auto& gaps = history["gap"];
    return {{"decay rate [U/L]", exact.decay(), slope(history["t"], logarithm), 0.05},
            {"error of velocity at t U/L = 1 [rms]", 0, history["velocity_error"].back(), 0.1, 1},
            {"radius of the largest empty circle [l0]", std::sqrt(0.5),
             *std::max_element(gaps.begin(), gaps.end()), 0.3, 1}};
  };
  return flow;
}

}  // namespace fluid_cases
