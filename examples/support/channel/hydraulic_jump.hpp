// SPDX-License-Identifier: MIT
// A hydraulic jump at rest: shallow, fast water enters, and deep, slow water is drawn off. The
// depths are those between which momentum is conserved (J.-B. Bélanger 1849).
#pragma once

#include "channel_flow.hpp"

#include <cmath>
#include <vector>

namespace channel {

/// Depth after a jump over that before it.
inline double ratio_of_depths(double froude) {
  return (std::sqrt(1 + 8 * squared(froude)) - 1) / 2;
}

template <int Dim>
Flow<Dim> hydraulic_jump(const Options& o) {
  const double l0 = o.spacing, depth = o.depth;
  const double speed = o.froude * std::sqrt(g * depth), ratio = ratio_of_depths(o.froude);
  const double tail = ratio * depth, begin = 16 * depth;
  const double length = o.length > 0 ? o.length : std::round((begin + 13.5 * tail) / l0) * l0;
  if (!(length >= begin + 2 * tail)) {
    fail({"--length ", length, " is too short: the jump is at ", begin,
          " m, and the water after it ", tail, " m deep; give at least ", begin + 2 * tail});
  }
  const auto opening = [&](double x, double height) {
    return faces_along<Dim>({{x, 0}, {x, height}}, {1, 0}, o.thickness);
  };
  mps::FlowSettings<Dim, mps::Recommended> settings =
      support::flow_settings<mps::Recommended, Dim>(o, depth);
  settings.speed_scale = speed;
  settings.viscosity = o.viscosity;
  add_walls<Dim>(settings.walls, {{-3 * l0, 0}, {length + 3 * l0, 0}}, o.thickness);
  add_sides<Dim>(settings.walls, {.lower = {-3 * l0, -depth}, .upper = {length + 3 * l0, 4 * tail}},
                 o.thickness);
  Openings<Dim> openings{.in = mps::Inflow<Dim>({.faces = opening(0, 6 * depth),
                                                 .velocity = in_plane<Dim>(speed, 0),
                                                 .spacing = l0,
                                                 .level = depth}),
                         .drawn = mps::Extraction<Dim>({.faces = opening(length, 3 * tail),
                                                        .velocity = in_plane<Dim>(speed / ratio, 0),
                                                        .spacing = l0}),
                         // Spray that leaves the channel.
                         .out = mps::Outflow<Dim>(below<Dim>(-depth)),
                         .section = Flux<Dim>({opening(0.8 * length, 4 * tail), l0})};
  set_pistons<Dim>(settings.walls, {openings.in.piston(), openings.drawn->piston()});
  mps::Fluid<Dim> water;
  fill(water, {.lower = {0, 0}, .upper = {begin, depth}}, o, speed);
  fill(water, {.lower = {begin, 0}, .upper = {length, std::round(tail / l0) * l0}}, o,
       speed / ratio);

  const Range reach{0, length}, after{0.7 * length, 0.93 * length};
  Flow<Dim> flow{.water = water, .settings = settings, .openings = openings, .reach = reach};
  flow.bed = [](double) { return 0.0; };
  flow.names = {"momentum"};
  flow.measure = [=](const mps::Fluid<Dim>& fluid) -> std::vector<double> {
    const Box<2> area{.lower = {after.lower, -infinity}, .upper = {after.upper, infinity}};
    return {content_of<Dim>(fluid, area, o).momentum / (after.upper - after.lower)};
  };
  flow.findings = [=](const History& history) {
    const double before = density * (g * squared(depth) / 2 + squared(speed) * depth);
    std::vector<Finding> all{{.quantity = "depth after the jump over that before it [-]",
                              .reference = ratio,
                              .measured = mean_level(history, reach, after) / depth,
                              .allowed = 0.05},
                             {.quantity = "flux of momentum after it over that before [-]",
                              .reference = 1,
                              .measured = mean(history, "momentum") / before,
                              .allowed = stated}};
    for (const auto& more : flow_findings(history, speed * depth)) all.push_back(more);
    return all;
  };
  flow.numbers = {
      {"flow", speed * depth}, {"depth_after", tail}, {"after", {after.lower, after.upper}}};
  return flow;
}

}  // namespace channel
