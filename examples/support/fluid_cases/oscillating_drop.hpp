// SPDX-License-Identifier: MIT
// A drop of inviscid fluid that oscillates in a central force field −B0² r (Monaghan and Rafiee,
// Int. J. Numer. Meth. Fluids 71, 2013). Its velocity is always (A x, −A y), its shape an ellipse.
#pragma once

#include "bodies.hpp"
#include "fluid_case.hpp"
#include "oscillation.hpp"

namespace fluid_cases {

/// Initially a disc of radius R.
struct OscillatingDrop {
  double radius = 1;  ///< R [m]
  double a0 = 1;      ///< initial A [1/s]
  double b0 = 1;      ///< B0 [1/s]

  struct State {
    double rate;  ///< A [1/s]
    double a;     ///< semi-axis along x [m]
    double b;     ///< along y [m]
  };
  State start() const { return {a0, radius, radius}; }

  /// State after dt [s] of dA/dt = (A² + B0²) (b² − a²)/(a² + b²), da/dt = A a, db/dt = −A b, by
  /// the Runge–Kutta method of fourth order.
  State after(const State& s, double dt) const {
    const auto change = [this](const State& now) {
      const double aa = now.a * now.a, bb = now.b * now.b;
      return State{(now.rate * now.rate + b0 * b0) * (bb - aa) / (aa + bb), now.rate * now.a,
                   -now.rate * now.b};
    };
    const auto moved = [&s](const State& by, double time) {
      return State{s.rate + time * by.rate, s.a + time * by.a, s.b + time * by.b};
    };
    const State k1 = change(s), k2 = change(moved(k1, dt / 2)), k3 = change(moved(k2, dt / 2)),
                k4 = change(moved(k3, dt));
    return moved({k1.rate + 2 * k2.rate + 2 * k3.rate + k4.rate, k1.a + 2 * k2.a + 2 * k3.a + k4.a,
                  k1.b + 2 * k2.b + 2 * k3.b + k4.b},
                 dt / 6);
  }
  State at(double time) const {
    const int steps = 1 + static_cast<int>(1000 * time * (a0 + b0));
    State state = start();
    for (int k = 0; k < steps; ++k) state = after(state, time / steps);
    return state;
  }

  /// Twice the time between two zeros of A [s].
  double period() const {
    const double dt = 1e-3 / b0;
    std::vector<double> times, rates;
    State state = start();
    for (double time = 0; times.size() < 20000; time += dt, state = after(state, dt)) {
      times.push_back(time);
      rates.push_back(state.rate);
    }
    return mean_period(zero_crossings(times, rates), 1);
  }
};

/// `along` particles per radius, for three periods; A0/B0 determines the amplitude.
inline FluidCase oscillating_drop(int along, double a0_over_b0) {
  const OscillatingDrop exact{.a0 = a0_over_b0};
  const double R = exact.radius;
  const double l0 = R / along;
  FluidCase flow{.name = "oscillating_drop", .spacing = l0};
  flow.start = fluid_where({.lower = {-R, -R}, .upper = {R, R}}, l0, {},
                           [&](const Vec<2>& x) { return x.norm() < R; },
                           [&](const Vec<2>& x) {
                             return Vec<2>(exact.a0 * x[0], -exact.a0 * x[1]);
                           });
  flow.speed_scale = 1.5 * R * exact.b0;
  flow.body_force = [=](const Vec<2>& x, double) { return Vec<2>(-exact.b0 * exact.b0 * x); };
  const double period = exact.period();
  // The first zero of A is at a quarter of a period.
  flow.until = 3.3 * period;
  flow.note_every = period / 100;
  flow.names = {"t", "rate", "a", "b", "rate_exact", "a_exact", "b_exact", "whole", "pressure_centre"};
  flow.note = [=](const mps::Fluid<2>& fluid, double time) -> std::vector<double> {
    const auto x = fluid[position];
    const auto u = fluid[velocity];
    const double xx = mean_over(fluid, [&](Index i) { return x[i][0] * x[i][0]; });
    const double yy = mean_over(fluid, [&](Index i) { return x[i][1] * x[i][1]; });
    const double xu = mean_over(fluid, [&](Index i) { return x[i][0] * u[i][0]; });
    const double yv = mean_over(fluid, [&](Index i) { return x[i][1] * u[i][1]; });
    double centre = 0;
    int near = 0;
    for (Index i = 0; i < fluid.size(); ++i) {
      if (x[i].norm() < 2 * l0) centre += fluid[mps::pressure][i], ++near;
    }
    const auto known = exact.at(time);
    return {time,    (xu / xx - yv / yy) / 2, 2 * std::sqrt(xx), 2 * std::sqrt(yy), known.rate,
            known.a, known.b,                 largest_body(fluid, 2 * l0),
            near > 0 ? centre / near / density : 0};
  };
  flow.findings = [=](const History& history) -> std::vector<Finding> {
    double longest = 0, longest_exact = 0, area = 0;
    for (Index k = 0; k < history["t"].size(); ++k) {
      const double a = history["a"][k], b = history["b"][k];
      longest = std::max({longest, a, b});
      longest_exact = std::max({longest_exact, history["a_exact"][k], history["b_exact"][k]});
      area = std::max(area, std::abs(a * b / (R * R) - 1));
    }
    const auto crossings = zero_crossings(history["t"], history["rate"]);
    const auto& whole = history["whole"];
    return {{"period, mean of three [1/B0]", period, mean_period(crossings, 3), 0.02},
            {"longest semi-axis [R]", longest_exact, longest, 0.02},
            {"change of a b, at most [R²]", 0, area, 0.02, 1},
            {"share of the fluid in one body, at least", 1,
             *std::min_element(whole.begin(), whole.end()), 1e-9}};
  };
  return flow;
}

}  // namespace fluid_cases
